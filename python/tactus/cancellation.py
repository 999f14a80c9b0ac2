# SPDX-License-Identifier: Apache-2.0
"""Cancellation of induced leader motion, for a control loop of your own."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Mapping, overload

from . import _library
from ._words import Path, set_texts

if TYPE_CHECKING:
    import numpy
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[numpy.float64]

__all__ = ["Cancellation"]


class Cancellation:
    """Where the operator meant the motor of the leader to be, from where it is and which force it displays.

    One axis. Positions in m and forces in N, both positive toward the environment, so a force that pushes the hand back
    is negative. An object is used in one thread at a time; different objects may be used in different threads.

        cancellation = tactus.Cancellation("model.toml", sample_time_s=200e-6)
        intended_m = cancellation.step(encoder_m, -displayed_N)  # once per control cycle

    Args:
        file: model of your device, as `tactus identify quick --out` writes it (`model.toml`), with every
            key of the tables of `control.model`. Without it: the leader of the published paper.
        sample_time_s: of your control loop, greater than 0.
        set: overrides by dotted key, {"control.model.motor.mass_kg": 0.02}.
        sections: overrides as sections of the file, control={"cancellation_friction": "at-rest"}.

    Raises:
        RequestError: the file or a value is wrong; the message names place, value, bounds and remedy.
    """

    def __init__(
        self, file: Path | None = None, *, sample_time_s: float, set: Mapping[str, Any] | None = None,
        **sections: Mapping[str, Any],
    ) -> None:
        self._handle = 0
        library = _library.library()
        overrides = set_texts(set, sections)
        options = _library.CancellationOptions()
        options.sample_time_s = sample_time_s
        options.file = _library.text(file) if file is not None else None
        words = _library.texts(overrides)
        options.set = words
        options.set_count = len(overrides)
        made = ctypes.c_uint64()
        _library.call(library.tactus_cancellation_make, ctypes.byref(options), ctypes.byref(made))
        self._use(made.value)

    def _use(self, handle: int) -> None:
        library = _library.library()
        self._handle = handle
        self._step = library.tactus_cancellation_step
        self._out = ctypes.c_double()
        self._to_out = ctypes.byref(self._out)
        self._release = library.tactus_cancellation_release

    @overload
    def step(self, measured_position_m: float, motor_force_N: float) -> float: ...

    @overload
    def step(self, measured_position_m: Array, motor_force_N: ArrayLike) -> Array: ...

    def step(self, measured_position_m: Any, motor_force_N: Any) -> Any:
        """One control cycle, or one for each element of arrays of equal shape (n,).

        Args:
            measured_position_m: of the motor, now, in m.
            motor_force_N: that acts on the motor from now to the next cycle, in N.

        Returns:
            The position in m that the operator meant: a number, or an array of shape (n,). An array is equal bit for
            bit to as many single calls, and takes one call of the library, during which other Python threads run.

        Raises:
            RequestError: a position or a force is not a finite number. No cycle was computed.
        """
        try:
            status = self._step(self._handle, measured_position_m, motor_force_N, self._to_out)
        except ctypes.ArgumentError:
            return self._step_array(measured_position_m, motor_force_N)
        if status:
            _library.check(status)
        return self._out.value

    def _step_array(self, measured_position_m: Any, motor_force_N: Any) -> Any:
        import numpy

        measured = numpy.asarray(measured_position_m, dtype=numpy.float64)
        force = numpy.asarray(motor_force_N, dtype=numpy.float64)
        if measured.ndim == 0 and force.ndim == 0:  # numbers of another type
            _library.check(self._step(self._handle, float(measured), float(force), self._to_out))
            return self._out.value
        if force.ndim == 0:
            force = numpy.full(measured.shape, float(force))
        if measured.ndim != 1 or measured.shape != force.shape:
            raise ValueError(
                f"positions of shape {measured.shape} and forces of shape {force.shape}: pass one force for each "
                "position, both of shape (n,)"
            )
        measured, force = numpy.ascontiguousarray(measured), numpy.ascontiguousarray(force)
        intended = numpy.empty_like(measured)
        _library.check(
            _library.library().tactus_cancellation_step_array(
                self._handle, measured.size, measured.ctypes.data, force.ctypes.data, intended.ctypes.data
            )
        )
        return intended

    def intended(self, measured_position_m: float) -> float:
        """The position in m that the operator meant, if your loop computes its force from it. Call `advance` after it."""
        _library.check(
            _library.library().tactus_cancellation_intended(self._handle, measured_position_m, self._to_out)
        )
        return self._out.value

    def advance(self, motor_force_N: float) -> None:
        """Advances the model by one cycle under the force in N that is really displayed."""
        _library.check(_library.library().tactus_cancellation_advance(self._handle, motor_force_N))

    @property
    def induced_position_m(self) -> float:
        """How far the displayed force has moved the motor by the model, in m."""
        _library.check(_library.library().tactus_cancellation_induced(self._handle, self._to_out))
        return self._out.value

    def reset(self) -> None:
        """Back to rest."""
        _library.check(_library.library().tactus_cancellation_reset(self._handle))

    def copy(self) -> Cancellation:
        """A second one in the same state, which goes its own way from here."""
        made = ctypes.c_uint64()
        _library.call(_library.library().tactus_cancellation_copy, self._handle, ctypes.byref(made))
        other = Cancellation.__new__(Cancellation)
        other._use(made.value)
        return other

    def close(self) -> None:
        """Frees it. Every later use raises `ReleasedError`. Closing twice is no error."""
        handle, self._handle = self._handle, 0
        if handle:
            self._release(handle)

    def __enter__(self) -> Cancellation:
        return self

    def __exit__(self, *exception: object) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_handle", 0):
            self.close()
