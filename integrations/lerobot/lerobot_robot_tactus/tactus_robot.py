"""The follower as a robot of LeRobot."""

from __future__ import annotations

from lerobot.cameras.utils import make_cameras_from_configs
from lerobot.robots import Robot

from . import pair
from .config_tactus import TactusRobotConfig


class TactusRobot(Robot):
    """Observations are the follower's joints: `NAME.pos`, `NAME.vel`, `NAME.torque` of its motor and
    `NAME.external_torque`, the contact that its controller estimates; and the cameras. Positions are in degrees or rad,
    velocities in degrees/s or rad/s, torques in N m.

    `send_action` drives nothing: the follower follows the leader in the servo thread of tactus, at the bus rate. It returns
    where the leader was, which is what the follower was really sent. A policy cannot lead the follower yet.
    """

    config_class = TactusRobotConfig
    name = "tactus"

    def __init__(self, config: TactusRobotConfig) -> None:
        super().__init__(config)
        self.config = config
        self.cameras = make_cameras_from_configs(config.cameras)
        self._pair = None

    @property
    def observation_features(self) -> dict:
        kinds = ("pos", "vel", "torque", "external_torque")
        features: dict = {f"{name}.{kind}": float for name in pair.joints_of(self.config) for kind in kinds}
        for name, camera in self.config.cameras.items():
            features[name] = (camera.height, camera.width, 3)
        return features

    @property
    def action_features(self) -> dict:
        kinds = ("pos", "vel", "torque") if self.config.use_velocity_and_torque else ("pos",)
        return {f"{name}.{kind}": float for name in pair.joints_of(self.config) for kind in kinds}

    @property
    def is_connected(self) -> bool:
        return self._pair is not None and all(camera.is_connected for camera in self.cameras.values())

    @property
    def is_calibrated(self) -> bool:
        return True  # the rig file has zeros, signs and limits

    def connect(self, calibrate: bool = True) -> None:
        if self._pair is not None:
            raise RuntimeError(f"{self} is already connected")
        for camera in self.cameras.values():
            camera.connect()
        self._pair = pair.share(self.config)

    def calibrate(self) -> None:
        """Nothing: `tactus device zero` writes zeros into the rig file."""

    def configure(self) -> None:
        """Nothing: the rig file configures the motors."""

    def get_observation(self) -> dict:
        running = self._connected().running
        sample = running.newest()
        state = running.state()
        if state.follower != "active" and self.config.arm:
            raise RuntimeError(f"the follower does not follow: {state.follower} ({state.follower_cause}); {state.line}")
        observation = pair.values(self.config, running.joints, running.turns, sample.follower, True)
        for joint, name in enumerate(running.joints):
            observation[f"{name}.external_torque"] = float(sample.follower.external_torque[joint])
        for name, camera in self.cameras.items():
            observation[name] = camera.read_latest()
        return observation

    def send_action(self, action: dict) -> dict:
        running = self._connected().running
        sample = running.newest()
        return pair.values(
            self.config, running.joints, running.turns, sample.leader, self.config.use_velocity_and_torque
        )

    def disconnect(self) -> None:
        self._connected()
        self._pair = None
        for camera in self.cameras.values():
            camera.disconnect()
        pair.give_up(self.config)

    def _connected(self):
        if self._pair is None:
            raise RuntimeError(f"{self} is not connected: call connect() first")
        return self._pair
