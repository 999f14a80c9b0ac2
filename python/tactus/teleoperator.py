# SPDX-License-Identifier: Apache-2.0
"""A running pair of leader and follower: your program has the screen, tactus has the servo thread."""

from __future__ import annotations

import atexit
import ctypes
import time
import weakref
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Mapping, Tuple

from . import _library
from ._words import Path, set_texts
from .errors import JobError

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray

    Array = NDArray[numpy.float64]

__all__ = ["Joints", "Report", "Sample", "State", "Teleoperator"]

_STATES = ("configure", "align", "armed", "active", "hold", "fault")


@dataclass(frozen=True)
class State:
    """How the pair is.

    Attributes:
        running: whether the servo thread runs.
        leader, follower: "configure" (no power yet), "align" (checks its motors), "armed" (the dead-man switch is
            released), "active" (coupled), "hold" (zero force until it is armed again), "fault" (zero force until
            `press("clear")`).
        leader_cause, follower_cause: why a site holds or has a fault, for instance "dead-man" or "device".
        line: a sentence for a person: states, what is wrong, what to do. Of the last whole second.
        cycle: number of the newest control cycle, missed ones counted.
    """

    running: bool
    leader: str
    follower: str
    leader_cause: str
    follower_cause: str
    line: str
    cycle: int


@dataclass(frozen=True, eq=False)
class Joints:
    """All joints of one side in one control cycle, arrays of shape (n,). rad, rad/s and N m for a joint that turns; m, m/s
    and N for one that slides.

    Attributes:
        position: read from the motor.
        velocity: as the drive reports it.
        torque: of the motor, as the drive reports it.
        command: torque commanded to the motor.
        external_torque: of the environment on the follower, in the joint's positive sense, as its controller estimates
            it; at the leader the one received. 0 for an architecture that sends none.
    """

    position: Array
    velocity: Array
    torque: Array
    command: Array
    external_torque: Array


@dataclass(frozen=True)
class Sample:
    """Both sides in one and the same control cycle.

    Attributes:
        time_ns: deadline of the cycle on CLOCK_MONOTONIC (`time.monotonic_ns()`), in ns; 0 before the first one.
        leader, follower: their joints.
    """

    time_ns: int
    leader: Joints
    follower: Joints


@dataclass(frozen=True)
class Report:
    """How a run went.

    Attributes:
        duration_s: in s.
        cycles, active_cycles: control cycles that ran; of them, those in which follower and leader were coupled.
        armings, holds: how often the leader came into these states; into "armed" also when the dead-man switch is
            released.
        missed: deadlines that no cycle answered.
        late: cycles that ended after the next deadline.
        late_own: of them, those that tactus caused, not the machine.
        latest_start_s: longest time from a deadline to the start of its cycle, in s.
        log_dropped: records that came faster than they were written.
    """

    duration_s: float
    cycles: int
    active_cycles: int
    armings: int
    holds: int
    missed: int
    late: int
    late_own: int
    latest_start_s: float
    log_dropped: int


