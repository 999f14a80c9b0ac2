#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Oracle of tests/signal/filters_test.cpp: SciPy's own designs and lfilter on one noisy signal at 5 kHz.

Run in this folder: python3 signal_filters.py > signal_filters.csv
"""
import numpy as np
import scipy
from scipy import signal

RATE_HZ = 5000.0
u = np.random.default_rng(7).standard_normal(400) + 0.5

columns = {
    "input": u,
    "low_pass_1_at_300_Hz": signal.lfilter(*signal.butter(1, 300.0, "low", fs=RATE_HZ), u),
    "low_pass_2_at_300_Hz": signal.lfilter(*signal.butter(2, 300.0, "low", fs=RATE_HZ), u),
    "low_pass_2_at_2000_Hz": signal.lfilter(*signal.butter(2, 2000.0, "low", fs=RATE_HZ), u),
    "high_pass_2_at_20_Hz": signal.lfilter(*signal.butter(2, 20.0, "high", fs=RATE_HZ), u),
    "notch_at_75_Hz_width_30_Hz": signal.lfilter(*signal.iirnotch(75.0, 75.0 / 30.0, fs=RATE_HZ), u),
}
print(f"# signal_filters.py, scipy {scipy.__version__}")
print(",".join(columns))
for row in zip(*columns.values()):
    print(",".join(f"{value:.17g}" for value in row))
