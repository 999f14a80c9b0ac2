# SPDX-License-Identifier: Apache-2.0
"""The C library behind this package: where it is, its structs and its functions (tactus.h)."""

from __future__ import annotations

import ctypes
import functools
import os
import pathlib
from typing import Any, Callable, List

from .errors import TactusError, exception_of

INTERFACE_MAJOR, INTERFACE_MINOR = 0, 2
LIBRARY_NAME = "libtactus.so.0"

Progress = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_double, ctypes.c_void_p)


class _View(ctypes.Structure):
    """A struct that begins with its size."""

    def __init__(self) -> None:
        super().__init__(ctypes.sizeof(type(self)))


class ErrorView(_View):
    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("status", ctypes.c_int32),
        ("exit_status", ctypes.c_int32),
        ("line", ctypes.c_char_p),
        ("place", ctypes.c_char_p),
        ("parameter", ctypes.c_char_p),
        ("message", ctypes.c_char_p),
        ("value", ctypes.c_char_p),
        ("bounds", ctypes.c_char_p),
        ("remedy", ctypes.c_char_p),
    ]


class CancellationOptions(_View):
    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("sample_time_s", ctypes.c_double),
        ("file", ctypes.c_char_p),
        ("set", ctypes.POINTER(ctypes.c_char_p)),
        ("set_count", ctypes.c_size_t),
    ]


class CommandOptions(_View):
    _fields_ = [("struct_size", ctypes.c_size_t), ("progress", Progress), ("user", ctypes.c_void_p)]


class OutcomeView(_View):
    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("exit_status", ctypes.c_int32),
        ("results", ctypes.c_void_p),
        ("results_size", ctypes.c_size_t),
        ("messages", ctypes.c_void_p),
        ("messages_size", ctypes.c_size_t),
    ]


class LogView(_View):
    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("tables", ctypes.c_size_t),
        ("complete", ctypes.c_int32),
        ("damaged_elsewhere", ctypes.c_int32),
        ("damaged_chunks", ctypes.c_uint64),
    ]


class TableView(_View):
    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("name", ctypes.c_char_p),
        ("rows", ctypes.c_size_t),
        ("columns", ctypes.c_size_t),
        ("missing", ctypes.c_uint64),
        ("times_ns", ctypes.POINTER(ctypes.c_uint64)),
    ]


class ColumnView(_View):
    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("name", ctypes.c_char_p),
        ("unit", ctypes.c_char_p),
        ("doc", ctypes.c_char_p),
        ("values", ctypes.POINTER(ctypes.c_double)),
        ("rows", ctypes.c_size_t),
    ]


class MotorCommandStruct(ctypes.Structure):
    _fields_ = [
        ("torque_Nm", ctypes.c_double),
        ("law_position_rad", ctypes.c_double),
        ("law_velocity_rad_per_s", ctypes.c_double),
        ("law_stiffness_Nm_per_rad", ctypes.c_double),
        ("law_damping_Nms_per_rad", ctypes.c_double),
        ("enabled", ctypes.c_int32),
        ("reserved", ctypes.c_int32),
    ]


class MotorReadingStruct(ctypes.Structure):
    _fields_ = [
        ("position_rad", ctypes.c_double),
        ("velocity_rad_per_s", ctypes.c_double),
        ("torque_Nm", ctypes.c_double),
        ("temperature_C", ctypes.c_double),
        ("enabled", ctypes.c_int32),
        ("reserved", ctypes.c_int32),
    ]


MakeDevice = ctypes.CFUNCTYPE(
    ctypes.c_int32, ctypes.c_void_p, ctypes.c_char_p, ctypes.POINTER(ctypes.c_int64), ctypes.c_size_t,
    ctypes.POINTER(ctypes.c_void_p), ctypes.c_void_p, ctypes.c_size_t,
)
OpenDevice = ctypes.CFUNCTYPE(ctypes.c_int32, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)
ExchangeDevice = ctypes.CFUNCTYPE(
    ctypes.c_int32, ctypes.c_void_p, ctypes.POINTER(MotorCommandStruct), ctypes.POINTER(MotorReadingStruct),
    ctypes.c_size_t, ctypes.c_void_p, ctypes.c_size_t,
)
CloseDevice = ctypes.CFUNCTYPE(None, ctypes.c_void_p)


