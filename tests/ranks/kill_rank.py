# SPDX-License-Identifier: Apache-2.0
"""kill_rank.py TACTUS FOLDER [--job map|contest] [--times N] [--ranks N] [--seed N]

Ends one of the ranks with SIGKILL in the middle of a job. The job must end within 10 s with an error that names the rank,
and the same command must finish it with the results of a job that nobody killed. Which rank and when is drawn anew each time:
the leading rank too, and from the start of the processes to the end of the job. A job that was finished before is no kill, and
is drawn again. The suite runs it once; run it by hand with --times 20.
"""
import argparse
import os
import random
import shutil
import signal
import subprocess
import time
from pathlib import Path

import jobs
import ranks

parser = argparse.ArgumentParser()
parser.add_argument("tactus")
parser.add_argument("folder", type=Path)
parser.add_argument("--job", choices=jobs.JOBS, default="map")
parser.add_argument("--times", type=int, default=1)
parser.add_argument("--ranks", type=int, default=3)
parser.add_argument("--seed", type=int, default=1)
given = parser.parse_args()
LIMIT_S = 10.0

shutil.rmtree(given.folder, ignore_errors=True)
given.folder.mkdir(parents=True)
job = jobs.JOBS[given.job](given.tactus)
whole, out = given.folder / "whole", given.folder / "killed"
stored = out / "tasks.partial"
draw = random.Random(given.seed)
began = time.monotonic()
status, output = ranks.run(given.ranks, *job.to(whole))
assert status == 0, output
length_s = time.monotonic() - began


def stored_bytes():
    return stored.stat().st_size if stored.exists() else 0


def kill_once(number):
    """Kills a rank and finishes the job. False: it was finished before."""
    shutil.rmtree(out, ignore_errors=True)
    running = ranks.start(given.ranks, *job.to(out))
    if not ranks.wait_for(lambda: len(ranks.processes(running)) == given.ranks, running):
        raise AssertionError("the ranks did not start:\n" + running.communicate()[0])
    if given.times == 1:  # in the middle of the work, whatever the machine is busy with
        ranks.wait_for(lambda: stored_bytes() > 20000, running)
    else:
        time.sleep(draw.uniform(0.0, length_s))
    victim = draw.randrange(1 if given.times == 1 else 0, given.ranks)
    process = ranks.processes(running).get(victim)
    if process is None:
        running.communicate()
        return False
    os.kill(process, signal.SIGKILL)
    killed = time.monotonic()
    output, _ = running.communicate(timeout=60)
    took_s = time.monotonic() - killed
    if running.returncode == 0:
        return False
    assert took_s < LIMIT_S, f"the job ended {took_s:.1f} s after the kill"
    assert f"rank {victim}" in output, f"nobody names rank {victim}:\n{output}"
    if (out / "results.json").exists():  # killed after its work, while it left
        return False
    left = stored_bytes()
    status, again = ranks.run(given.ranks, *job.to(out))
    assert status == 0, f"the next start failed with {status}:\n{again}"
    assert job.results(out) == job.results(whole), "the next start has other results"
    assert not stored.exists(), "the file of finished tasks is still there"
    print(f"{number}: rank {victim} killed, the job ended after {took_s:.2f} s, continued from {left} bytes to equal results",
          flush=True)
    return True


kills = 0
for _ in range(5 * given.times + 5):
    if kills == given.times:
        break
    kills += kill_once(kills + 1)
assert kills == given.times, f"only {kills} of {given.times} jobs could be killed before they were finished"
print(f"{kills} of {given.times}")
