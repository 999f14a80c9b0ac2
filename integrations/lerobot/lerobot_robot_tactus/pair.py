# SPDX-License-Identifier: Apache-2.0
"""The pair that robot and teleoperator share: it is started by the first that connects and stopped by the last."""

from __future__ import annotations

import math
import threading
from typing import Dict, Tuple

import tactus

_lock = threading.Lock()
_pairs: Dict[Tuple[str, str], "Pair"] = {}


class Pair:
    """A running teleoperator and how many use it."""

    def __init__(self, config) -> None:
        if not config.experiment or not config.rig:
            raise ValueError("experiment or rig is empty: name both files, for instance --robot.rig=rig.toml")
        self.users = 0
        self.running = tactus.Teleoperator(
            config.experiment, config.rig, set=config.set, log_folder=config.log_folder or None,
            rehearsal=config.rehearsal,
        )
        if config.arm:
            try:
                self.running.press("arm")
                self.running.wait_until("active", timeout_s=config.arm_timeout_s)
            except BaseException:
                self.running.close()
                raise


def share(config) -> Pair:
    """The pair of these files. Raises what `tactus.Teleoperator` raises."""
    key = (config.experiment, config.rig)
    with _lock:
        if key not in _pairs:
            _pairs[key] = Pair(config)
        _pairs[key].users += 1
        return _pairs[key]


def give_up(config) -> None:
    """Stops the pair if nobody else uses it."""
    key = (config.experiment, config.rig)
    with _lock:
        pair = _pairs[key]
        pair.users -= 1
        if pair.users == 0:
            del _pairs[key]
            pair.running.close()


def joints_of(config) -> Tuple[str, ...]:
    """Names of the joints, from the rig file alone: LeRobot asks for features before it connects."""
    try:
        import tomllib
    except ImportError:  # before Python 3.11
        raise ImportError("LeRobot needs Python 3.12 or newer, and so does this plug-in") from None
    file, _, name = config.rig.partition(".toml:")
    with open(file if file.endswith(".toml") else file + ".toml", "rb") as opened:
        rig = tomllib.load(opened)
    pairs = {key: value for key, value in rig.items() if isinstance(value, dict) and "leader" in value}
    pair = pairs[name] if name else next(iter(pairs.values()))
    return tuple(key for key, value in pair["leader"].items() if isinstance(value, dict))


def values(config, names: Tuple[str, ...], turns: Tuple[bool, ...], side, motion: bool) -> Dict[str, float]:
    """One side in LeRobot's flat keys. `motion`: velocity and torque too."""
    flat: Dict[str, float] = {}
    for joint, name in enumerate(names):
        scale = math.degrees(1.0) if config.use_degrees and turns[joint] else 1.0
        flat[f"{name}.pos"] = scale * float(side.position[joint])
        if motion:
            flat[f"{name}.vel"] = scale * float(side.velocity[joint])
            flat[f"{name}.torque"] = float(side.torque[joint])
    return flat


class Half:
    """What robot and teleoperator have in common; both hold `config`."""

    _pair: Pair | None = None

    @property
    def action_features(self) -> dict:
        kinds = ("pos", "vel", "torque") if self.config.use_velocity_and_torque else ("pos",)
        return {f"{name}.{kind}": float for name in joints_of(self.config) for kind in kinds}

    @property
    def is_calibrated(self) -> bool:
        return True  # the rig file has zeros, signs and limits

    def calibrate(self) -> None:
        """Nothing: `tactus device zero` writes zeros into the rig file."""

    def configure(self) -> None:
        """Nothing: the rig file configures the motors."""

    def _refuse_connected(self) -> None:
        if self._pair is not None:
            raise RuntimeError(f"{self} is already connected")

    def _connect(self) -> None:
        self._refuse_connected()
        self._pair = share(self.config)

    def _disconnect(self) -> None:
        self._connected()
        self._pair = None
        give_up(self.config)

    def _connected(self) -> Pair:
        if self._pair is None:
            raise RuntimeError(f"{self} is not connected: call connect() first")
        return self._pair

    def _action(self) -> dict:
        """Where the leader is, which is what the follower is sent."""
        running = self._connected().running
        return values(
            self.config, running.joints, running.turns, running.newest().leader, self.config.use_velocity_and_torque
        )