class JointDriver(_View):
    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("name", ctypes.c_char_p),
        ("summary", ctypes.c_char_p),
        ("cycle_s", ctypes.c_double),
        ("torque_limit_Nm", ctypes.c_double),
        ("velocity_limit_rad_per_s", ctypes.c_double),
        ("velocity_step_rad_per_s", ctypes.c_double),
        ("stiffness_limit_Nm_per_rad", ctypes.c_double),
        ("damping_limit_Nms_per_rad", ctypes.c_double),
        ("user", ctypes.c_void_p),
        ("make", MakeDevice),
        ("open", OpenDevice),
        ("exchange", ExchangeDevice),
        ("close", CloseDevice),
        ("release", CloseDevice),
    ]


class TeleoperatorOptions(_View):
    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("experiment", ctypes.c_char_p),
        ("rig", ctypes.c_char_p),
        ("set", ctypes.POINTER(ctypes.c_char_p)),
        ("set_count", ctypes.c_size_t),
        ("log_folder", ctypes.c_char_p),
        ("rehearsal", ctypes.c_int32),
        ("priority", ctypes.c_int32),
        ("hand_reach_rad", ctypes.c_double),
        ("hand_after_s", ctypes.c_double),
    ]


class TeleoperatorView(_View):
    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("running", ctypes.c_int32),
        ("leader_state", ctypes.c_int32),
        ("follower_state", ctypes.c_int32),
        ("reserved", ctypes.c_int32),
        ("leader_cause", ctypes.c_char_p),
        ("follower_cause", ctypes.c_char_p),
        ("line", ctypes.c_char_p),
        ("joints", ctypes.c_size_t),
        ("cycle", ctypes.c_int64),
        ("time_ns", ctypes.c_int64),
    ]


class JointSample(ctypes.Structure):
    _fields_ = [
        ("position", ctypes.c_double),
        ("velocity", ctypes.c_double),
        ("torque", ctypes.c_double),
        ("command", ctypes.c_double),
        ("external_torque", ctypes.c_double),
    ]


class TeleoperatorReport(_View):
    _fields_ = [
        ("struct_size", ctypes.c_size_t),
        ("duration_s", ctypes.c_double),
        ("cycles", ctypes.c_int64),
        ("active_cycles", ctypes.c_int64),
        ("armings", ctypes.c_int64),
        ("holds", ctypes.c_int64),
        ("missed", ctypes.c_int64),
        ("late", ctypes.c_int64),
        ("late_own", ctypes.c_int64),
        ("latest_start_s", ctypes.c_double),
        ("log_dropped", ctypes.c_uint64),
    ]


_handle = ctypes.c_uint64
_to_handle = ctypes.POINTER(ctypes.c_uint64)
_to_double = ctypes.POINTER(ctypes.c_double)
_size = ctypes.c_size_t

# Arguments of each function; all but tactus_version return a status.
_FUNCTIONS: dict[str, list[Any]] = {
    "tactus_version": [],
    "tactus_check_interface": [ctypes.c_int32, ctypes.c_int32, _to_handle],
    "tactus_error_read": [_handle, ctypes.POINTER(ErrorView)],
    "tactus_error_release": [_handle],
    "tactus_cancellation_make": [ctypes.POINTER(CancellationOptions), _to_handle, _to_handle],
    "tactus_cancellation_step": [_handle, ctypes.c_double, ctypes.c_double, _to_double],
    "tactus_cancellation_intended": [_handle, ctypes.c_double, _to_double],
    "tactus_cancellation_advance": [_handle, ctypes.c_double],
    "tactus_cancellation_step_array": [_handle, _size, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p],
    "tactus_cancellation_induced": [_handle, _to_double],
    "tactus_cancellation_reset": [_handle],
    "tactus_cancellation_copy": [_handle, _to_handle, _to_handle],
    "tactus_cancellation_release": [_handle],
    "tactus_command": [
        ctypes.POINTER(ctypes.c_char_p), _size, ctypes.POINTER(CommandOptions), _to_handle, _to_handle,
    ],
    "tactus_outcome_read": [_handle, ctypes.POINTER(OutcomeView)],
    "tactus_outcome_release": [_handle],
    "tactus_log_open": [ctypes.c_char_p, ctypes.c_char_p, _to_handle, _to_handle],
    "tactus_log_read": [_handle, ctypes.POINTER(LogView)],
    "tactus_log_table": [_handle, _size, ctypes.POINTER(TableView)],
    "tactus_log_column": [_handle, _size, _size, ctypes.POINTER(ColumnView)],
    "tactus_log_release": [_handle],
    "tactus_joint_driver_register": [ctypes.POINTER(JointDriver), _to_handle],
    "tactus_teleoperator_start": [ctypes.POINTER(TeleoperatorOptions), _to_handle, _to_handle],
    "tactus_teleoperator_press": [_handle, ctypes.c_char_p, _to_handle],
    "tactus_teleoperator_read": [_handle, ctypes.POINTER(TeleoperatorView)],
    "tactus_teleoperator_joint": [
        _handle, _size, ctypes.POINTER(ctypes.c_char_p), ctypes.POINTER(ctypes.c_int32),
    ],
    "tactus_teleoperator_newest": [
        _handle, _size, ctypes.POINTER(JointSample), ctypes.POINTER(JointSample), ctypes.POINTER(ctypes.c_int64),
    ],
    "tactus_teleoperator_stop": [_handle, _to_handle],
    "tactus_teleoperator_report_read": [_handle, ctypes.POINTER(TeleoperatorReport)],
    "tactus_teleoperator_release": [_handle],
}


