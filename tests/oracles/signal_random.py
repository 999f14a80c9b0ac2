#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Oracle of tests/signal/random_test.cpp: the generators written again in Python's unbounded integers.

Run in this folder: python3 signal_random.py > signal_random.csv
"""
import math

MASK = (1 << 64) - 1
GAMMA = 0x9E3779B97F4A7C15


def mix(z):
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
    return z ^ (z >> 31)


def splitmix64(seed):
    while True:
        seed = (seed + GAMMA) & MASK
        yield mix(seed)


def rotl(x, k):
    return ((x << k) | (x >> (64 - k))) & MASK


def xoshiro256starstar(seed):
    words = splitmix64(seed)
    s = [next(words) for _ in range(4)]
    while True:
        yield (rotl((s[1] * 5) & MASK, 7) * 9) & MASK
        t = (s[1] << 17) & MASK
        s[2] ^= s[0]
        s[3] ^= s[1]
        s[1] ^= s[2]
        s[0] ^= s[3]
        s[2] ^= t
        s[3] = rotl(s[3], 45)


def normal(seed):
    """Ratio of uniforms with the exact acceptance test, without the quadratic bounds that only save time."""
    bits = xoshiro256starstar(seed)
    while True:
        u = 1.0 - (next(bits) >> 11) * 2.0**-53
        v = 1.7156 * ((next(bits) >> 11) * 2.0**-53 - 0.5)
        if v * v <= -4.0 * u * u * math.log(u):
            yield v / u


assert next(splitmix64(1234567)) == 6457827717110365317  # as published with the generator

bits_0, bits_42, normals = xoshiro256starstar(0), xoshiro256starstar(42), normal(42)
print("# signal_random.py")
print("bits_of_seed_0,bits_of_seed_42,normal_of_seed_42")
for _ in range(1000):
    print(f"{next(bits_0)},{next(bits_42)},{next(normals):.17g}")
