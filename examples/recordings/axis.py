#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the three recordings of one axis in this folder: axis-free-motion.csv, axis-contact.csv and axis-held.csv.

Simulated, not measured: a carriage of 0.8 kg with viscous friction of 4 N s/m and Coulomb friction of 0.6 N that sticks,
steps of 20 us, an encoder of 1 um, 1 kHz. Free and in contact, a servo makes it follow a path; held, its motor pulses
while a hand of 0.15 kg holds it.
"""
import math
import random
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
STEP_S, STEPS_A_SAMPLE = 2e-5, 50
MASS_KG, VISCOUS_N_S_PER_M, COULOMB_N = 0.8, 4.0, 0.6
ENCODER_M = 1e-6


def clamp(value, most):
    return max(-most, min(most, value))


def record(name, about, duration_s, drive, outside, columns, carried_kg=0.0):
    """Steps the carriage under drive(t, x, v), held for a sample, and outside(t, x, v), which moves carried_kg with it.

    Rows have the time, the position, and as many of both forces as there are columns.
    """
    x, v, acceleration, rows = 0.0, 0.0, 0.0, []
    mass_kg = MASS_KG + carried_kg
    for sample in range(round(duration_s * 1000)):
        t = sample / 1000
        force, place, speed, pull = drive(t, x, v), x, v, outside(t, x, v)
        for step in range(STEPS_A_SAMPLE):
            pushed = force + outside(t + step * STEP_S, x, v) - VISCOUS_N_S_PER_M * v
            v += STEP_S * pushed / mass_kg
            v -= clamp(v, STEP_S * COULOMB_N / mass_kg)
            x += STEP_S * v
            before, acceleration = acceleration, (v - speed) / STEP_S
            speed = v
            if step == 0:  # where the force jumps, a sensor's filter shows the middle
                pull -= carried_kg * 0.5 * (before + acceleration)
        rows.append((t, ENCODER_M * round(place / ENCODER_M), force, pull))
    text = [f"# Simulated, not measured: {about}", "# Written by examples/recordings/axis.py.", ",".join(columns)]
    text += [",".join([f"{t:.3f}", f"{x:.6f}", *(f"{force:.4f}" for force in forces)][: len(columns)]) for t, x, *forces in rows]
    (FOLDER / name).write_text("\n".join(text) + "\n")


def servo(path):
    """Pulls the carriage along path(t), whose speed it differentiates."""
    return lambda t, x, v: clamp(4000.0 * (path(t) - x) + 90.0 * ((path(t + 1e-4) - path(t)) / 1e-4 - v), 60.0)


def free_path(t):
    return sum(a * math.sin(2 * math.pi * f * t + p) for a, f, p in ((0.03, 0.43, 0.0), (0.012, 1.1, 1.0), (0.004, 2.9, 2.0), (0.001, 7.3, 0.5)))


def contact_path(t):
    return 0.02 * math.sin(2 * math.pi * 0.5 * t) + 0.003 * math.sin(2 * math.pi * 1.7 * t)


def wall(t, x, v):
    inside = x - 0.012
    return -max(0.0, 3000.0 * inside + 15.0 * v) if inside > 0.0 else 0.0


def hand(t, x, v):
    """A hand of 600 N/m and 12 N s/m that means to move slowly."""
    intended, speed = 0.01 * math.sin(2 * math.pi * 0.3 * t), 0.01 * 2 * math.pi * 0.3 * math.cos(2 * math.pi * 0.3 * t)
    return 600.0 * (intended - x) + 12.0 * (speed - v)


def pulses():
    random.seed(5)
    levels = [random.choice((-8.0, 0.0, 8.0)) for _ in range(2000)]
    return lambda t, x, v: levels[int(t * 1000) // 10]


if __name__ == "__main__":
    record("axis-free-motion.csv", "a carriage that a servo moves freely.", 8.0, servo(free_path), lambda t, x, v: 0.0,
           ("time_s", "position_m", "force_N"))
    record("axis-contact.csv", "the same carriage, pressed against a wall of 3000 N/m twice.", 4.0, servo(contact_path), wall,
           ("time_s", "position_m", "force_N", "measured_force_N"))
    record("axis-held.csv", "the same carriage in a hand of 600 N/m, 12 N s/m and 0.15 kg, its motor pulsing.", 6.0, pulses(), hand,
           ("time_s", "position_m", "motor_force_N", "hand_force_N"), carried_kg=0.15)
