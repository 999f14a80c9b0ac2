#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Oracle of tests/mechanics/cable_chain_test.cpp: the master's chain in a hand, with friction, pushed now and then.

Run in this folder: python3 mechanics_rubbing_chain.py > mechanics_rubbing_chain.csv
"""
import numpy as np
import scipy
from rubbing_chain import run

SAMPLE_TIME = 200e-6
time = SAMPLE_TIME * np.arange(750)
forces = np.round(0.4 * np.sin(2 * np.pi * 20 * time) * (time < 0.05) + 0.1 * (time > 0.09) * (time < 0.12), 6)
states = run(forces, SAMPLE_TIME)
print(f"# mechanics_rubbing_chain.py, scipy {scipy.__version__}")
print("time_s,motor_force_N,motor_m,drum_m,tip_m")
for t, force, state in zip(time, forces, states):
    print(",".join(f"{value:.12g}" for value in (t, force, *state[:3])))
