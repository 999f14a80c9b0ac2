#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Oracle of tests/mechanics/friction_test.cpp: a mass on a spring whose far end is moved, with Coulomb friction.

The motion is integrated piece by piece, sliding either way or sticking, with SciPy's DOP853 and event location: no time
stepping scheme for friction is involved.
Run in this folder: python3 mechanics_stick_slip.py > mechanics_stick_slip.csv
"""
import numpy as np
import scipy
from scipy.integrate import solve_ivp

MASS, STIFFNESS, DAMPING, FRICTION, END = 0.018, 40.0, 0.02, 0.05, 3.0


def drive(t):
    return 2.5e-3 * np.sin(2 * np.pi * 3.0 * t)


def pull(t, x, v):
    return STIFFNESS * (drive(t) - x) - DAMPING * v


samples = np.linspace(0.0, END, 601)
x_out, v_out = np.zeros_like(samples), np.zeros_like(samples)
t, x, sign = 0.0, 0.0, 0
while t < END:
    if sign == 0:

        def breaks(s, y):
            return abs(pull(s, y[0], 0.0)) - FRICTION

        breaks.terminal, breaks.direction = True, 1
        piece = solve_ivp(lambda s, y: [0.0, 0.0], (t, END), [x, 0.0], "DOP853", dense_output=True, events=breaks,
                          rtol=1e-11, atol=1e-15, max_step=1e-3)
        following = lambda s, y: int(np.sign(pull(s, y[0], 0.0)))
    else:
        way = sign

        def stops(s, y):
            return way * y[1]

        stops.terminal, stops.direction = True, -1
        piece = solve_ivp(lambda s, y: [y[1], (pull(s, y[0], y[1]) - way * FRICTION) / MASS], (t, END), [x, 0.0],
                          "DOP853", dense_output=True, events=stops, rtol=1e-11, atol=1e-15, max_step=1e-3)

        def following(s, y):
            force = pull(s, y[0], 0.0)
            return 0 if abs(force) <= FRICTION else int(np.sign(force))

    inside = (samples >= t) & (samples <= piece.t[-1])
    states = piece.sol(samples[inside])
    x_out[inside], v_out[inside] = states[0], states[1]
    if piece.status == 0:
        break
    t, x = piece.t[-1], piece.y[0, -1]
    sign = following(t, [x, 0.0])

print(f"# mechanics_stick_slip.py, scipy {scipy.__version__}")
print("time_s,position_m,velocity_m_per_s")
for row in zip(samples, x_out, v_out):
    print(",".join(f"{value:.15g}" for value in row))
