# SPDX-License-Identifier: Apache-2.0
"""Figures of a rig's episodes; users find `episode` in `plot`."""

from __future__ import annotations

import csv
import json
import os
import tempfile
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Sequence, Tuple, Union

from ._figures import BLUE, GREEN, MAGENTA, ORANGE, Grid, in_words, with_unit
from ._words import Path
from .commands import command

if TYPE_CHECKING:
    import numpy
    import pandas
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike, NDArray

    Array = NDArray[numpy.float64]
    Columns = Union[Mapping[str, ArrayLike], pandas.DataFrame]

_MOST_JOINTS = 12
_SHOWN_HZ = 50

# (side, joint, quantity): values and unit.
_Signals = Dict[Tuple[str, str, str], Tuple[Any, str]]


def _table_of(file: Path) -> Dict[str, List[float]]:
    """The columns of numbers of a table of an episode."""
    with open(file, encoding="utf-8", newline="") as lines:
        rows = list(csv.reader(lines))
    words = ("state", "cause")
    return {
        head: [float(row[place]) for row in rows[1:]]
        for place, head in enumerate(rows[0] if rows else [])
        if head.rpartition(".")[2] not in words
    }


def _episode_of(log: Path, number: int | None) -> Columns:
    """The table that `tactus export --wide` writes of one episode of a log."""
    with tempfile.TemporaryDirectory(prefix="tactus-") as folder:
        out = os.path.join(folder, "episodes")
        words = ["export", os.fspath(log), "--wide", "--rate", str(_SHOWN_HZ), "--out", out, "--json"]
        episodes = json.loads(command(*words).results)["episodes"]
        tables = {one["number"]: one["file"] for one in episodes if one["file"]}
        if not tables or (number is not None and number not in tables):
            numbers = ", ".join(str(one) for one in tables) or "none"
            raise ValueError(f"{os.fspath(log)} has no table of episode {number or 1}; episodes with a table: {numbers}")
        return _table_of(tables[number if number is not None else min(tables)])


def _signals_of(columns: Columns) -> _Signals:
    import numpy

    signals: _Signals = {}
    for head in columns.keys():
        side, _, rest = str(head).partition(".")
        joint, _, name = rest.rpartition(".")
        if side in ("leader", "follower") and name not in ("state", "cause"):
            quantity, unit = in_words(name)
            signals[side, joint, quantity] = (numpy.asarray(columns[head], dtype=numpy.float64), unit)
    return signals


def episode(
    source: Path | Columns, *, number: int | None = None, joints: Sequence[str] | None = None, axes: Any = None
) -> Figure:
    """An episode of a rig: a row for each joint, with its positions, its tracking error and its external torque.

    The tracking error is what the follower was commanded less what it reached. The external torque is that of the
    environment on the follower, in the joint's positive sense, as its controller estimates or measures it; without it there
    are two columns. rad and N m for a joint that turns, m and N for one that slides; times in s since the start of the
    episode.

    Args:
        source: the folder of a rig's log, of which 50 rows a second are drawn; or a table that
            `tactus export RUN/log --wide` wrote, as a file, as a data frame of pandas or as columns by name, each of shape
            (rows,).
        number: of the episode in a log; by default the first one that was not discarded.
        joints: names of those to draw, by default all, at most twelve.
        axes: to draw into, three (or two) for each joint, row by row.

    Raises:
        RequestError: the log cannot be read, or is not one of a rig.
        ValueError: there is no such episode or joint, or the table is not one of an episode.
    """
    if isinstance(source, (str, os.PathLike)):
        columns = _table_of(source) if os.fspath(source).endswith(".csv") else _episode_of(source, number)
    else:
        columns = source
    signals = _signals_of(columns)
    there = list(dict.fromkeys(joint for _, joint, quantity in signals if quantity == "position"))
    if not there or "time_s" not in columns:
        raise ValueError(
            "this table has no columns `time_s`, `leader.JOINT.position_rad` and `follower.JOINT.position_rad`: write it "
            "with `tactus export RUN/log --wide --out episodes`"
        )
    drawn = list(joints) if joints is not None else there[:_MOST_JOINTS]
    for joint in drawn:
        if joint not in there:
            raise ValueError(f"this episode has no joint {joint!r}; it has {', '.join(there)}")
    external = ("external torque", "external force")
    pushed = any(signals.get(("follower", joint, kind)) for joint in drawn for kind in external)
    grid = Grid(axes, len(drawn), 3 if pushed else 2, (3.2, 1.3 if len(drawn) > 2 else 1.9))
    grid.share("x", list(grid))
    for row, joint in zip(grid.axes, drawn):
        _draw_joint(row, joint, columns["time_s"], signals)
    for ax in grid.axes[-1]:
        ax.set_xlabel(with_unit("time", "s"), fontsize=9)
    for column, title in zip(grid.axes[0], ("position", "tracking error", "external torque or force")):
        column.set_title(title, fontsize=9)
    grid.legend()
    return grid.figure


def _draw_joint(row: Sequence[Any], joint: str, time_s: Any, signals: _Signals) -> None:
    look = {"linewidth": 1.2}
    for side, colour in (("leader", BLUE), ("follower", ORANGE)):
        position = signals.get((side, joint, "position"))
        if position is not None:
            row[0].plot(time_s, position[0], color=colour, label=side, **look)
            row[0].set_ylabel("\n".join(filter(None, (joint, with_unit("position", position[1])))), fontsize=8)
    command_, reached = (signals.get(("follower", joint, name)) for name in ("commanded position", "position"))
    if command_ is not None and reached is not None:
        row[1].plot(time_s, command_[0] - reached[0], color=GREEN, label="tracking error", **look)
        row[1].set_ylabel(with_unit("error", reached[1]), fontsize=8)
    for kind in ("torque", "force"):
        external = signals.get(("follower", joint, f"external {kind}"))
        if external is not None:
            row[2].plot(time_s, external[0], color=MAGENTA, label=f"external {kind}", **look)
            row[2].set_ylabel(with_unit(kind, external[1]), fontsize=8)
