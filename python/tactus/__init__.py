# SPDX-License-Identifier: Apache-2.0
"""tactus: crisp and stable force-reflecting teleoperation, from Python.

Numbers have their unit in their name, keyword arguments are the keys of the files, and exceptions have the messages of the
`tactus` command. NumPy is needed for arrays, pandas for data frames, Matplotlib for figures (`tactus.plot`).
"""

from __future__ import annotations

from typing import Any

from . import plot
from .cancellation import Cancellation
from .commands import (
    Output,
    Result,
    advise,
    command,
    diagnose,
    estimate,
    faults,
    identify,
    reference,
    results_schema,
    run,
    schema,
    stability,
)
from .devices import JointDevice, MotorCommand, MotorReading, register_device
from .errors import Interrupted, JobError, ReleasedError, RequestError, TactusError
from .logs import Log, Table, read_log
from .results import Record
from .sweeps import Sweep, SweepRun, sweep
from .teleoperator import Joints, Report, Sample, State, Teleoperator

__version__: str

__all__ = [
    "Cancellation",
    "Interrupted",
    "JobError",
    "JointDevice",
    "Joints",
    "Log",
    "MotorCommand",
    "MotorReading",
    "Output",
    "Record",
    "ReleasedError",
    "Report",
    "RequestError",
    "Result",
    "Sample",
    "State",
    "Sweep",
    "SweepRun",
    "Table",
    "TactusError",
    "Teleoperator",
    "advise",
    "command",
    "diagnose",
    "estimate",
    "faults",
    "identify",
    "plot",
    "read_log",
    "reference",
    "register_device",
    "results_schema",
    "run",
    "schema",
    "stability",
    "sweep",
]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from ._library import library

        return library().tactus_version().decode()
    raise AttributeError(f"module 'tactus' has no attribute {name!r}")