def _candidates() -> List[str]:
    """Where the library may be, the first that is there counts: the file that TACTUS_LIBRARY names, the package, the
    build beside a source folder, the system."""
    named = os.environ.get("TACTUS_LIBRARY")
    if named:
        return [named]
    here = pathlib.Path(__file__).resolve().parent
    files = [here / "lib" / LIBRARY_NAME, here.parent.parent / "build" / "release" / "lib" / LIBRARY_NAME]
    return [str(file) for file in files if file.exists()] + [LIBRARY_NAME]


@functools.lru_cache(maxsize=None)
def library() -> Any:
    """The library, loaded at the first use. Raises `ImportError` if it is missing or of another version."""
    name = _candidates()[0]
    try:
        loaded = ctypes.CDLL(name)
    except OSError as error:
        raise ImportError(
            f"the library of tactus cannot be loaded ({error}): build it with `cmake --build build/release --target "
            "tactus_c_api`, or let TACTUS_LIBRARY name the file"
        ) from error
    for function, arguments in _FUNCTIONS.items():
        try:
            bound = getattr(loaded, function)
        except AttributeError as error:
            raise ImportError(f"{name} has no {function}: install package and library of one version") from error
        bound.argtypes = arguments
        bound.restype = ctypes.c_int32
    loaded.tactus_version.restype = ctypes.c_char_p
    failure = ctypes.c_uint64()
    if loaded.tactus_check_interface(INTERFACE_MAJOR, INTERFACE_MINOR, ctypes.byref(failure)) != 0:
        raise ImportError(str(take_error(loaded, 1, failure)))
    return loaded


def text_of(raw: bytes | None) -> str:
    return raw.decode("utf-8", "replace") if raw else ""


def bare_error(status: int) -> TactusError:
    """The exception of a status of which the library reports nothing more."""
    raised, kind, line = exception_of(status)
    return raised(line, kind=kind, exit_status=2)


def take_error(loaded: Any, status: int, handle: ctypes.c_uint64) -> TactusError:
    """The exception of a status, with what the error's handle holds, which is released."""
    view = ErrorView()
    if handle.value == 0 or loaded.tactus_error_read(handle, ctypes.byref(view)) != 0:
        return bare_error(status)
    raised, kind, line = exception_of(view.status)
    error = raised(
        text_of(view.line) or line,
        kind=kind,
        place=text_of(view.place),
        parameter=text_of(view.parameter),
        message=text_of(view.message),
        value=text_of(view.value),
        bounds=text_of(view.bounds),
        remedy=text_of(view.remedy),
        exit_status=view.exit_status,
    )
    loaded.tactus_error_release(handle)
    return error


def call(function: Callable[..., int], *arguments: Any) -> None:
    """Calls a function whose last parameter is where the error is left, and raises what it reports."""
    failure = ctypes.c_uint64()
    status = function(*arguments, ctypes.byref(failure))
    if status != 0:
        raise take_error(library(), status, failure)


def check(status: int) -> None:
    """Raises the exception of a status that has no further error."""
    if status != 0:
        raise bare_error(status)


def text(word: str | os.PathLike[str]) -> bytes:
    """A C string. Raises `ValueError` for a zero byte, which would end it."""
    encoded = os.fsencode(word)
    if b"\0" in encoded:
        raise ValueError(f"{os.fspath(word)!r} has a zero byte: leave it out")
    return encoded


def texts(words: List[str]) -> Any:
    """An array of C strings."""
    encoded = [text(word) for word in words]
    return (ctypes.c_char_p * max(len(encoded), 1))(*encoded)
