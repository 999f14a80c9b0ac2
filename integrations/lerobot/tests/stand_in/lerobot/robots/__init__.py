# SPDX-License-Identifier: Apache-2.0
import abc
from dataclasses import dataclass

from ..registry import ChoiceRegistry


@dataclass(kw_only=True)
class RobotConfig(ChoiceRegistry):
    id: "str | None" = None
    calibration_dir: "str | None" = None


class Robot(abc.ABC):
    def __init__(self, config):
        self.id = config.id

    @property
    @abc.abstractmethod
    def observation_features(self): ...

    @property
    @abc.abstractmethod
    def action_features(self): ...

    @property
    @abc.abstractmethod
    def is_connected(self): ...

    @property
    @abc.abstractmethod
    def is_calibrated(self): ...

    @abc.abstractmethod
    def connect(self, calibrate=True): ...

    @abc.abstractmethod
    def calibrate(self): ...

    @abc.abstractmethod
    def configure(self): ...

    @abc.abstractmethod
    def get_observation(self): ...

    @abc.abstractmethod
    def send_action(self, action): ...

    @abc.abstractmethod
    def disconnect(self): ...
