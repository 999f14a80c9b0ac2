# SPDX-License-Identifier: Apache-2.0
"""The leader as a teleoperator of LeRobot."""

from __future__ import annotations

from lerobot.teleoperators import Teleoperator

from . import pair
from .config_tactus import TactusLeaderConfig


class TactusLeader(pair.Half, Teleoperator):
    """Actions are the leader's joints: `NAME.pos`, with `use_velocity_and_torque` also `NAME.vel` and `NAME.torque`.
    Positions are in degrees or rad, velocities in degrees/s or rad/s, torques in N m.

    Force feedback is not in `send_feedback`, which LeRobot calls at 60 Hz at most: the servo thread of tactus gives it.
    """

    config_class = TactusLeaderConfig
    name = "tactus"

    def __init__(self, config: TactusLeaderConfig) -> None:
        super().__init__(config)
        self.config = config

    @property
    def feedback_features(self) -> dict:
        return {}

    @property
    def is_connected(self) -> bool:
        return self._pair is not None

    def connect(self, calibrate: bool = True) -> None:
        self._connect()

    def get_action(self) -> dict:
        return self._action()

    def send_feedback(self, feedback: dict) -> None:
        """Nothing: the leader displays the follower's contact by itself."""

    def disconnect(self) -> None:
        self._disconnect()
