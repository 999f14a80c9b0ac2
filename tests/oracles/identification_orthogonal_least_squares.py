# SPDX-License-Identifier: Apache-2.0
"""Oracle of tests/identification/narx_fit_test.cpp: the order and the error reduction ratios of forward regression.

Written without orthogonalisation: each round refits every candidate together with those chosen by NumPy's least squares
and takes the one that leaves the smallest sum of squares. Stops by Schwarz's criterion, by the same refits.

Run in this folder: python3 identification_orthogonal_least_squares.py (writes _data.csv and _ranks.csv)
"""

import numpy as np

NAME = "identification_orthogonal_least_squares"
rng = np.random.default_rng(5)
ROWS, COLUMNS = 200, 8
a = rng.standard_normal((ROWS, COLUMNS))
a[:, 3] = a[:, 0] + 0.3 * a[:, 1] + 0.1 * a[:, 3]  # nearly in the plane of two others
a[:, 6] *= 1e4  # another unit
y = 2.0 * a[:, 0] - 1.0 * a[:, 1] + 3e-5 * a[:, 6] + 0.5 * a[:, 4] + 0.3 * rng.standard_normal(ROWS)
origin = f"# {NAME}.py, numpy {np.__version__}"
np.savetxt(
    NAME + "_data.csv",
    np.column_stack([a, y]),
    fmt="%.17g",
    delimiter=",",
    header=origin + "\n" + ",".join(f"a_{i}" for i in range(COLUMNS)) + ",y",
    comments="",
)


def rss(columns):
    if not columns:
        return y @ y
    p, *_ = np.linalg.lstsq(a[:, columns] / np.linalg.norm(a[:, columns], axis=0), y, rcond=None)
    r = y - (a[:, columns] / np.linalg.norm(a[:, columns], axis=0)) @ p
    return r @ r


def schwarz(columns):
    return ROWS * np.log(rss(columns) / ROWS) + len(columns) * np.log(ROWS)


chosen = []
with open(NAME + "_ranks.csv", "w") as out:
    print(origin, file=out)
    print("column,error_reduction", file=out)
    while len(chosen) < COLUMNS:
        best = min((i for i in range(COLUMNS) if i not in chosen), key=lambda i: rss(chosen + [i]))
        if schwarz(chosen + [best]) >= schwarz(chosen):
            break
        print(f"{best},{(rss(chosen) - rss(chosen + [best])) / (y @ y):.12e}", file=out)
        chosen.append(best)