class Teleoperator:
    """A pair of a rig file, supervised as by `tactus run EXPERIMENT --realtime --device RIG`.

        with tactus.Teleoperator("examples/rigs/joints.toml", "rig.toml", log_folder="out/log") as pair:
            pair.press("arm")
            pair.wait_until("active")
            print(pair.newest().follower.position)

    No motor has power until `press("arm")`. Any thread may use an object; the servo thread waits for none of them, and not
    for Python.

    Args:
        experiment: file of the kind `tapping` (joint by joint) or `arm-tapping` (two arms).
        rig: `FILE.toml`, or `FILE.toml:PAIR`.
        set: overrides of the experiment by dotted key.
        log_folder: in which every control cycle goes into `log.mcap`; without it no log is written.
        rehearsal: emulated motors in place of those of the rig file, as by `tactus rehearse`, and timeouts for an ordinary
            computer.
        hand_reach_rad: in a rehearsal of two arms, a hand moves each joint of the leader back and forth by so much, in
            rad; 0: the hand holds it still.
        hand_after_s: in s since the motors carry the arms.
        priority: of the servo thread under SCHED_FIFO, 1 to 99.
        sections: overrides as sections of the file, control={"force_gain": 0.5}.

    Raises:
        RequestError: a file or a value is wrong.
        JobError: a motor is not as the rig file states, or does not answer; the message names all of them.
    """

    def __init__(
        self, experiment: Path, rig: Path, *, set: Mapping[str, Any] | None = None, log_folder: Path | None = None,
        rehearsal: bool = False, hand_reach_rad: float = 0.0, hand_after_s: float = 4.0, priority: int = 80,
        **sections: Mapping[str, Any],
    ) -> None:
        self._handle = 0
        library = _library.library()
        overrides = set_texts(set, sections)
        words = _library.texts(overrides)
        options = _library.TeleoperatorOptions()
        options.experiment = _library.text(experiment)
        options.rig = _library.text(rig)
        options.set = words
        options.set_count = len(overrides)
        options.log_folder = _library.text(log_folder) if log_folder is not None else None
        options.rehearsal = 1 if rehearsal else 0
        options.priority = priority
        options.hand_reach_rad = hand_reach_rad
        options.hand_after_s = hand_after_s
        made = ctypes.c_uint64()
        _library.call(library.tactus_teleoperator_start, ctypes.byref(options), ctypes.byref(made))
        self._handle = made.value
        _running.add(self)
        self.joints, self.turns = self._describe()

    joints: Tuple[str, ...]
    """Names of the joints of each side."""
    turns: Tuple[bool, ...]
    """Whether each turns; one that does not slides."""

    def _describe(self) -> Tuple[Tuple[str, ...], Tuple[bool, ...]]:
        library = _library.library()
        view = _library.TeleoperatorView()
        _library.check(library.tactus_teleoperator_read(self._handle, ctypes.byref(view)))
        names, turn = [], []
        for joint in range(view.joints):
            name, turns = ctypes.c_char_p(), ctypes.c_int32()
            _library.check(
                library.tactus_teleoperator_joint(self._handle, joint, ctypes.byref(name), ctypes.byref(turns))
            )
            names.append(_library.text_of(name.value))
            turn.append(turns.value != 0)
        return tuple(names), tuple(turn)

    def press(self, word: str) -> None:
        """What the operator does.

        Args:
            word: "arm", "press" and "release" (the dead-man switch), "clutch", "unclutch", "stop" (emergency stop), "clear"
                (leave a fault); marks of an episode in the log: "start", "keep", "discard".

        Raises:
            RequestError: another word.
            JobError: the pair has ended, or too many words wait.
        """
        _library.call(_library.library().tactus_teleoperator_press, self._handle, _library.text(word))

    def state(self) -> State:
        """How the pair is now."""
        view = _library.TeleoperatorView()
        _library.check(_library.library().tactus_teleoperator_read(self._handle, ctypes.byref(view)))
        return State(
            running=bool(view.running),
            leader=_STATES[view.leader_state],
            follower=_STATES[view.follower_state],
            leader_cause=_library.text_of(view.leader_cause),
            follower_cause=_library.text_of(view.follower_cause),
            line=_library.text_of(view.line),
            cycle=int(view.cycle),
        )

    def wait_until(self, follower: str, *, timeout_s: float = 15.0) -> State:
        """Waits until the follower is in a state, for instance "active" or "hold".

        Raises:
            JobError: it is not after `timeout_s`, or the pair has ended; the message has the line of `state`.
        """
        if follower not in _STATES:
            raise ValueError(f"{follower!r} is no state: write one of {', '.join(_STATES)}")
        end = time.monotonic() + timeout_s
        while True:
            now = self.state()
            if now.follower == follower:
                return now
            if time.monotonic() > end or not now.running:
                raise JobError(f"the follower is {now.follower} ({now.follower_cause}), not {follower}: {now.line}")
            time.sleep(0.01)

    def newest(self) -> Sample:
        """Both sides in the newest control cycle."""
        import numpy

        count = len(self.joints)
        leader, follower = (_library.JointSample * count)(), (_library.JointSample * count)()
        time_ns = ctypes.c_int64()
        _library.check(
            _library.library().tactus_teleoperator_newest(self._handle, count, leader, follower, ctypes.byref(time_ns))
        )

        def joints_of(raw: Any) -> Joints:
            table = numpy.frombuffer(raw, dtype=numpy.float64).reshape(count, 5).T.copy()
            return Joints(*table)

        return Sample(time_ns=time_ns.value, leader=joints_of(leader), follower=joints_of(follower))

    def stop(self) -> Report:
        """Forces fall to zero, the motors lose their power, the log is closed. Takes about a second.

        Raises:
            JobError: a motor did not report that it is off, or the log could not be written.
        """
        library = _library.library()
        _library.call(library.tactus_teleoperator_stop, self._handle)
        view = _library.TeleoperatorReport()
        _library.check(library.tactus_teleoperator_report_read(self._handle, ctypes.byref(view)))
        return Report(**{name: getattr(view, name) for name, *_ in view._fields_ if name != "struct_size"})

    def close(self) -> None:
        """Stops it and frees it. Every later use raises `ReleasedError`. Closing twice is no error."""
        handle, self._handle = self._handle, 0
        if handle:
            _library.library().tactus_teleoperator_release(handle)

    def __enter__(self) -> Teleoperator:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_handle", 0):
            self.close()


_running: weakref.WeakSet[Teleoperator] = weakref.WeakSet()


@atexit.register
def _close_all() -> None:
    """Before the interpreter ends: devices in Python are called until then."""
    for pair in list(_running):
        pair.close()
