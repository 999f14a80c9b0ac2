# SPDX-License-Identifier: Apache-2.0
"""Arms and handles whose driver is written in Python."""

from __future__ import annotations

import ctypes
import itertools
import math
from dataclasses import dataclass
from typing import Any, Dict, List, Sequence, Tuple, Type

from . import _library

__all__ = ["JointDevice", "MotorCommand", "MotorReading", "register_device"]


@dataclass(frozen=True)
class MotorCommand:
    """Command to one motor for one cycle, at the output of its gear, in its own sense of rotation.

    Attributes:
        torque_Nm: to give, in N m.
        enabled: False: the motor must have no torque.
        law_position_rad, law_velocity_rad_per_s, law_stiffness_Nm_per_rad, law_damping_Nms_per_rad: of the law that the
            drive runs in addition to the torque. Gains are 0 unless the device states their limits.
    """

    torque_Nm: float
    enabled: bool
    law_position_rad: float = 0.0
    law_velocity_rad_per_s: float = 0.0
    law_stiffness_Nm_per_rad: float = 0.0
    law_damping_Nms_per_rad: float = 0.0


@dataclass(frozen=True)
class MotorReading:
    """What one motor reports.

    Attributes:
        position_rad: in rad, continuing where a single turn wraps.
        velocity_rad_per_s: in rad/s.
        torque_Nm: of the motor, in N m.
        enabled: whether the drive has power.
        temperature_C: in °C; not a number if it is not reported.
    """

    position_rad: float
    velocity_rad_per_s: float = 0.0
    torque_Nm: float = 0.0
    enabled: bool = True
    temperature_C: float = math.nan


class JointDevice:
    """Base class of your own driver: an arm or handle that is reached by calls that block.

    Write `exchange`, and `open` and `close` if the device needs them. tactus calls them on a thread of the device's own,
    one after another. They may block and raise. While `exchange` blocks, readings age: after `watchdog_s` of the rig file
    both sites hold with zero force. What is raised ends the device, `close` is called, and both sites hold with the
    reason.

        class MyArm(tactus.JointDevice):
            def open(self):
                self.robot = vendor.connect(self.port)

            def exchange(self, commands):
                state = self.robot.cycle([command.torque_Nm if command.enabled else 0.0 for command in commands])
                return [tactus.MotorReading(q, dq) for q, dq in zip(state.q, state.dq)]

        tactus.register_device("my-arm", MyArm)  # a rig file names it: bus = "my-arm"

    **The device must remove its torque by itself when `exchange` is no longer called**: the program may be killed at any
    time. Controllers of robots do.

    Attributes:
        port: as written in the rig file, or empty.
        motors: the key `motor` of each joint, in the order of the rig file.
        cycle_s: shortest time from one `exchange` to the next, in s.
        torque_limit_Nm: largest torque of each motor, in N m; 0: not known. A rig file that exceeds it is refused.
        velocity_limit_rad_per_s: largest velocity that readings can represent, in rad/s; 0: not known.
        velocity_step_rad_per_s: step of a velocity that is measured, in rad/s. 0: it is derived from positions. If it is
            measured, position and velocity are compared, so that a frozen encoder is found.
        stiffness_limit_Nm_per_rad, damping_limit_Nms_per_rad: of the law that the drive runs; both 0: it runs none.
    """

    cycle_s: float = 0.002
    torque_limit_Nm: float = 0.0
    velocity_limit_rad_per_s: float = 0.0
    velocity_step_rad_per_s: float = 0.0
    stiffness_limit_Nm_per_rad: float = 0.0
    damping_limit_Nms_per_rad: float = 0.0

    def __init__(self, port: str, motors: Tuple[int, ...]) -> None:
        self.port = port
        self.motors = motors

    def open(self) -> None:
        """Connects, without torque."""

    def exchange(self, commands: Sequence[MotorCommand]) -> Sequence[MotorReading]:
        """One cycle: sends a command to every motor, returns what every motor reports, in the same order."""
        raise NotImplementedError(f"{type(self).__name__} has no exchange: write it")

    def close(self) -> None:
        """Removes all torque and disconnects. Called once after `open`, whether or not that succeeded."""


