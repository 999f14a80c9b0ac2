#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Oracle of tests/simulation/contact_metrics_test.cpp: SciPy's Butterworth high-pass and the definition of settling,
on transients that the test makes again from the columns on the left.

A contact force at 5 kHz: nothing for 0.2 s, then from the first touch for 0.35 s
    push + amplitude exp(-t / decay) cos(2 pi frequency t).

Run in this folder: python3 experiments_contact.py > experiments_contact.csv
"""
import numpy as np
import scipy
from scipy import signal

TICK_S = 2e-4
BEFORE, WINDOW, QUIET, RESIDUAL = 1000, 1750, 250, 500  # ticks

cases = [  # push_N, amplitude_N, decay_s, frequency_Hz
    (0.0, 1.0, 0.005, 90.0),
    (0.3, 1.2, 0.020, 90.0),
    (0.8, 0.9, 0.050, 55.0),
    (0.5, 0.6, 0.120, 70.0),
    (0.5, 0.6, 0.128, 70.0),
    (0.2, 1.0, 0.400, 40.0),
    (1.0, 0.0, 1.000, 10.0),
    (0.4, 0.7, 0.060, 12.0),
]

print(f"# experiments_contact.py, scipy {scipy.__version__}")
print("push_N,amplitude_N,decay_s,frequency_Hz,settled,settling_time_s,residual_rms_N")
filter_ = signal.butter(2, 15.0, "high", fs=1.0 / TICK_S)
for push, amplitude, decay, frequency in cases:
    t = np.arange(WINDOW) * TICK_S
    force = np.concatenate([np.zeros(BEFORE),
                            push + amplitude * np.exp(-t / decay) * np.cos(2 * np.pi * frequency * t)])
    transient = np.abs(signal.lfilter(*filter_, force))[BEFORE:]
    large = np.flatnonzero(transient > 0.1 * transient.max())
    after = large[-1] + 1 if large.size else 0
    settled = after <= WINDOW - QUIET
    residual = np.sqrt(np.mean(transient[-RESIDUAL:] ** 2))
    print(f"{push},{amplitude},{decay},{frequency},{int(settled)},"
          f"{(after if settled else WINDOW) * TICK_S:.17g},{residual:.17g}")
