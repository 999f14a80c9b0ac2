# SPDX-License-Identifier: Apache-2.0
"""Simulated cameras: a frame is the time at which it was taken."""

import time


class Camera:
    def __init__(self, config):
        self.config = config
        self.is_connected = False

    def connect(self):
        self.is_connected = True

    def disconnect(self):
        self.is_connected = False

    def read_latest(self):
        return time.monotonic_ns()


def make_cameras_from_configs(configs):
    return {name: Camera(config) for name, config in configs.items()}
