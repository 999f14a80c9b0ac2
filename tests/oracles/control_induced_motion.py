#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Oracle of tests/control/induced_motion_model_test.cpp: where a displayed force moves the motor of the model, quintic
spring and friction included, for a hand at rest and for two intended velocities.

The forces are made up like recorded impacts: a tap, a long hold at nearly full force with a vibration on it, a rebound
that dies away. Friction on total velocity is what the header of the model says: with the share s of friction that the
intended velocity uses up, the rest lies between −f (1 − s) and f (1 + s).
Run in this folder: python3 control_induced_motion.py > control_induced_motion.csv
"""
import numpy as np
import scipy
from rubbing_chain import run

TICK, QUINTIC, BAND = 200e-6, 3.125e13, 0.005
time = TICK * np.arange(800)
forces = np.zeros_like(time)
tap = (time >= 0.005) & (time < 0.008)
forces[tap] = np.sin(np.pi * (time[tap] - 0.005) / 0.003)
hold = (time >= 0.012) & (time < 0.075)
forces[hold] = 0.9 + 0.1 * np.sin(2 * np.pi * 90 * time[hold])
rebound = time >= 0.095
forces[rebound] = 0.6 * np.exp(-(time[rebound] - 0.095) / 0.015) * np.cos(2 * np.pi * 60 * (time[rebound] - 0.095)) ** 2
forces = -np.round(forces, 6)

columns = {"time_s": time, "motor_force_N": forces}
for name, intended in (("rest", 0.0), ("slow", 0.002), ("fast", -0.05)):
    share = np.clip(intended / BAND, -1, 1)
    offset = intended - np.clip(intended, -BAND, BAND)
    states = run(forces, TICK, QUINTIC, share - 1, share + 1, offset)
    columns[f"{name}_motor_m"], columns[f"{name}_handle_m"] = states[:, 0], states[:, 2]

print(f"# control_induced_motion.py, scipy {scipy.__version__}")
print(",".join(columns))
for row in zip(*columns.values()):
    print(",".join(f"{value:.10g}" for value in row))
