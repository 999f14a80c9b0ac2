# SPDX-License-Identifier: Apache-2.0
"""Every command's result from Python is its JSON."""

import json
import os
import pathlib
import signal
import threading
import time
import unittest

import numpy

import tactus
from programs import EXPERIMENTS, RECORDINGS, InAFolder, tactus as program


class Commands(InAFolder):
    def same(self, result, *words):
        """The result is the document that the command prints for these words."""
        document = self.document(*words)
        self.assertEqual(result.command, " ".join(["tactus", *words, "--json"]).replace("  ", " "))
        self.assertEqual(result.to_dict(), document)

    def test_run(self):
        quick = self.quick()
        words = ["run", quick, "--set", "control.force_gain=3.0", "--set", "control.cancellation=off",
                 "--set", "task.taps=2", "--vary", "control.force_limit_N=1,2.5"]
        result = tactus.run(quick, control={"force_gain": 3.0, "cancellation": "off"}, set={"task.taps": 2},
                            vary={"control.force_limit_N": [1, 2.5]})
        self.same(result, *words)
        self.assertEqual(result.seed, 1)
        self.assertEqual(result.configuration.control.force_gain, 3.0)
        self.assertEqual(len(result.runs), 2)
        self.assertEqual(result.values.runs[0].metrics.taps, 2)

    def test_kinds_of_experiments(self):
        for kind in ("force-display", "hydraulic-chirp", "inverse-model-chirp", "prediction-block", "arm-vibration"):
            with self.subTest(kind):
                file = str(EXPERIMENTS / f"{kind}.toml")
                self.same(tactus.run(file), "run", file)

    def test_stability(self):
        file = str(EXPERIMENTS / "tapping.toml")
        for what in ("margins", "scorecard", "two-port"):
            with self.subTest(what):
                self.same(tactus.stability(what, file), "stability", what, file)
        self.same(tactus.stability("margins", file, friction_speed=0.1, control={"force_gain": 2}),
                  "stability", "margins", file, "--set", "control.force_gain=2", "--friction-speed", "0.1")
        arms = str(EXPERIMENTS / "arm-tapping.toml")
        self.same(tactus.stability("margins", arms), "stability", "margins", arms)

    def test_advise(self):
        file = self.quick()
        self.same(tactus.advise(file), "advise", file)

    def test_diagnose(self):
        file = str(RECORDINGS / "shaking-contact.csv")
        result = tactus.diagnose(file)
        self.same(result, "diagnose", file)
        self.assertEqual(result.oscillations[0].mechanism, "induced-motion")
        self.assertIn("verdict", dir(result.values))

    def test_diagnose_arrays(self):
        table = next(iter(tactus.read_log(RECORDINGS / "shaking-contact.csv").values()))
        columns = {f"{name}_{table.units[name]}" if table.units[name] else name: values
                   for name, values in table.items()}
        found = tactus.diagnose(columns).to_dict()
        expected = self.document("diagnose", str(RECORDINGS / "shaking-contact.csv"))
        self.assertEqual(found["oscillations"], expected["oscillations"])
        with self.assertRaisesRegex(ValueError, r"equal shapes \(n,\)"):
            tactus.diagnose({"time_s": [0, 1], "master_position_m": [0]})

    def test_identify_and_estimate(self):
        file = str(RECORDINGS / "shaking-contact.csv")
        self.same(tactus.identify("frf", file, file, input="displayed_force", output="master_position", method="etfe",
                                  compare=True),
                  "identify", "frf", file, file, "--input", "displayed_force", "--output", "master_position",
                  "--method", "etfe", "--compare")
        time_s = 1e-3 * numpy.arange(8000)
        phase, rate = numpy.pi * (time_s + 0.5 * time_s**2), numpy.pi * (1.0 + time_s)
        position_m = 0.02 * numpy.sin(phase)
        force_N = 1.2 * 0.02 * rate * numpy.cos(phase) - 0.5 * rate**2 * position_m
        numpy.savetxt("free.csv", numpy.column_stack([time_s, position_m, force_N]), delimiter=",",
                      header="time_s,position_m,force_N", comments="")
        self.same(tactus.identify("inverse", "free.csv", out="found", overwrite=True),
                  "identify", "inverse", "free.csv", "--out", "found", "--overwrite")
        self.same(tactus.estimate("force", "free.csv", model="found/model.toml", compare="force_N"),
                  "estimate", "force", "free.csv", "--model", "found/model.toml", "--compare", "force_N")

    def test_identify_an_arm(self):
        urdf, columns = str(RECORDINGS / "three-joints.urdf"), {"time": "time", "position": "2:4", "effort": "8:10"}
        gravity = "0,-9.81,0"
        words = ["--time", "time", "--position", "2:4", "--effort", "8:10"]
        free, pushed = str(RECORDINGS / "arm-free-motion.csv"), str(RECORDINGS / "arm-pushed.csv")
        self.same(tactus.identify("arm", free, urdf=urdf, gravity=gravity, **columns, out="arm", overwrite=True),
                  "identify", "arm", free, "--urdf", urdf, "--gravity", gravity, *words, "--out", "arm", "--overwrite")
        self.same(tactus.estimate("torque", pushed, **columns, model="arm/model.toml"),
                  "estimate", "torque", pushed, *words, "--model", "arm/model.toml")

    def test_schemas(self):
        self.assertEqual(tactus.schema("contest"), json.loads(program("schema", "contest").stdout))
        self.assertEqual(tactus.results_schema("stability", "margins"),
                         json.loads(program("schema", "--results", "stability", "margins").stdout))
        self.assertEqual(tactus.reference("tapping"), program("schema", "tapping", "--reference").stdout)

    def test_text_and_files_are_those_of_the_command(self):
        quick = self.quick()
        printed = program("run", quick, "--out", "of_command")
        output = tactus.command("run", quick, "--out", "of_python")
        self.assertEqual(output.results.replace("of_python", "of_command"), printed.stdout)
        self.assertEqual((output.messages, output.exit_status), (printed.stderr, 0))
        names = [sorted(str(file.relative_to(folder)) for file in pathlib.Path(folder).rglob("*"))
                 for folder in ("of_command", "of_python")]
        self.assertEqual(*names)
        self.assertEqual(tactus.run(quick, out="with_json").messages, "Report: with_json/report.html\nLog: with_json/log\n")


