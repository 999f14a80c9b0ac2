# SPDX-License-Identifier: Apache-2.0
"""The jobs that the tests of this folder run: words of the command, and what of the results must be equal."""
import json
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parent.parent


class Job:
    def __init__(self, tactus, words, files):
        self.words = [tactus, *words]
        self.files = files  # equal byte for byte

    def to(self, folder):
        return [*self.words, "--out", str(folder)]

    def results(self, folder):
        """Everything that must be equal, whoever computed it."""
        document = json.loads((Path(folder) / "results.json").read_text())
        # How it was made, by which command and in which time.
        for name in ("command", "resumed_points", "loop_ticks", "lanes_busy", "elapsed_s"):
            document.pop(name, None)
        return document, [(Path(folder) / name).read_bytes() for name in self.files]


def map_of_taps(tactus, *more):
    words = ["stability", "map", str(SOURCE / "tests/cli/maps/quick_map.toml"), "--vary", "control.cancellation=off,on",
             "--vary", "control.force_gain=0.5:30:60", "--vary", "environment.stiffness_N_per_m=1e3:1e5:80[log]"]
    return Job(tactus, [*words, *more], ["map.csv", "map.h5"])


def contest(tactus):
    words = ["run", str(SOURCE / "experiments/contest.toml")]
    for setting in ("task.taps=1", "task.lowest_gain=1", "task.highest_gain=1.1", "task.observation_s=0.15",
                    "plant.longest_step_s=1e-4"):
        words += ["--set", setting]
    return Job(tactus, words, [])


def taps(tactus):
    words = ["run", str(SOURCE / "experiments/tapping.toml"), "--set", "task.taps=6", "--set", "task.observation_s=0.2",
             "--vary", "control.force_gain=1,3,5"]
    return Job(tactus, words, [])


JOBS = {"map": map_of_taps, "contest": contest, "taps": taps}
