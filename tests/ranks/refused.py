# SPDX-License-Identifier: Apache-2.0
"""refused.py TACTUS FOLDER: what several ranks cannot do is refused once, at once, and leaves nothing."""
import shutil
import subprocess
import sys
from pathlib import Path

import jobs
import ranks

tactus, folder = sys.argv[1], Path(sys.argv[2])
shutil.rmtree(folder, ignore_errors=True)
folder.mkdir(parents=True)
out = folder / "out"
tapping = str(jobs.SOURCE / "experiments/tapping.toml")


def refused(expected, *command, status=2):
    code, output = ranks.run(2, *command, timeout_s=30)
    assert code == status, f"{command}: status {code}\n{output}"
    assert output.count("tactus: ") == 1, f"one rank reports\n{output}"
    assert expected in output, output
    assert not out.exists(), f"{command} left {list(out.iterdir())}"


refused("cannot be shared by several processes", tactus, "diagnose", "recording.csv", "--out", str(out))
chirp = str(jobs.SOURCE / "experiments/inverse-model-chirp.toml")
refused("an experiment of kind inverse-model-chirp cannot be shared", tactus, "run", chirp, "--out", str(out))
refused("a run in real time cannot be shared", tactus, "run", tapping, "--realtime")
refused("more than ten million points", *jobs.map_of_taps(tactus, "--vary", "task.grip=1:2:9999").to(out))

# Ranks that read different files.
one, other = jobs.map_of_taps(tactus), jobs.map_of_taps(tactus, "--set", "environment.damping_N_s_per_m=4")
code, output = ranks.run(1, *one.to(folder / "one"), ":", "-n", "1", *other.to(folder / "one"))
assert code != 0 and "has another job than rank 0" in output, output
code, output = ranks.run(1, *one.to(folder / "two"), ":", "-n", "1", *other.to(folder / "two"), "--set", "task.taps=3")
assert code != 0 and "rank 1: " in output and "task.taps" in output, output

# Help and version are for one.
code, output = ranks.run(2, tactus, "--version")
assert code == 0 and output.count("tactus") == 1, output

# A file of another job, and one in use.
busy = jobs.map_of_taps(tactus, "--set", "task.observation_s=5")
running = ranks.start(2, *busy.to(folder / "busy"))
stored = folder / "busy" / "tasks.partial"
assert ranks.wait_for(lambda: stored.exists() and stored.stat().st_size > 20000, running), running.communicate()[0]
second = subprocess.run(busy.to(folder / "busy"), text=True, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
assert second.returncode == 2 and "another process is working on this job" in second.stderr, second.stderr
running.terminate()
output, _ = running.communicate(timeout=30)
other = subprocess.run(one.to(folder / "busy"), text=True, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
assert other.returncode == 2 and "has finished tasks of another job" in other.stderr, other.stderr
