#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Oracle of tests/simulation/delayed_slave_test.cpp: SciPy's matrix exponential with the command of the past linear in
each step of 10 us (the test's own integrator is Runge-Kutta with Hermite interpolation), delays separate in actuator
and sensor.

Run in this folder: python3 simulation_delayed_slave.py > simulation_delayed_slave.csv
"""
import numpy as np
import scipy
from scipy.linalg import expm

STEP_S, DELAY_STEPS, STEPS, EVERY = 1e-5, 200, 300000, 5000
GAIN, LAG_S, MASS_KG, DAMPING = 100.0, 0.002, 10.0, 1.0


def ramp_exact(a, b):
    n = len(a)
    m = np.zeros((n + 2, n + 2))
    m[:n, :n], m[:n, n], m[n, n + 1] = np.array(a) * STEP_S, np.array(b) * STEP_S, 1.0
    e = expm(m)
    return e[:n, :n], e[:n, n] - e[:n, n + 1], e[:n, n + 1]


body = ramp_exact([[-1 / LAG_S, 0, 0], [1 / MASS_KG, -DAMPING / MASS_KG, 0], [0, 1, 0]], [1 / LAG_S, 0, 0])
sensor = ramp_exact([[-1 / LAG_S]], [1 / LAG_S])

t = np.arange(STEPS + 1) * STEP_S
master = 0.1 * np.sin(2 * np.pi * (0.5 + 0.5 * (4.0 - 0.5) / 3.0 * t) * t)
command, position = np.zeros(STEPS + 1), np.zeros(STEPS + 1)
z, y = np.zeros(3), np.zeros(1)
print(f"# simulation_delayed_slave.py, scipy {scipy.__version__}")
print("time_s,command,position")
for k in range(STEPS + 1):
    command[k], position[k] = GAIN * (master[k] - y[0]), z[2]
    if k % EVERY == 0:
        print(f"{t[k]:.17g},{command[k]:.17g},{y[0]:.17g}")
    past = [command[j] if j >= 0 else 0.0 for j in (k - DELAY_STEPS, k + 1 - DELAY_STEPS)]
    seen = [position[j] if j >= 0 else 0.0 for j in (k - DELAY_STEPS, k + 1 - DELAY_STEPS)]
    z = body[0] @ z + body[1] * past[0] + body[2] * past[1]
    y = sensor[0] @ y + sensor[1] * seen[0] + sensor[2] * seen[1]
