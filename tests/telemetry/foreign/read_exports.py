# SPDX-License-Identifier: Apache-2.0
# python3 read_exports.py mat|hdf5 FOLDER: SciPy or h5py loads the exports of the sample log in the one line that the
# documentation shows, and names, units and values are those of ../sample.hpp. Exits with 77 where it is not installed.
import sys

try:
    import numpy as np

    if sys.argv[1] == "mat":
        import scipy.io
    else:
        import h5py
except ImportError as missing:
    print(f"SKIPPED: {missing}")
    sys.exit(77)

folder = sys.argv[2]
units = {"time_s": "s", "touched": "", "force_N": "N", "count": ""}


def check(topic, rows):
    k = np.arange(20000)[:: 20000 // rows]
    np.testing.assert_array_equal(np.array(topic["time_s"]), 0.001 * k)
    np.testing.assert_array_equal(np.array(topic["touched"]), k % 3 == 0)
    np.testing.assert_array_equal(np.array(topic["force_N"]), 0.5 * k - 100)
    np.testing.assert_array_equal(np.array(topic["count"]), -k)


if sys.argv[1] == "mat":
    log = scipy.io.loadmat(f"{folder}/log.mat", simplify_cells=True)
    for name, rows in (("run_1_sample", 20000), ("run_2_sample", 10000)):
        check(log[name], rows)
        found = {key: value if isinstance(value, str) else "" for key, value in log[name]["units"].items()}
        assert found == units, found
    assert log["about"]["configuration"] == "[servo]\nrate_Hz = 5000\n", log["about"]
else:
    log = h5py.File(f"{folder}/log.h5")
    for name, rows in (("run_1_sample", 20000), ("run_2_sample", 10000)):
        check(log[name], rows)
        found = {key: column.attrs["unit"].decode() for key, column in log[name].items()}
        assert found == units, found
    assert log["run_1_sample/force_N"].attrs["sign"].decode() == "pushes the hand back"
    assert log["about/configuration"][()].decode() == "[servo]\nrate_Hz = 5000\n"
print("equal names, units and values")
