# SPDX-License-Identifier: Apache-2.0
# python3 read_map.py FOLDER: h5py reads map.h5 of FOLDER: axes with units, and every number equal to that of map.csv.
# Exits with 77 where h5py is not installed.
import csv
import sys

try:
    import h5py
    import numpy as np
except ImportError as missing:
    print(f"SKIPPED: {missing}")
    sys.exit(77)

folder = sys.argv[1]
rows = list(csv.DictReader(open(f"{folder}/map.csv")))
with h5py.File(f"{folder}/map.h5") as file:
    axes = file["axes"]
    expected = {
        "0-control.cancellation": (2, "", "control.cancellation"),
        "1-control.force_gain": (60, "", "control.force_gain"),
        "2-environment.stiffness_N_per_m": (80, "N/m", "environment.stiffness_N_per_m (N/m)"),
    }
    assert set(axes) == set(expected), set(axes)
    grid = np.meshgrid(*(axes[name][()] for name in expected), indexing="ij")
    for values, (name, (count, unit, column)) in zip(grid, expected.items()):
        assert axes[name].shape == (count,), axes[name].shape
        assert axes[name].attrs["unit"].decode() == unit, axes[name].attrs["unit"]
        words = axes[name].attrs.get("words", b"").decode().split(",")
        told = [words.index(row[column]) if words != [""] else float(row[column]) for row in rows]
        np.testing.assert_array_equal(values.ravel(), told)
    verdicts = [text.split()[1] for text in file["verdict"].attrs["words"].decode().split(", ")]
    assert verdicts == ["settled", "ringing", "limit-cycle", "diverged"], verdicts
    told = [verdicts.index(row["verdict"]) for row in rows]
    np.testing.assert_array_equal(file["verdict"][()].ravel(), told)
    assert len(set(told)) >= 3, "the map shows one thing only"
    columns = {
        "settling_time": ("s", "settling_time_s"),
        "contacts": ("", "contacts"),
        "peak_force": ("N", "peak_force_N"),
        "residual_rms": ("N", "residual_rms_N"),
    }
    for name, (unit, column) in columns.items():
        assert file[name].shape == (2, 60, 80), file[name].shape
        assert file[name].attrs["unit"].decode() == unit, (name, file[name].attrs["unit"])
        np.testing.assert_array_equal(file[name][()].ravel(), [float(row[column]) for row in rows])
print(f"{len(rows)} points, equal in both files")
