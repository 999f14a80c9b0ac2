# SPDX-License-Identifier: Apache-2.0
"""Every error is the command's message, on the bad input of tests/cli."""

import pathlib
import unittest

import tactus
from programs import InAFolder, tactus as program

TAPPING = '[task]\nkind = "tapping"\n'

# Files that are refused.
BAD_FILES = {
    "empty": "",
    "open string": '[task]\nkind = "tapping\n',
    "open section": "[task\n",
    "key twice": '[task]\nkind = "tapping"\nkind = "tapping"\n',
    "unknown kind": '[task]\nkind = "grasping"\n',
    "no kind": "[control]\nforce_gain = 1.0\n",
    "unknown key": TAPPING + "[control]\nforce_gian = 3.0\n",
    "unknown section": TAPPING + "[contrl]\nforce_gain = 3.0\n",
    "text for a number": TAPPING + '[control]\nforce_gain = "high"\n',
    "no whole number": TAPPING + "taps = 1.5\n",
    "unknown choice": TAPPING + '[control]\ncancellation = "maybe"\n',
    "too large": TAPPING + "[control]\nforce_gain = 1e9\n",
    "nan": TAPPING + "[control]\nforce_gain = nan\n",
    "inf": TAPPING + "[environment]\nstiffness_N_per_m = inf\n",
    "negative mass": TAPPING + "[master.mechanism.motor]\nmass_kg = -0.0075\n",
    "slowest above fastest": TAPPING + "slowest_m_per_s = 0.5\n",
    "delay of a cycle": TAPPING + "[servo]\nrate_Hz = 5000.0\ncomputation_delay_s = 2e-4\n",
    "array": TAPPING + "[control]\nforce_gain = [1, 2]\n",
}

# Words after `run quick.toml`.
BAD_OPTIONS = [
    ["--set", "control.force_gain"], ["--set", "=3"], ["--set", "control=3"], ["--set", "control.force_gain=-1"],
    ["--set", "control.force_gain=nan"], ["--set", "control.force_gian=1"], ["--set", "task.kind=grasping"],
    ["--vary", "control.force_gain"], ["--vary", "control.force_gain=1,,3"], ["--vary", "=1,3"],
    ["--vary", "control.force_gain=1,-3"], ["--vary", "control.cancellation=off,perhaps"],
    ["--vary", "control.force_gian=1,3"], ["--vary", "control.force_gain=1", "--vary", "control.force_gain=3"],
    ["--device", "carriage"], ["--verbose"], ["another.toml"], ["--set"], ["--out", ""], ["--out", "/proc/results"],
    ["--with", "missing.toml"], ["--plant", "one"], ["--priority", "10"], ["--overwrite"],
]

# Whole command lines.
BAD_COMMANDS = [
    [], ["rum"], ["--verbose"], ["run"], ["run", "missing.toml"], ["run", "."], ["run", "red\x1b[31m.toml"],
    ["schema", "grasping"],
    ["schema", "tapping", "--verbose"], ["schema", "--results", "rum"], ["help", "rum"], ["diagnose"],
    ["diagnose", "missing.csv"], ["diagnose", "broken.csv"], ["diagnose", "broken.mat"],
    ["diagnose", "impact.csv", "--master-position", "farce"], ["export", "missing.mcap", "--to", "csv"],
    ["stability"], ["stability", "margin", "quick.toml"], ["stability", "margins", "quick.toml", "--uncertainty", "nan"],
    ["stability", "margins", "quick.toml", "--preload", "-1"], ["identify"], ["identify", "arm"],
    ["identify", "frf", "impact.csv", "--input", "a", "--output", "b"], ["estimate", "force", "impact.csv"],
    ["estimate", "force", "impact.csv", "--model", "missing.toml"], ["advise", "missing.toml"],
    ["advise", "quick.toml", "--set", "control.force_gian=1"], ["faults", "--set", "task.only=none"],
]


