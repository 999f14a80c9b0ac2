# SPDX-License-Identifier: Apache-2.0
"""What LeRobot's command line and files state of the pair. Both configurations name the same files."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Dict

from lerobot.cameras import CameraConfig
from lerobot.robots import RobotConfig
from lerobot.teleoperators import TeleoperatorConfig


@dataclass(kw_only=True)
class PairConfig:
    """The pair that tactus drives.

    Attributes:
        experiment: file of the kind `arm-tapping` (two arms) or `tapping` (joint by joint).
        rig: rig file, `FILE.toml` or `FILE.toml:PAIR`.
        set: overrides of the experiment by dotted key.
        log_folder: in which every control cycle goes into `log.mcap`; empty: no log.
        use_degrees: positions and velocities in degrees, as LeRobot has arms of Damiao motors; else in rad.
        use_velocity_and_torque: actions have velocity and torque too, not positions alone.
        arm: arm the pair when it is connected, and wait until both arms are coupled.
        arm_timeout_s: longest time to wait for that.
        rehearsal: emulated motors in place of those of the rig file.
    """

    experiment: str = ""
    rig: str = ""
    set: Dict[str, str] = field(default_factory=dict)
    log_folder: str = ""
    use_degrees: bool = True
    use_velocity_and_torque: bool = False
    arm: bool = True
    arm_timeout_s: float = 30.0
    rehearsal: bool = False


@RobotConfig.register_subclass("tactus")
@dataclass(kw_only=True)
class TactusRobotConfig(PairConfig, RobotConfig):
    cameras: Dict[str, CameraConfig] = field(default_factory=dict)


@TeleoperatorConfig.register_subclass("tactus")
@dataclass(kw_only=True)
class TactusLeaderConfig(PairConfig, TeleoperatorConfig):
    pass
