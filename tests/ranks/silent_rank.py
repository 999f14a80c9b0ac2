# SPDX-License-Identifier: Apache-2.0
"""silent_rank.py TACTUS FOLDER: a rank that is stopped, so that it neither works nor dies, ends the job within 10 s with its
name; and the same command finishes the job."""
import os
import shutil
import signal
import sys
import time
from pathlib import Path

import jobs
import ranks

tactus, folder = sys.argv[1], Path(sys.argv[2])
shutil.rmtree(folder, ignore_errors=True)
job = jobs.map_of_taps(tactus, "--set", "task.observation_s=5")
running = ranks.start(2, *job.to(folder))
stored = folder / "tasks.partial"
assert ranks.wait_for(lambda: stored.exists() and stored.stat().st_size > 20000, running), running.communicate()[0]
os.kill(ranks.processes(running)[1], signal.SIGSTOP)
stopped = time.monotonic()
output, _ = running.communicate(timeout=60)
took_s = time.monotonic() - stopped
print(output)
assert running.returncode != 0
assert took_s < 10.0, f"the job ended {took_s:.1f} s after the stop"
assert "rank 1 (process " in output and "does not respond" in output
assert not (folder / "results.json").exists()
