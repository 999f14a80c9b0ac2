# SPDX-License-Identifier: Apache-2.0
"""Logs, the import, and what needs packages that may be missing."""

import csv
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import unittest

import numpy

import tactus
from programs import RECORDINGS, ROOT, InAFolder, tactus as program


def needs(*modules):
    missing = [module for module in modules if importlib.util.find_spec(module) is None]
    return unittest.skipIf(missing, f"install python3-{missing[0] if missing else ''} to run this")


class Logs(InAFolder):
    def test_a_log_is_what_export_writes(self):
        tactus.run(self.quick(), out="left")
        log = tactus.read_log("left/log")
        self.assertTrue(log.complete)
        self.assertEqual((log.damaged_chunks, log.damaged_elsewhere), (0, False))
        for topic, table in log.items():
            with self.subTest(topic):
                self.assertEqual(program("export", "left/log", "--topic", topic, "--to", "csv", "--out", "one.csv",
                                         "--overwrite").returncode, 0)
                with open("one.csv", encoding="utf-8") as file:
                    rows = list(csv.reader(line for line in file if not line.startswith("#")))
                self.assertEqual(len(rows) - 1, len(table.times_ns))
                self.assertEqual(len(rows[0]), len(table), f"{rows[0]} and {list(table)}")
                for column, (name, values) in enumerate(table.items()):
                    self.assertTrue(name.startswith(rows[0][column].split(" [")[0]), f"{name} and {rows[0][column]}")
                    numpy.testing.assert_array_equal(values, [float(row[column]) for row in rows[1:]], name)
        self.assertEqual(list(tactus.read_log("left/log", topic=topic)), [topic])
        self.assertTrue((numpy.diff(table.times_ns.astype(numpy.int64)) > 0).all())
        with self.assertRaisesRegex(tactus.RequestError, "no message on the topic /nothing"):
            tactus.read_log("left/log", topic="/nothing")

    def test_a_recording_has_its_columns_and_units(self):
        self.write("table.csv", "time [ms],force (Newton),note\n0,1.5,a\n1,2,b\n2,-3,c\n")
        self.write("numbers.csv", "time [ms],force (Newton)\n0,1.5\n1,2\n2,-3\n")
        table = tactus.read_log("numbers.csv")["numbers.csv"]
        self.assertEqual(table["force"].tolist(), [1.5, 2.0, -3.0])
        self.assertEqual(table.units["time"], "ms")
        self.assertEqual(table.times_ns.size, 0)
        for missing in ("missing.csv", "missing.mcap", "missing.mat"):
            with self.assertRaises(tactus.RequestError) as caught:
                tactus.read_log(missing)
            self.assertIn(missing, str(caught.exception))

    @needs("pandas")
    def test_frames(self):
        quick = self.quick()
        result = tactus.run(quick, vary={"control.force_gain": [1, 2]}, out="left")
        frame = result.values.frame("runs")
        self.assertEqual(frame["set.control.force_gain"].tolist(), [1, 2])
        topic, table = next(iter(tactus.read_log("left/log").items()))
        self.assertEqual(table.frame().index.name, "time_s")
        self.assertEqual(list(table.frame().columns), list(table))
        of_file = next(iter(tactus.read_log(RECORDINGS / "shaking-contact.csv").values())).frame()
        self.assertGreater(len(of_file), 1000)


class Package(InAFolder):
    def test_version(self):
        self.assertIn(f"tactus {tactus.__version__}\n", program("--version").stdout)

    def test_the_import_takes_less_than_150_ms(self):
        """Of processor time, the least of five: a busy machine makes none of them longer than it is."""
        code = "import time; a = time.process_time(); import tactus; print(time.process_time() - a)"
        took = [float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)
                for _ in range(5)]
        self.assertLess(min(took), 0.15)
        code = "import sys, tactus; print('numpy' in sys.modules)"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        self.assertEqual(done.stdout, "False\n", "NumPy is loaded when it is needed")

    def test_a_library_that_is_missing_is_named(self):
        done = subprocess.run([sys.executable, "-c", "import tactus; tactus.schema()"], capture_output=True, text=True,
                              env={**os.environ, "TACTUS_LIBRARY": "/nowhere/libtactus.so.0"}, check=False)
        self.assertIn("ImportError: the library of tactus cannot be loaded", done.stderr)
        self.assertIn("let TACTUS_LIBRARY name the file", done.stderr)

    def test_the_example_runs(self):
        done = subprocess.run([sys.executable, str(ROOT / "examples" / "python" / "cancellation_loop.py")],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"moved the motor by up to \d+ um, and the intended position by up to \d+ um")

    def test_the_python_of_the_page_runs(self):
        text = (ROOT / "docs" / "how-to" / "python.md").read_text()
        blocks = re.findall(r"^(<!-- block is not run: [^\n]+ -->\n)?```python\n(.*?)^```", text, flags=re.S | re.M)
        blocks = [block for not_run, block in blocks if not not_run]
        self.assertEqual(len(blocks), 6)
        os.chdir(ROOT)
        for block in blocks:
            if "tactus.plot" in block and importlib.util.find_spec("matplotlib") is None:
                continue  # test_plot is skipped then, and names the package
            done = subprocess.run([sys.executable, "-c", block], capture_output=True, text=True, check=False)
            self.assertEqual((done.returncode, done.stderr), (0, ""), block)
            self.assertTrue(done.stdout or "cancellation" in block, block)

    @needs("pip", "setuptools", "wheel")
    def test_pip_installs_it_and_the_wheel_fits_every_python_3(self):
        source = self.folder / "source"
        source.mkdir()
        for name in ("pyproject.toml", "setup.py", "README.md"):
            (source / name).write_text((ROOT / "python" / name).read_text())
        (source / "tactus").mkdir()
        for file in (ROOT / "python" / "tactus").iterdir():
            if file.suffix == ".py" or file.name == "py.typed":
                (source / "tactus" / file.name).write_text(file.read_text())
        pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check"]
        done = subprocess.run([*pip, "wheel", "--no-index", "--no-build-isolation", "--no-deps", "--wheel-dir", "wheels",
                               str(source)], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        wheels = list(pathlib.Path("wheels").iterdir())
        self.assertEqual([wheel.name for wheel in wheels], [f"tactus-{tactus.__version__}-py3-none-linux_x86_64.whl"])
        done = subprocess.run([*pip, "install", "--no-index", "--no-deps", "--target", "installed", str(wheels[0])],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        clean = {name: value for name, value in os.environ.items() if name not in ("TACTUS_LIBRARY", "PYTHONPATH")}
        code = "import tactus; print(tactus.__file__, tactus.Cancellation(sample_time_s=1e-3).step(0.01, 0.0))"
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False,
                              env={**clean, "PYTHONPATH": str(self.folder / "installed")})
        self.assertEqual(done.stdout, f"{self.folder}/installed/tactus/__init__.py 0.01\n", done.stderr)

    @needs("mypy")
    def test_types(self):
        done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(self.folder / "cache"),
                               "--config-file", str(ROOT / "python" / "pyproject.toml"), str(ROOT / "python" / "tactus")],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)


if __name__ == "__main__":
    unittest.main()
