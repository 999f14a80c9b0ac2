# SPDX-License-Identifier: Apache-2.0
"""A pair of arms with force feedback as robot and teleoperator of LeRobot, both named `tactus`.

tactus owns both arms in its servo thread; LeRobot's loop reads observations and actions from it and drives nothing.
"""

from .config_tactus import TactusLeaderConfig, TactusRobotConfig
from .tactus_leader import TactusLeader
from .tactus_robot import TactusRobot

__all__ = ["TactusLeader", "TactusLeaderConfig", "TactusRobot", "TactusRobotConfig"]
