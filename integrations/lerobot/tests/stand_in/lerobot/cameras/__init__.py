# SPDX-License-Identifier: Apache-2.0
from dataclasses import dataclass


@dataclass
class CameraConfig:
    width: int = 64
    height: int = 48
    fps: int = 60
