# SPDX-License-Identifier: Apache-2.0
"""kill_worker.py [--times N] [--seed N]: a sweep on two local Dask workers, of which one is killed with SIGKILL.

The sweep must finish with the results of a sweep without Dask. Which worker and after how many finished tasks is drawn anew
each time. The suite runs it once; run it by hand with --times 20.
"""

import argparse
import contextlib
import os
import pathlib
import random
import signal
import tempfile

import tactus
from programs import QUICK

VARY = {"control.force_gain": [0.5 * n for n in range(1, 9)], "control.cancellation": ["off", "on"]}
TAPS = {"task.taps": 4}


@contextlib.contextmanager
def local_cluster():
    """A client of two workers, each a process with one thread."""
    import dask
    from distributed import Client, LocalCluster

    with dask.config.set({"distributed.comm.timeouts.connect": "30s"}):
        with LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
            with Client(cluster) as client:
                client.wait_for_workers(2)
                yield client


def values_of(found):
    return [(one.settings, one.values.to_dict()) for one in found]


def kill_once(client, file, after_tasks, worker=0):
    """Kills a worker once so many tasks are finished. Whether results are those of a sweep without Dask."""
    expected = values_of(tactus.sweep(file, VARY, set=TAPS))
    victims = list(client.run(os.getpid).values())
    count = len(expected)
    killed = []

    def kill_in_time(share):
        if not killed and round(share * count) >= after_tasks:
            killed.append(victims[worker])
            os.kill(victims[worker], signal.SIGKILL)

    found = values_of(tactus.sweep(file, VARY, set=TAPS, client=client, progress=kill_in_time))
    return bool(killed) and found == expected


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--times", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    draw = random.Random(given.seed)
    equal = 0
    with tempfile.TemporaryDirectory(prefix="tactus-sweep-") as folder:
        file = pathlib.Path(folder) / "quick.toml"
        file.write_text(QUICK, encoding="utf-8")
        for number in range(1, given.times + 1):
            after_tasks, worker = draw.randint(1, 14), draw.randrange(2)
            # A cluster of its own: Dask does not replace every killed worker (2022.12, on a busy machine).
            with local_cluster() as client:
                same = kill_once(client, file, after_tasks, worker)
            print(f"{number}: worker {worker} killed after {after_tasks} tasks, {'equal' if same else 'other'} results",
                  flush=True)
            equal += same
    print(f"{equal} of {given.times}")
    raise SystemExit(equal != given.times)


if __name__ == "__main__":
    main()
