#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Oracle of tests/mechanics/hysteresis_test.cpp: the Bouc-Wen equation integrated in time by SciPy's LSODA.

Deflection: two sines of unequal frequency, so that minor loops and reversals at every depth occur.
Run in this folder: python3 mechanics_bouc_wen.py > mechanics_bouc_wen.csv
"""
import numpy as np
import scipy
from scipy.integrate import solve_ivp

SLIP_M = 4e-5
times = np.linspace(0.0, 1.0, 501)


def deflection(t):
    return 2e-4 * np.sin(2 * np.pi * 2 * t) + 4e-5 * np.sin(2 * np.pi * 23 * t)


def rate(t):
    return 2e-4 * 2 * np.pi * 2 * np.cos(2 * np.pi * 2 * t) + 4e-5 * 2 * np.pi * 23 * np.cos(2 * np.pi * 23 * t)


def slope(t, z):
    v = rate(t)
    return [v - 0.5 / SLIP_M * (abs(v) * z[0] + v * abs(z[0]))]


solution = solve_ivp(slope, (0.0, 1.0), [0.0], "LSODA", times, rtol=1e-10, atol=1e-16, max_step=2e-5)
print(f"# mechanics_bouc_wen.py, scipy {scipy.__version__}")
print("deflection_m,elastic_m")
for d, z in zip(deflection(times), solution.y[0]):
    print(f"{d:.17g},{z:.17g}")