def _serve(connection: Any, kind: Type[JointDevice], port: str, motors: Tuple[int, ...]) -> None:
    """The process of a device: answers one call after another."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the program, which closes the device
    device: JointDevice | None = None
    while True:
        try:
            word, given = connection.recv()
        except EOFError:  # the program is gone
            word, given = "close", None
        try:
            answer: Any = None
            if word == "open":
                device = kind(port, motors)
                device.open()
            elif word == "exchange" and device is not None:
                answer = list(device.exchange(given))
            elif word == "close" and device is not None:
                device.close()
            connection.send((True, answer))
        except BrokenPipeError:
            return
        except BaseException as error:
            connection.send((False, _reason(error)))
        if word == "close":
            return


class _InItsProcess(JointDevice):
    """A device whose functions run in a process of its own."""

    kind: Type[JointDevice] = JointDevice

    def open(self) -> None:
        import multiprocessing  # takes long

        context = multiprocessing.get_context("spawn")
        self.connection, other = context.Pipe()
        self.process = context.Process(
            target=_serve, args=(other, self.kind, self.port, self.motors), name="tactus device", daemon=True
        )
        self.process.start()
        other.close()
        self._ask("open", None)

    def exchange(self, commands: Sequence[MotorCommand]) -> Sequence[MotorReading]:
        readings: Sequence[MotorReading] = self._ask("exchange", commands)
        return readings

    def close(self) -> None:
        if not hasattr(self, "process"):
            return
        try:
            self.connection.send(("close", None))
        except OSError:
            pass
        self.process.join(1.0)
        if self.process.is_alive():
            self.process.kill()
            self.process.join(1.0)
        self.connection.close()

    def _ask(self, word: str, given: Any) -> Any:
        try:
            self.connection.send((word, given))
            good, answer = self.connection.recv()
        except (EOFError, OSError):
            self.process.join(1.0)
            raise RuntimeError(
                f"the process of the device ended (exit status {self.process.exitcode}): start it again"
            ) from None
        if not good:
            raise RuntimeError(answer)
        return answer


def _reason(error: BaseException) -> str:
    text = str(error)
    return text if type(error) is RuntimeError and text else f"{type(error).__name__}: {text}"


_devices: Dict[int, JointDevice] = {}
_numbers = itertools.count(1)
_kept: List[Any] = []  # the library calls these functions for as long as the program runs


def register_device(name: str, kind: Type[JointDevice], *, summary: str = "", own_process: bool = False) -> None:
    """Adds a device: a side of a rig file whose key is `bus = "NAME"` is driven by an object of this class.

    Args:
        name: the word after `bus =`. A device of the same name is replaced.
        kind: class of the device. It is called with `port` and `motors`, once to ask the motors and once to drive them.
        summary: one line.
        own_process: run the device in a process of its own. Its Python code is then not slowed down by other threads of
            your program, and a device that crashes does not take the program with it: both sites hold with the reason.
            The class must be importable.

    Raises:
        RequestError: the name is empty or that of a built-in bus, or a limit is out of bounds.
    """
    driven = type(kind.__name__, (_InItsProcess,), {"kind": kind}) if own_process else kind

    def failed(error: BaseException, why: int, size: int) -> int:
        text = _reason(error).encode("utf-8", "replace")[: max(size - 1, 0)]
        ctypes.memmove(why, text + b"\0", len(text) + 1)
        return 1

    def make(_user: Any, port: Any, motors: Any, count: int, device: Any, why: int, size: int) -> int:
        try:
            made = driven(_library.text_of(port), tuple(int(motors[i]) for i in range(count)))
            number = next(_numbers)
            _devices[number] = made
            device[0] = number
            return 0
        except BaseException as error:
            return failed(error, why, size)

    def open_device(device: int, why: int, size: int) -> int:
        try:
            _devices[device].open()
            return 0
        except BaseException as error:
            return failed(error, why, size)

    def exchange(device: int, commands: Any, readings: Any, motors: int, why: int, size: int) -> int:
        try:
            given = [
                MotorCommand(
                    one.torque_Nm, one.enabled != 0, one.law_position_rad, one.law_velocity_rad_per_s,
                    one.law_stiffness_Nm_per_rad, one.law_damping_Nms_per_rad,
                )
                for one in commands[:motors]
            ]
            reported = _devices[device].exchange(given)
            if len(reported) != motors:
                raise ValueError(f"exchange returned {len(reported)} readings for {motors} motors: return one for each")
            for place, one in enumerate(reported):
                into = readings[place]
                into.position_rad = one.position_rad
                into.velocity_rad_per_s = one.velocity_rad_per_s
                into.torque_Nm = one.torque_Nm
                into.temperature_C = one.temperature_C
                into.enabled = 1 if one.enabled else 0
            return 0
        except BaseException as error:
            return failed(error, why, size)

    def close(device: int) -> None:
        try:
            _devices[device].close()
        except Exception:
            pass  # the device has ended, and its reason is known

    def release(device: int) -> None:
        _devices.pop(device, None)

    driver = _library.JointDriver()
    driver.name = _library.text(name)
    driver.summary = _library.text(summary)
    for limit in (
        "cycle_s", "torque_limit_Nm", "velocity_limit_rad_per_s", "velocity_step_rad_per_s", "stiffness_limit_Nm_per_rad",
        "damping_limit_Nms_per_rad",
    ):
        setattr(driver, limit, getattr(kind, limit))
    driver.make = _library.MakeDevice(make)
    driver.open = _library.OpenDevice(open_device)
    driver.exchange = _library.ExchangeDevice(exchange)
    driver.close = _library.CloseDevice(close)
    driver.release = _library.CloseDevice(release)
    _library.call(_library.library().tactus_joint_driver_register, ctypes.byref(driver))
    _kept.append(driver)
