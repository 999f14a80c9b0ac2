# SPDX-License-Identifier: Apache-2.0
"""Logs and recordings as dictionaries of arrays."""

from __future__ import annotations

import ctypes
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, Iterator, Mapping

from . import _library
from ._words import Path

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray

    Array = NDArray[numpy.float64]

__all__ = ["Log", "Table", "read_log"]


@dataclass(frozen=True, eq=False)
class Table(Mapping[str, "Array"]):
    """Columns of equal length: `table["displayed_force_N"]` is an array of shape (rows,).

    Attributes:
        name: the topic of a log, the variable of a MATLAB file, or the name of a text file.
        columns: each column by its name.
        units: the unit of each column, "N"; empty if the file states none.
        meanings: what each column is, in words; empty if the file does not state it.
        times_ns: of the rows of a log, unsigned whole numbers of ns; empty in a recording, whose times are a column.
        missing: messages of a log that its sequence numbers show to be missing.
    """

    name: str
    columns: Dict[str, Array]
    units: Dict[str, str]
    meanings: Dict[str, str]
    times_ns: NDArray[numpy.uint64]
    missing: int

    def __getitem__(self, name: str) -> Array:
        return self.columns[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def frame(self) -> Any:
        """The columns as a data frame of pandas, with the times of a log as index `time_s`, in s."""
        import pandas

        if self.times_ns.size == 0:
            return pandas.DataFrame(self.columns)
        return pandas.DataFrame(self.columns, index=pandas.Index(self.times_ns * 1e-9, name="time_s"))


@dataclass(frozen=True, eq=False)
class Log(Mapping[str, Table]):
    """The tables of a file, by name: `log["/master"]["displayed_force_N"]`.

    Attributes:
        tables: each table by its name.
        complete: False if the writer of a log was stopped, or bytes are missing at its end.
        damaged_chunks: parts of a log that were left out.
        damaged_elsewhere: whether a checksum outside of these parts is wrong.
    """

    tables: Dict[str, Table]
    complete: bool
    damaged_chunks: int
    damaged_elsewhere: bool

    def __getitem__(self, name: str) -> Table:
        return self.tables[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.tables)

    def __len__(self) -> int:
        return len(self.tables)


def read_log(path: Path, *, topic: str | None = None) -> Log:
    """Reads a log of tactus or a recording into memory.

    Args:
        path: a log (`.mcap`, or the folder that holds it) or a recording (`.csv`, `.tsv`, `.txt`, `.mat`).
        topic: of a log, only this one.

    Raises:
        RequestError: the file is missing, damaged, or not of a known format, or has no such topic.
    """
    library = _library.library()
    handle = ctypes.c_uint64()
    _library.call(
        library.tactus_log_open,
        os.fsencode(path),
        None if topic is None else topic.encode(),
        ctypes.byref(handle),
    )
    try:
        view = _library.LogView()
        _library.check(library.tactus_log_read(handle, ctypes.byref(view)))
        tables = [_table(library, handle, index) for index in range(view.tables)]
        return Log(
            tables={table.name: table for table in tables},
            complete=bool(view.complete),
            damaged_chunks=int(view.damaged_chunks),
            damaged_elsewhere=bool(view.damaged_elsewhere),
        )
    finally:
        library.tactus_log_release(handle)


def _table(library: Any, handle: ctypes.c_uint64, index: int) -> Table:
    import numpy

    view = _library.TableView()
    _library.check(library.tactus_log_table(handle, index, ctypes.byref(view)))
    columns: Dict[str, Any] = {}
    units: Dict[str, str] = {}
    meanings: Dict[str, str] = {}
    for place in range(view.columns):
        column = _library.ColumnView()
        _library.check(library.tactus_log_column(handle, index, place, ctypes.byref(column)))
        name = _library.text_of(column.name)
        values = numpy.empty(0)
        if column.rows:
            values = numpy.ctypeslib.as_array(column.values, (column.rows,)).copy()
        columns[name] = values
        units[name] = _library.text_of(column.unit)
        meanings[name] = _library.text_of(column.doc)
    times = numpy.empty(0, dtype=numpy.uint64)
    if view.rows and view.times_ns:
        times = numpy.ctypeslib.as_array(view.times_ns, (view.rows,)).copy()
    return Table(
        name=_library.text_of(view.name),
        columns=columns,
        units=units,
        meanings=meanings,
        times_ns=times,
        missing=int(view.missing),
    )
