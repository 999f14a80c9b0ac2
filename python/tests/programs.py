# SPDX-License-Identifier: Apache-2.0
"""What the tests have in common: the `tactus` command, the folders of the project, and a folder of their own."""

import json
import os
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
COMMAND = os.environ.get("TACTUS_COMMAND", str(ROOT / "build" / "release" / "bin" / "tactus"))
LOOP = os.environ.get("TACTUS_LOOP", str(ROOT / "build" / "release" / "bin" / "cancellation_loop"))
EXPERIMENTS = ROOT / "experiments"
RECORDINGS = ROOT / "examples" / "recordings"

QUICK = """[task]
kind = "tapping"
supervised = false
taps = 1
observation_s = 0.15

[control]
force_gain = 2.0
"""


def tactus(*words):
    """Runs the command as a program of its own."""
    return subprocess.run([COMMAND, *words], capture_output=True, text=True, check=False)


class InAFolder(unittest.TestCase):
    """Each test runs in an empty folder, which the command sees too: relative names are the same in both."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="tactus-python-")
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)
        self.folder = pathlib.Path(folder.name)

    def write(self, name, text):
        pathlib.Path(name).write_text(text)
        return name

    def quick(self):
        return self.write("quick.toml", QUICK)

    def document(self, *words):
        """What the command prints with `--json`."""
        done = tactus(*words, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)
