# SPDX-License-Identifier: Apache-2.0
"""The notebooks run from top to bottom and come to the values that their text states. Jupyter is not needed."""

import contextlib
import importlib.util
import io
import json
import os
import time
import unittest

from programs import ROOT

FOLDER = ROOT / "examples" / "notebooks"
MOST_PROCESSOR_TIME_S = 15.0


def code_of(file):
    """The code cells, each as text."""
    notebook = json.loads(file.read_text(encoding="utf-8"))
    return ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]


class Stored(unittest.TestCase):
    def test_notebooks_are_stored_without_outputs(self):
        files = sorted(FOLDER.glob("*.ipynb"))
        self.assertEqual([file.stem for file in files], sorted(
            name.removeprefix("test_").replace("_", "-") for name in dir(Notebooks) if name.startswith("test_")),
            "each notebook has its test")
        for file in files:
            with self.subTest(file.name):
                notebook = json.loads(file.read_text(encoding="utf-8"))
                self.assertEqual(notebook["nbformat"], 4)
                for cell in notebook["cells"]:
                    if cell["cell_type"] == "code":
                        self.assertEqual((cell["outputs"], cell["execution_count"]), ([], None), "clear all outputs")


@unittest.skipIf(importlib.util.find_spec("matplotlib") is None, "install python3-matplotlib to run this")
class Notebooks(unittest.TestCase):
    def setUp(self):
        import matplotlib

        matplotlib.use("Agg")
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(FOLDER)

    def run_cells(self, name):
        """Runs all code cells in one namespace and draws the figures. Returns the namespace and what was printed."""
        from matplotlib import pyplot

        self.addCleanup(pyplot.close, "all")
        namespace, printed, before = {}, io.StringIO(), time.process_time()
        with contextlib.redirect_stdout(printed):
            for number, code in enumerate(code_of(FOLDER / f"{name}.ipynb"), 1):
                exec(compile(code, f"{name}, code cell {number}", "exec"), namespace)
        for figure in map(pyplot.figure, pyplot.get_fignums()):
            figure.canvas.draw()
        self.assertLess(time.process_time() - before, MOST_PROCESSOR_TIME_S)
        return namespace, printed.getvalue()

    def test_feel_the_problem(self):
        found, printed = self.run_cells("feel-the-problem")
        settled = found["settled"]
        self.assertEqual(settled["off", 1], 1.0, "at gain 1 it does not ring")
        for gain in found["GAINS"][1:]:
            self.assertLess(settled["off", gain], 0.5, f"rings at gain {gain} without cancellation")
            self.assertEqual(settled["on", gain], 1.0, f"settles at gain {gain} with it")
        self.assertEqual(printed.count("settle without cancellation"), len(found["GAINS"]))

    def test_from_a_device_file_to_a_safe_gain(self):
        found, printed = self.run_cells("from-a-device-file-to-a-safe-gain")
        lines = [line for code in code_of(FOLDER / "from-a-device-file-to-a-safe-gain.ipynb") for line in code.splitlines()]
        self.assertLessEqual(len(lines), 10, "ten lines of code, as its text states")
        # docs/how-to/how-much-gain-is-safe.md has the same number from the command.
        self.assertAlmostEqual(found["margins"].worst_model_limit, 0.94855, delta=5e-6)
        firm = {run.set["operator.grip.damping_N_s_per_m"] for run in found["taps"].runs
                if run.set["control.force_gain"] == min(found["rings"]) and run.metrics.settled_fraction < 1.0}
        self.assertEqual(firm, {92}, "the firm grip rings first, as its text states")
        self.assertEqual(found["first_gain"], 0.5 * min(found["margins"].worst_model_limit, found["settles_up_to"]))
        self.assertIn(f"start with a force gain of {found['first_gain']:.2f}", printed)

    def test_diagnose_a_shaking_recording(self):
        found, printed = self.run_cells("diagnose-a-shaking-recording")
        self.assertEqual(found["oscillation"].mechanism, "induced-motion")
        self.assertAlmostEqual(found["peak_Hz"], found["oscillation"].frequency_Hz, delta=1.0)
        for sentence in found["oscillation"].evidence:
            self.assertIn(sentence, printed)


if __name__ == "__main__":
    unittest.main()
