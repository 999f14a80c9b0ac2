"""The leader as a teleoperator of LeRobot."""

from __future__ import annotations

from lerobot.teleoperators import Teleoperator

from . import pair
from .config_tactus import TactusLeaderConfig


class TactusLeader(Teleoperator):
    """Actions are the leader's joints: `NAME.pos`, with `use_velocity_and_torque` also `NAME.vel` and `NAME.torque`.
    Positions are in degrees or rad, velocities in degrees/s or rad/s, torques in N m.

    Force feedback is not in `send_feedback`, which LeRobot calls at 60 Hz at most: the servo thread of tactus gives it.
    """

    config_class = TactusLeaderConfig
    name = "tactus"

    def __init__(self, config: TactusLeaderConfig) -> None:
        super().__init__(config)
        self.config = config
        self._pair = None

    @property
    def action_features(self) -> dict:
        kinds = ("pos", "vel", "torque") if self.config.use_velocity_and_torque else ("pos",)
        return {f"{name}.{kind}": float for name in pair.joints_of(self.config) for kind in kinds}

    @property
    def feedback_features(self) -> dict:
        return {}

    @property
    def is_connected(self) -> bool:
        return self._pair is not None

    @property
    def is_calibrated(self) -> bool:
        return True  # the rig file has zeros, signs and limits

    def connect(self, calibrate: bool = True) -> None:
        if self._pair is not None:
            raise RuntimeError(f"{self} is already connected")
        self._pair = pair.share(self.config)

    def calibrate(self) -> None:
        """Nothing: `tactus device zero` writes zeros into the rig file."""

    def configure(self) -> None:
        """Nothing: the rig file configures the motors."""

    def get_action(self) -> dict:
        running = self._connected().running
        sample = running.newest()
        return pair.values(
            self.config, running.joints, running.turns, sample.leader, self.config.use_velocity_and_torque
        )

    def send_feedback(self, feedback: dict) -> None:
        """Nothing: the leader displays the follower's contact by itself."""

    def disconnect(self) -> None:
        self._connected()
        self._pair = None
        pair.give_up(self.config)

    def _connected(self):
        if self._pair is None:
            raise RuntimeError(f"{self} is not connected: call connect() first")
        return self._pair