class Progress(InAFolder):
    def test_progress_is_reported_and_ends_a_run(self):
        shares = []
        tactus.run(self.quick(), vary={"control.force_gain": [1, 2, 3]}, progress=shares.append)
        self.assertTrue(shares)
        self.assertEqual(shares, sorted(shares))
        with self.assertRaises(tactus.Interrupted):
            tactus.run(self.quick(), task={"taps": 100000}, progress=lambda done: False)

    def test_what_the_callback_raises_is_raised(self):
        def fail(_done):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            tactus.run(self.quick(), task={"taps": 100000}, progress=fail)

    def test_ctrl_c_ends_a_run(self):
        threading.Timer(0.3, os.kill, [os.getpid(), signal.SIGINT]).start()
        with self.assertRaises(KeyboardInterrupt):
            tactus.run(self.quick(), task={"taps": 100000})

    def test_other_threads_run_meanwhile(self):
        quick, counted, done = self.quick(), [0], threading.Event()

        def count():
            while not done.is_set():
                counted[0] += 1
                time.sleep(0.001)

        counter = threading.Thread(target=count)
        counter.start()
        try:
            before = counted[0]
            tactus.run(quick, task={"taps": 300})
            self.assertGreater(counted[0], before + 2)
        finally:
            done.set()
            counter.join()

    def test_commands_of_several_threads(self):
        quick, found = self.quick(), {}
        threads = [threading.Thread(target=lambda gain=gain: found.update(
            {gain: tactus.run(quick, control={"force_gain": gain}).to_dict()})) for gain in (1.0, 2.0, 3.0)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for gain, document in found.items():
            self.assertEqual(document, tactus.run(quick, control={"force_gain": gain}).to_dict())
        self.assertEqual(len(found), 3)


if __name__ == "__main__":
    unittest.main()
