# SPDX-License-Identifier: Apache-2.0
"""Figures of results and logs, with Matplotlib 3.6 or newer (Debian: `python3-matplotlib`).

Matplotlib is imported when a figure is drawn. Every function returns the Matplotlib `Figure`. It makes the figure with `matplotlib.pyplot`, so that a notebook or
`matplotlib.pyplot.show()` shows it; or it draws into the `axes` that you pass, one or several, row by row.

    result = tactus.run("experiments/tapping.toml", vary={"control.cancellation": ["off", "on"]}, out="out/taps")
    figure = tactus.plot.taps(tactus.read_log("out/taps/log"), result)
    figure.savefig("taps.png")
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Dict, List, Sequence, Tuple

from ._episodes import episode
from ._figures import (
    BLACK, BLUE, BROWN, COLOURS, GREEN, GREY, MAGENTA, ORANGE, Grid, in_words, is_even_in_logarithm, label_of, setting_of,
    settings_of, with_unit,
)
from ._maps import stability_map
from .logs import Log, Table

if TYPE_CHECKING:
    import numpy
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from .commands import Result
    from .results import Record

    Array = NDArray[numpy.float64]

__all__ = ["episode", "recording", "settling", "stability_map", "taps"]

_CANCELLATION = "control.cancellation"
_MOST_COLUMNS = 6


def _only_table(log: Log | Table) -> Table:
    if isinstance(log, Table):
        return log
    if len(log) != 1:
        raise ValueError(f"this log has {len(log)} tables ({', '.join(log)}): pass one of them, as log[\"NAME\"]")
    return next(iter(log.values()))


def _since_touch(table: Table) -> Tuple[Array, str]:
    """Times in ms since the first contact, or since the start of a tap without one; and the label of their axis."""
    import numpy

    time_s = table["time_s"]
    touches = numpy.flatnonzero(table["touched"] > 0.5)
    if touches.size == 0:
        return 1e3 * (time_s - time_s[0]), "time (ms)"
    return 1e3 * (time_s - table["touched_at_s"][touches[0]]), "time since touch (ms)"


def _runs_of(log: Log | Table, result: Result | None) -> List[Tuple[Table, Dict[str, Any]]]:
    """The tables of taps in a log, each with the keys by which its run differs."""
    if isinstance(log, Table):
        return [(log, {})]
    found = []
    for topic, table in log.items():
        run = re.fullmatch(r"/(?:run_(\d+)/)?teleoperator", topic)
        if run is None:
            continue
        row = int(run[1]) - 1 if run[1] else 0
        if result is not None and row >= len(result.runs):
            raise ValueError(f"{topic} has no run in this result, which has {len(result.runs)}: pass the result of the same call")
        settings = {} if result is None else dict(result.runs[row].set.to_dict())
        if result is None and run[1]:
            settings = {"run": int(run[1])}
        found.append((table, settings))
    if not found:
        raise ValueError(
            f"this log has no taps of one axis (it has {', '.join(log) or 'no table'}): pass the log of an experiment of "
            'the kind "tapping"'
        )
    return found


def _evenly(runs: List[Any], most: int) -> List[Any]:
    if len(runs) <= most:
        return runs
    return [runs[round(place * (len(runs) - 1) / (most - 1))] for place in range(most)]


def taps(
    log: Log | Table, result: Result | None = None, *, before_s: float = 0.01, after_s: float = 0.15, axes: Any = None
) -> Figure:
    """Taps on a wall, aligned at their first contact: forces above, positions below.

    Forces in N, positive when they push the hand or the follower back: the one displayed to the hand, and the one that the
    follower sent. Positions in mm, positive toward the wall: the leader as measured, the motion that the force induced as
    the model estimates it, the tip of the follower, and the follower's command, dashed.

    Args:
        log: of `tactus.run(..., out=FOLDER)`, an experiment of the kind `tapping`: `read_log("FOLDER/log")`, or one of its
            tables. It has one tap of each run, the one with the median settling time.
        result: of the same run; its varied keys are the titles. Runs with and without cancellation are in rows of their
            own, the others in columns, at most six of them, evenly chosen.
        before_s, after_s: what is shown around the first contact, in s.
        axes: to draw into, two for each group of runs and column, row by row.

    Returns:
        Figure of the shape (2 groups, columns).
    """
    groups: Dict[str, List[Tuple[Table, Dict[str, Any]]]] = {}
    for table, settings in _runs_of(log, result):
        group = setting_of(_CANCELLATION, settings[_CANCELLATION]) if _CANCELLATION in settings else ""
        groups.setdefault(group, []).append((table, settings))
    fewest = min(len(runs) for runs in groups.values())
    chosen = {group: _evenly(runs[:fewest], _MOST_COLUMNS) for group, runs in groups.items()}
    columns = min(fewest, _MOST_COLUMNS)
    grid = Grid(axes, 2 * len(chosen), columns, (2.0 if columns > 1 else 5.0, 1.75))
    grid.share("x", list(grid))
    for quantity in (0, 1):
        grid.share("y", [ax for row in grid.axes[quantity::2] for ax in row])
    for place, (group, runs) in enumerate(chosen.items()):
        for column, (table, settings) in enumerate(runs):
            above, below = grid.axes[2 * place][column], grid.axes[2 * place + 1][column]
            time_ms, time_label = _since_touch(table)
            shown = slice(None)
            if time_label != "time (ms)":
                first, last = time_ms.searchsorted((-1e3 * before_s, 1e3 * after_s))
                shown = slice(int(first), int(last))
            for name, label, colour, width in (
                ("sent_force_N", "force sent by the follower", GREY, 1.0),
                ("displayed_force_N", "force on the hand", BLUE, 1.4),
            ):
                above.plot(time_ms[shown], table[name][shown], color=colour, linewidth=width, label=label)
            for name, label, colour, style in (
                ("master_position_m", "leader, measured", GREEN, "-"),
                ("induced_position_m", "induced motion, estimated", MAGENTA, "-"),
                ("tip_position_m", "follower's tip", BROWN, "-"),
                ("command_m", "follower's command", ORANGE, "--"),
            ):
                below.plot(
                    time_ms[shown], 1e3 * table[name][shown], color=colour, linestyle=style, linewidth=1.4, label=label
                )
            if place == 0:
                above.set_title(settings_of(settings, without=[_CANCELLATION]), fontsize=9)
            if column == 0:
                above.set_ylabel("\n".join(filter(None, (group, with_unit("force", "N")))), fontsize=9)
                below.set_ylabel(with_unit("position", "mm"), fontsize=9)
            if place == len(chosen) - 1:
                below.set_xlabel(time_label, fontsize=9)
    grid.legend()
    return grid.figure


def _number_key(runs: Sequence[Record]) -> str:
    """The varied key with most numbers."""
    numbers: Dict[str, set[float]] = {}
    for run in runs:
        for key, value in run.set.items():
            if isinstance(value, (int, float)) and not isinstance(value, bool):
                numbers.setdefault(key, set()).add(value)
    if not numbers or max(len(values) for values in numbers.values()) < 2:
        raise ValueError(
            "no key of this result has two numbers or more: run it with vary={KEY: [NUMBER, NUMBER]}, for instance "
            'vary={"control.force_gain": [1, 3, 10]}'
        )
    return max(numbers, key=lambda key: len(numbers[key]))


def settling(result: Result, *, over: str | None = None, axes: Any = None) -> Figure:
    """How long a contact rings over a varied key, and the share of the taps that settle.

    Left the settling time in ms: median (solid) and 90th percentile (dashed) over the taps; a tap that does not settle
    counts with the whole observation, which the dotted line marks. Right the share that settles, in %. Two arms have no
    settling time, so only the share is drawn.

    Args:
        result: of `tactus.run` with `vary`, an experiment of the kind `tapping` or `arm-tapping`.
        over: the varied key along the horizontal axis; by default the one with most numbers. A line is drawn for each
            combination of the others.
        axes: to draw into, two; of two arms one.

    Raises:
        ValueError: no key has two numbers.
    """
    import numpy

    key = over if over is not None else _number_key(result.runs)
    groups: Dict[str, List[Record]] = {}
    for run in result.runs:
        if key not in run.set:
            raise ValueError(f"{key} is not varied in this result; varied are {', '.join(run.set) or 'no keys'}")
        groups.setdefault(settings_of(run.set, without=[key]), []).append(run)
    timed = all("settling_time_median_s" in run.metrics for run in result.runs)
    grid = Grid(axes, 1, 2 if timed else 1, (3.7, 2.6))
    share = grid.axes[0][-1]
    for place, (group, runs) in enumerate(groups.items()):
        colour = COLOURS[place % len(COLOURS)]
        runs = sorted(runs, key=lambda run: float(run.set[key]))
        at = [run.set[key] for run in runs]
        look = {"color": colour, "marker": "o", "markersize": 3.5}
        settled = group or ("median" if timed else "taps that settle")
        share.plot(at, [100.0 * run.metrics.settled_fraction for run in runs], label=settled, **look)
        if timed:
            time = grid.axes[0][0]
            time.plot(at, [1e3 * run.metrics.settling_time_median_s for run in runs], label=settled, **look)
            time.plot(
                at, [1e3 * run.metrics.settling_time_p90_s for run in runs], linestyle="--",
                label=", ".join(filter(None, (group, "90th percentile"))), **look,
            )
    if timed:
        time = grid.axes[0][0]
        time.axhline(
            1e3 * result.configuration.task.observation_s, color=BLACK, linestyle=":", linewidth=1.0, label="observation"
        )
        time.set_ylabel(with_unit("settling time", "ms"), fontsize=9)
        time.set_ylim(bottom=0.0)
    share.set_ylabel(with_unit("taps that settle", "%"), fontsize=9)
    share.set_ylim(0.0, 105.0)
    values = numpy.unique([float(run.set[key]) for run in result.runs])
    for ax in grid:
        ax.set_xlabel(label_of(key), fontsize=9)
        if is_even_in_logarithm(values):
            ax.set_xscale("log")
            ax.set_xticks(values, [f"{value:g}" for value in values])
            ax.set_xticks([], minor=True)
    grid.legend()
    return grid.figure


def _time_s(table: Table) -> Array:
    """Times of the rows in s: of a log since its first row, of a recording its column."""
    if table.times_ns.size:
        since_first: Array = 1e-9 * (table.times_ns - table.times_ns[0]).astype(float)
        return since_first
    scales = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
    for name in ("time", "time_s"):
        if name in table:
            return scales.get(table.units[name], 1.0) * table[name]
    raise ValueError(f"{table.name} has no column `time` (it has {', '.join(table)}): name the column of times so")


def recording(
    table: Log | Table, found: Result | None = None, *, columns: Sequence[str] | None = None, from_s: float | None = None,
    to_s: float | None = None, axes: Any = None,
) -> Figure:
    """Signals of a recording over time: one panel for each unit, and a band where `diagnose` found an oscillation.

    Args:
        table: of `read_log`: columns of shape (rows,) in the units that the file states. Time in s.
        found: result of `diagnose` of the same recording; a band is labelled with frequency and mechanism.
        columns: names of those to draw, by default all but the times.
        from_s, to_s: the times between which it is drawn, in s; by default all.
        axes: to draw into, one for each unit.

    Raises:
        ValueError: there is no column of times, no such column, or no row between these times.
    """
    one = _only_table(table)
    time_s = _time_s(one)
    first_s, last_s = (time_s[0] if from_s is None else from_s), (time_s[-1] if to_s is None else to_s)
    shown = (time_s >= first_s) & (time_s <= last_s)
    if not shown.any():
        raise ValueError(f"{one.name} has no row from {first_s:g} s to {last_s:g} s; it ends at {time_s[-1]:g} s")
    names = list(columns) if columns is not None else [name for name in one if name not in ("time", "time_s")]
    panels: Dict[str, List[str]] = {}
    for name in names:
        if name not in one:
            raise ValueError(f"{one.name} has no column {name!r}; it has {', '.join(one)}")
        panels.setdefault(one.units[name], []).append(name)
    grid = Grid(axes, len(panels), 1, (7.0, 1.9))
    grid.share("x", list(grid))
    place = 0
    for (unit, group), ax in zip(panels.items(), grid):
        for name in group:
            words = in_words(name)[0].replace("master", "leader").replace("slave", "follower")
            ax.plot(time_s[shown], one[name][shown], color=COLOURS[place % len(COLOURS)], linewidth=1.0, label=words)
            place += 1
        quantity = {"m": "position", "rad": "position", "N": "force", "N m": "torque"}.get(unit)
        ax.set_ylabel(with_unit(quantity or "value", unit or "no unit"), fontsize=9)
        for oscillation in found.oscillations if found is not None else ():
            label = f"{oscillation.frequency_Hz:.3g} Hz, {oscillation.mechanism}" if ax is grid.axes[-1][0] else None
            band = (max(oscillation.from_s, first_s), min(oscillation.to_s, last_s))
            if band[0] < band[1]:
                ax.axvspan(*band, color=GREY, alpha=0.2, linewidth=0, label=label)
    grid.axes[-1][0].set_xlabel(with_unit("time", "s"), fontsize=9)
    grid.legend()
    return grid.figure
