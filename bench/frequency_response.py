#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Frequency responses from five minutes at 5 kHz: tactus beside SciPy, in turns in one run.

    cmake --build --preset release --target bench_frequency_response
    python3 bench/frequency_response.py build/release/bin/bench_frequency_response

Both do the same work on one thread: Hann segments that overlap by half, less their mean, averaged; from them the
response H1 and the coherence (tactus adds the 95 % bands), or the transforms of the whole recording and their ratio.
`h1 alone` leaves out SciPy's coherence, which tactus computes all the same. Shortest time of each, over all rounds.
"""
import subprocess
import sys
import time

import numpy as np
from scipy import fft, signal

RATE_HZ = 5000.0
SAMPLES = 1_500_000
LENGTHS = (1024, 4096, 16384)
ROUNDS = 5

random = np.random.default_rng(1)
x = random.standard_normal(SAMPLES)
y = signal.lfilter([0.1, 0.2], [1.0, -0.3], x) + 0.01 * random.standard_normal(SAMPLES)


def h1(length):
    return signal.csd(x, y, RATE_HZ, nperseg=length)[1] / signal.welch(x, RATE_HZ, nperseg=length)[1]


def h1_and_coherence(length):
    cross = signal.csd(x, y, RATE_HZ, nperseg=length)[1]
    power = signal.welch(x, RATE_HZ, nperseg=length)[1]
    return cross / power, np.abs(cross) ** 2 / power / signal.welch(y, RATE_HZ, nperseg=length)[1]


def whole():
    return fft.rfft(y - y.mean()) / fft.rfft(x - x.mean())


def time_ms(work):
    start = time.perf_counter()
    work()
    return 1e3 * (time.perf_counter() - start)


def shortest(times, name, spent_ms):
    times[name] = min(times.get(name, float("inf")), spent_ms)


tactus, peer = {}, {}
for _ in range(ROUNDS):
    for line in subprocess.run([sys.argv[1]], check=True, capture_output=True, text=True).stdout.splitlines():
        name, spent = line.split()
        shortest(tactus, name, float(spent))
    for length in LENGTHS:
        shortest(peer, f"h1_{length}", time_ms(lambda: h1_and_coherence(length)))
        shortest(peer, f"h1_{length} alone", time_ms(lambda: h1(length)))
    shortest(peer, "etfe_whole", time_ms(whole))

print(f"{'':20}{'tactus ms':>10}{'SciPy ms':>10}{'ratio':>8}")
for name, spent_ms in peer.items():
    own_ms = tactus[name.split()[0]]
    print(f"{name:20}{own_ms:10.1f}{spent_ms:10.1f}{own_ms / spent_ms:8.2f}")
