#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Oracle of tests/control/hysteretic_model_test.cpp: where displayed impacts move the motor of the full model, with the
hysteretic linkage, the quintic hand and friction, for a hand at rest and for two intended velocities.

Every 40 ms an impact of another kind: rise within two samples, a decaying vibration of 60 to 240 Hz about a push that
lasts longer; the largest reaches 1 N, the smallest 0.05 N. One rebounds to the other side.
The linkage's equation is Bouc and Wen's, integrated in time; rubbing_chain.py says how friction is integrated.
Run in this folder: python3 control_hysteretic_motion.py > control_hysteretic_motion.csv
"""
import numpy as np
import scipy
from rubbing_chain import BoucWen, run

TICK, QUINTIC, BAND = 200e-6, 3.125e13, 0.005
time = TICK * np.arange(1000)
forces = np.zeros_like(time)
# start in s, N of the vibration, its Hz, N of the push
for start, vibration, frequency, push in (
    (0.002, 0.03, 240.0, 0.02),
    (0.040, 0.20, 180.0, 0.10),
    (0.080, 0.55, 120.0, 0.45),
    (0.120, 0.90, 90.0, -0.10),
    (0.160, 0.40, 60.0, 0.60),
):
    t = time - start
    on = t >= 0
    forces[on] += vibration * np.exp(-t[on] / 0.010) * np.cos(2 * np.pi * frequency * t[on]) + push * np.exp(
        -t[on] / 0.020
    )
forces = -np.round(np.clip(forces, -1.0, 1.0), 6)

linkage = BoucWen(average=3950.0, lost_share=0.3, slip=6.5e-5, amplitude=2.5e-4)
columns = {"time_s": time, "motor_force_N": forces}
for name, intended in (("rest", 0.0), ("slow", 0.002), ("fast", -0.15)):
    share = np.clip(intended / BAND, -1, 1)
    offset = intended - np.clip(intended, -BAND, BAND)
    states = run(forces, TICK, QUINTIC, share - 1, share + 1, offset, linkage, first_step=1e-7)
    columns[f"{name}_motor_m"], columns[f"{name}_handle_m"] = states[:, 0], states[:, 2]

print(f"# control_hysteretic_motion.py, scipy {scipy.__version__}")
print(",".join(columns))
for row in zip(*columns.values()):
    print(",".join(f"{value:.10g}" for value in row))
