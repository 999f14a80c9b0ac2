#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Oracle of tests/mechanics/servo_hydraulic_slave_test.cpp: valve and cylinder without dry friction, by SciPy's LSODA.

The equations are written from Merritt's book, with the defaults of the code; two sines drive the valve.
Run in this folder: python3 mechanics_servo_hydraulic_slave.py > mechanics_servo_hydraulic_slave.csv
"""
import numpy as np
import scipy
from scipy.integrate import solve_ivp

RATED_MA, OVERLAP, OMEGA, ZETA = 15.0, 0.02, 2 * np.pi * 100.0, 0.8
K = 3.17e-4 / np.sqrt(7e6 / 2)
LEAK_EDGE, TRANSITION = 4e-13, 1e5
A, STROKE, DEAD, BETA, LEAK = 9.42e-4, 0.2, 2e-5, 7e8, 8e-14
SUPPLY, TANK, MASS, VISCOUS = 21e6, 1e5, 6.8, 300.0


def current(t):
    return 4.0 * np.sin(2 * np.pi * 3 * t) + 1.0 * np.sin(2 * np.pi * 40 * t)


def orifice(drop):
    return drop / (drop**2 + TRANSITION**2) ** 0.25


def into(pressure, opening):
    drop = SUPPLY - pressure if opening > 0 else pressure - TANK
    return K * opening * orifice(drop) + LEAK_EDGE * (SUPPLY - pressure) - LEAK_EDGE * (pressure - TANK)


def rate(t, z):
    spool, spool_v, x, v, p1, p2 = z
    u = np.clip(current(t) / RATED_MA, -1, 1)
    opening = np.sign(spool) * max(0.0, abs(spool) - OVERLAP)
    across = LEAK * (p1 - p2)
    return [
        spool_v,
        OMEGA**2 * (u - spool) - 2 * ZETA * OMEGA * spool_v,
        v,
        (A * p1 - A * p2 - VISCOUS * v) / MASS,
        BETA / (DEAD + A * (STROKE / 2 + x)) * (into(p1, opening) - A * v - across),
        BETA / (DEAD + A * (STROKE / 2 - x)) * (into(p2, -opening) + A * v + across),
    ]


times = np.linspace(0.0, 0.5, 101)
start = [0, 0, 0, 0, (SUPPLY + TANK) / 2, (SUPPLY + TANK) / 2]
solution = solve_ivp(rate, (0.0, 0.5), start, "LSODA", times, rtol=1e-9, atol=1e-12, max_step=1e-4)
print(f"# mechanics_servo_hydraulic_slave.py, scipy {scipy.__version__}")
print("time_s,position_m,velocity_m_per_s,force_N")
for t, z in zip(times, solution.y.T):
    print(f"{t:.17g},{z[2]:.17g},{z[3]:.17g},{A * (z[4] - z[5]):.17g}")
