# SPDX-License-Identifier: Apache-2.0
"""Starts ranks of Open MPI on this machine, and finds their processes."""
import os
import subprocess
import time
from pathlib import Path

# The tests run in containers, as root, on a machine with fewer cores than ranks and without a remote shell.
ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
               "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_plm": "isolated"}


def start(ranks, *command, **options):
    """mpirun with so many ranks; its output is text that can be read."""
    return subprocess.Popen(["mpirun", "-n", str(ranks), *map(str, command)], env=ENVIRONMENT, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **options)


def run(ranks, *command, timeout_s=120, **options):
    """The same to its end: exit status and output."""
    with start(ranks, *command, **options) as job:
        try:
            output, _ = job.communicate(timeout=timeout_s)
        except subprocess.TimeoutExpired:
            job.kill()
            raise
        return job.returncode, output


def processes(job):
    """The process of each rank that has been started, by rank."""
    found = {}
    for children in Path(f"/proc/{job.pid}/task").glob("*/children"):
        try:
            for process in children.read_text().split():
                environment = Path(f"/proc/{process}/environ").read_bytes().split(b"\0")
                for variable in environment:
                    if variable.startswith(b"OMPI_COMM_WORLD_RANK="):
                        found[int(variable.partition(b"=")[2])] = int(process)
        except OSError:  # it has ended meanwhile
            pass
    return found


def wait_for(condition, job, timeout_s=30.0):
    """Waits until the condition holds. False: the job ended before."""
    end = time.monotonic() + timeout_s
    while not condition():
        if job.poll() is not None:
            return False
        if time.monotonic() > end:
            raise TimeoutError("the ranks did not get so far in time")
        time.sleep(0.005)
    return True
