# SPDX-License-Identifier: Apache-2.0
"""equal.py TACTUS FOLDER [--all]: any number of ranks gives the results of threads, bit for bit. --all: of a contest too, for
each number of ranks."""
import shutil
import subprocess
import sys
from pathlib import Path

import jobs
import ranks

tactus, scratch = sys.argv[1], Path(sys.argv[2])
shutil.rmtree(scratch, ignore_errors=True)
CASES = [("map", jobs.map_of_taps(tactus), (1, 2, 3, 8)),
         ("float", jobs.map_of_taps(tactus, "--precision", "float"), (3,)),
         ("taps", jobs.taps(tactus), (3,)),
         ("contest", jobs.contest(tactus), (1, 2, 3, 8) if "--all" in sys.argv else (2,))]
for name, job, counts in CASES:
    whole = scratch / name / "threads"
    subprocess.run(job.to(whole), check=True, stdout=subprocess.DEVNULL)
    for count in counts:
        folder = scratch / name / str(count)
        status, output = ranks.run(count, *job.to(folder))
        assert status == 0, f"{name}, {count} ranks: status {status}\n{output}"
        assert output.count("Report: ") == 1, f"{name}, {count} ranks: one rank prints\n{output}"
        assert job.results(folder) == job.results(whole), f"{name}, {count} ranks: other results"
        assert not (folder / "tasks.partial").exists(), f"{name}, {count} ranks: the file of tasks is still there"
        print(f"{name}: {count} ranks equal")