class Errors(InAFolder):
    def setUp(self):
        super().setUp()
        self.quick()
        self.write("impact.csv", "time_s,force_N,speed_m_per_s\n0,0,0\n0.001,1,0\n0.002,0,0\n")
        self.write("broken.csv", "time_s,force_N\n0,0\n0.001,many\n")
        self.write("broken.mat", "no MATLAB file")

    def expect_the_same(self, words):
        printed = program(*words)
        self.assertNotEqual(printed.returncode, 0, words)
        before = sorted(pathlib.Path().rglob("*"))
        with self.assertRaises(tactus.TactusError) as caught:
            tactus.command(*words)
        error = caught.exception
        self.assertEqual(f"tactus: {error}\n", printed.stderr.splitlines(keepends=True)[-1])
        self.assertEqual(error.exit_status, printed.returncode)
        parts = [part for part in (error.place, error.parameter, error.message) if part]
        self.assertEqual(": ".join(parts), str(error))
        for part in (error.value, error.bounds, error.remedy):
            self.assertIn(part, error.message)
        self.assertIsInstance(error, tactus.RequestError if error.exit_status == 2 else tactus.JobError)
        self.assertEqual(sorted(pathlib.Path().rglob("*")), before)
        return error

    def test_files(self):
        for name, text in BAD_FILES.items():
            with self.subTest(name):
                self.write("bad.toml", text)
                self.expect_the_same(["run", "bad.toml", "--out", "results"])

    def test_options(self):
        for words in BAD_OPTIONS:
            with self.subTest(words=words):
                self.expect_the_same(["run", "quick.toml", *words])

    def test_commands(self):
        for words in BAD_COMMANDS:
            with self.subTest(words=words):
                self.expect_the_same(words)

    def test_a_file_is_never_taken_for_an_option(self):
        for use in (tactus.run, tactus.advise, tactus.diagnose):
            with self.assertRaisesRegex(tactus.RequestError, r"^\./--help: .*(does not exist|no such file)"):
                use("--help")

    def test_parts(self):
        error = self.expect_the_same(["run", "quick.toml", "--set", "control.force_gain=-1"])
        self.assertEqual(
            (error.kind, error.place, error.parameter, error.value, error.bounds),
            ("out-of-bounds", "--set control.force_gain=-1", "control.force_gain", "-1",
             "must be at least 0 and at most 1000"))
        self.write("bad.toml", TAPPING + '[control]\ncancellation = "of"\n')
        error = self.expect_the_same(["run", "bad.toml"])
        self.assertEqual((error.place, error.value), ("bad.toml:4:16", "of"))
        self.assertEqual(error.bounds, 'must be "off" or "on"')
        self.assertIn('did you mean "off"?', error.remedy)
        error = self.expect_the_same(["run", "missing.toml"])
        self.assertEqual((error.kind, error.place), ("missing", "missing.toml"))

    def test_keywords_are_refused_as_the_files_keys(self):
        with self.assertRaises(tactus.RequestError) as caught:
            tactus.run("quick.toml", control={"force_gain": 1e9})
        self.assertEqual(caught.exception.place, "--set control.force_gain=1000000000.0")
        with self.assertRaisesRegex(TypeError, "is no section of a file"):
            tactus.run("quick.toml", force_gain=3)
        with self.assertRaisesRegex(TypeError, "is no value of a key"):
            tactus.run("quick.toml", control={"force_gain": object()})
        with self.assertRaisesRegex(ValueError, "zero byte"):
            tactus.command("run", "quick\0.toml")

    def test_what_needs_a_process_of_its_own(self):
        for words in (["serve"], ["device", "list"], ["run", "quick.toml", "--realtime"]):
            with self.assertRaisesRegex(tactus.RequestError, "start the command `tactus` as a program"):
                tactus.command(*words)


if __name__ == "__main__":
    unittest.main()
