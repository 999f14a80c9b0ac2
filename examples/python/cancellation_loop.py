#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A control loop of your own around `tactus.Cancellation`, in Python.

A hand moves a simulated leader, one mass on the spring and the damper of the hand, at 50 mm/s. Ten times a second an impact
of 1 N and 10 ms is displayed to it. The same hand moves the same leader without the impacts: that is what the operator
intended. Run it with `PYTHONPATH=python python3 examples/python/cancellation_loop.py` after the build.
"""

import math

import tactus

CYCLE_S = 200e-6
SUBSTEPS = 20
MASS_KG, HAND_N_PER_M, HAND_N_S_PER_M = 0.03225, 40.0, 23.0


class Leader:
    """One mass that the hand pulls along: m x'' = force - k (x - hand) - b (x' - hand')."""

    def __init__(self) -> None:
        self.position_m = 0.0
        self.velocity_m_per_s = 0.0

    def step(self, force_N: float, hand_m: float, hand_m_per_s: float) -> None:
        dt = CYCLE_S / SUBSTEPS
        pull_N = HAND_N_PER_M * (hand_m - self.position_m) + HAND_N_S_PER_M * (hand_m_per_s - self.velocity_m_per_s)
        self.velocity_m_per_s += dt * (force_N + pull_N) / MASS_KG
        self.position_m += dt * self.velocity_m_per_s


def main() -> None:
    # The model has the mass and the hand of this leader. A leader of yours has a file: `tactus identify quick --out`.
    cancellation = tactus.Cancellation(
        sample_time_s=CYCLE_S,
        control={
            "cancellation_model": "second-order",
            "model": {
                "linear_hand_stiffening": 1.0,
                "hand": {"stiffness_N_per_m": HAND_N_PER_M, "damping_N_s_per_m": HAND_N_S_PER_M},
            },
        },
    )
    leader, undisturbed = Leader(), Leader()
    moved_m = left_m = 0.0
    for cycle in range(5000):
        phase = math.fmod(cycle * CYCLE_S, 0.1) / 0.01
        displayed_N = math.sin(math.pi * phase) if phase < 1.0 else 0.0

        intended_m = cancellation.intended(leader.position_m)  # what the follower gets as its command
        cancellation.advance(-displayed_N)  # a force that pushes the hand back is negative

        moved_m = max(moved_m, abs(leader.position_m - undisturbed.position_m))
        left_m = max(left_m, abs(intended_m - undisturbed.position_m))
        for substep in range(SUBSTEPS):
            hand_m = 0.05 * CYCLE_S * (cycle + substep / SUBSTEPS)
            leader.step(-displayed_N, hand_m, 0.05)
            undisturbed.step(0.0, hand_m, 0.05)
    print(
        f"The impacts moved the motor by up to {1e6 * moved_m:.0f} um, "
        f"and the intended position by up to {1e6 * left_m:.0f} um."
    )


if __name__ == "__main__":
    main()
