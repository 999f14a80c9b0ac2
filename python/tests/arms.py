# SPDX-License-Identifier: Apache-2.0
"""Arms in the place of a vendor's library, in Python: two joints behind a call that blocks."""

import os
import signal
import time

import tactus


class StandIn(tactus.JointDevice):
    """Two joints with inertia and damping. Without a command for 50 ms the arm drops its torque, as controllers do."""

    torque_limit_Nm = 5.0
    velocity_step_rad_per_s = 1e-4

    def open(self):
        self.position, self.velocity = [0.0, 0.0], [0.0, 0.0]
        self.then = time.monotonic()
        self.cycles = 0

    def exchange(self, commands):
        self.cycles += 1
        self.at_cycle(self.cycles)
        now = time.monotonic()
        passed = now - self.then
        self.then = now
        for joint, command in enumerate(commands):
            torque = command.torque_Nm if command.enabled and passed < 0.05 else 0.0
            for _ in range(max(1, round(min(passed, 0.2) / 0.001))):
                step = min(passed, 0.2) / max(1, round(min(passed, 0.2) / 0.001))
                self.velocity[joint] += step * (torque - 0.2 * self.velocity[joint]) / 0.1
                self.position[joint] += step * self.velocity[joint]
        return [tactus.MotorReading(position, velocity, command.torque_Nm, command.enabled)
                for position, velocity, command in zip(self.position, self.velocity, commands)]

    def at_cycle(self, cycle):
        """What goes wrong."""


class Throws(StandIn):
    def at_cycle(self, cycle):
        if cycle == 1500:
            raise OSError("the robot reported a collision")


class Sleeps(StandIn):
    def at_cycle(self, cycle):
        if cycle == 1500:
            time.sleep(0.3)


class Dies(StandIn):
    def at_cycle(self, cycle):
        if cycle == 1500:
            os.kill(os.getpid(), signal.SIGKILL)
