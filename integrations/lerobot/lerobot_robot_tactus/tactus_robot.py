# SPDX-License-Identifier: Apache-2.0
"""The follower as a robot of LeRobot."""

from __future__ import annotations

from lerobot.cameras.utils import make_cameras_from_configs
from lerobot.robots import Robot

from . import pair
from .config_tactus import TactusRobotConfig


class TactusRobot(pair.Half, Robot):
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

    @property
    def observation_features(self) -> dict:
        kinds = ("pos", "vel", "torque", "external_torque")
        features: dict = {f"{name}.{kind}": float for name in pair.joints_of(self.config) for kind in kinds}
        for name, camera in self.config.cameras.items():
            features[name] = (camera.height, camera.width, 3)
        return features

    @property
    def is_connected(self) -> bool:
        return self._pair is not None and all(camera.is_connected for camera in self.cameras.values())

    def connect(self, calibrate: bool = True) -> None:
        """Cameras first: they may take seconds, and then the arms are coupled. After an error nothing is connected."""
        self._refuse_connected()
        try:
            for camera in self.cameras.values():
                camera.connect()
            self._connect()
        except BaseException:
            self._disconnect_cameras()
            raise

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
        return self._action()

    def disconnect(self) -> None:
        self._disconnect()
        self._disconnect_cameras()

    def _disconnect_cameras(self) -> None:
        for camera in self.cameras.values():
            if camera.is_connected:
                camera.disconnect()
