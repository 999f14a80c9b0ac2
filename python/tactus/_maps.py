# SPDX-License-Identifier: Apache-2.0
"""Figures of stability maps; users find `stability_map` in `plot`."""

from __future__ import annotations

import csv
import pathlib
from typing import TYPE_CHECKING, Any, Dict, List, Tuple

from ._figures import (
    BLACK, BLUE, COLOURS, Grid, in_words, is_even_in_logarithm, label_of, pyplot, setting_of, settings_of, with_unit,
)
from ._words import Path

if TYPE_CHECKING:
    import numpy
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from .commands import Result
    from .results import Record

    Array = NDArray[numpy.float64]

# What a run does, and the colour of its cell, as in the report of `tactus stability map`.
_VERDICTS = {"settled": "#cfe8d5", "ringing": "#ffe08a", "limit-cycle": "#f2a07b", "diverged": "#8a4b7d"}
_MOST_PANELS = 4


def _edges(values: Array, logarithmic: bool) -> Array:
    """Borders of the cells around `values`, one more than these."""
    import numpy

    at = numpy.log(values) if logarithmic else values
    middles = 0.5 * (at[1:] + at[:-1])
    edges: Array = numpy.concatenate([[2 * at[0] - middles[0]], middles, [2 * at[-1] - middles[-1]]])
    return numpy.exp(edges) if logarithmic else edges


def _panels_of(axes: List[Record]) -> List[str]:
    """Titles of the planes, over every axis but the last two, the last of these the fastest."""
    titles = [""]
    for axis in axes[:-2]:
        titles = [
            ", ".join(filter(None, (title, setting_of(axis.key, value)))) for title in titles for value in axis["values"]
        ]
    return titles


def _cells_of(folder: Path, shape: Tuple[int, int, int]) -> Array:
    """The verdict of every run as its place in `_VERDICTS`, of the shape (planes, y, x)."""
    import numpy

    file = pathlib.Path(folder) / "map.csv"
    order = list(_VERDICTS)
    with open(file, encoding="utf-8", newline="") as lines:
        rows = [order.index(row["verdict"]) for row in csv.DictReader(lines)]
    if len(rows) != shape[0] * shape[1] * shape[2]:
        raise ValueError(f"{file} has {len(rows)} runs and the result {shape[0] * shape[1] * shape[2]}: pass its own folder")
    return numpy.asarray(rows, dtype=numpy.float64).reshape(shape)


def stability_map(result: Result, folder: Path | None = None, *, axes: Any = None) -> Figure:
    """For which values of two keys taps settle: the limit, and with `folder` the verdict of every run.

    The line is the largest value of the vertical key below which every run settled or rang. A line along the upper edge
    means that the limit is beyond the map. Of two arms, the gain limit of the linear loop with drawn models is shown over
    the varied key with most numbers, a line for each hand and combination of the other keys.

    Args:
        result: of `tactus.stability("map", ...)`. Of one axis with two varied keys with several numbers each as the last
            ones; each value of the keys before them, at most four, is a panel.
        folder: `out` of the same call; its `map.csv` has the verdicts. Without it the region below the limit is shaded.
        axes: to draw into, one for each panel.

    Raises:
        ValueError: the keys that vary do not span a plane, or more than four of them.
    """
    if "points" in result.values and not isinstance(result.points, (int, float)):
        return _gain_limits(result, axes)
    return _verdicts(result, folder, axes)


def _verdicts(result: Result, folder: Path | None, axes: Any) -> Figure:
    import numpy

    keys: List[Record] = list(result.values["axes"])
    if len(keys) < 2 or any(isinstance(axis["values"], list) or len(axis["values"]) < 2 for axis in keys[-2:]):
        raise ValueError(
            "this map has no plane: the last two keys of `vary` must have several numbers each, for instance "
            'vary={"control.force_gain": "0.5:30:40[log]", "environment.stiffness_N_per_m": "1e3:1e5:25[log]"}'
        )
    titles = _panels_of(keys)
    if len(titles) > _MOST_PANELS:
        raise ValueError(
            f"this map has {len(titles)} planes, more than the {_MOST_PANELS} of a figure: vary fewer values of "
            f"{', '.join(axis.key for axis in keys[:-2])}"
        )
    y, x = (numpy.asarray(axis["values"], dtype=numpy.float64) for axis in keys[-2:])
    limits = numpy.array(
        [numpy.nan if limit is None else limit for limit in result.settled_limit], dtype=numpy.float64
    ).reshape(len(titles), x.size)
    cells = None if folder is None else _cells_of(folder, (len(titles), y.size, x.size))
    columns = len(titles)
    grid = Grid(axes, 1, columns, (4.6 if columns == 1 else 3.4, 3.2))
    log_x, log_y = is_even_in_logarithm(x), is_even_in_logarithm(y)
    edges_x, edges_y = _edges(x, log_x), _edges(y, log_y)
    name = in_words(keys[-2].key)[0]
    for place, (ax, title) in enumerate(zip(grid, titles)):
        ax.set_xscale("log" if log_x else "linear")
        ax.set_yscale("log" if log_y else "linear")
        if cells is not None:
            _draw_cells(ax, edges_x, edges_y, cells[place])
        else:
            top = numpy.nan_to_num(limits[place], nan=edges_y[0])
            ax.fill_between(x, edges_y[0], top, color=_VERDICTS["settled"], label="every run settled or rang")
        ax.plot(x, limits[place], color=BLUE, linewidth=1.8, label=f"limit of the {name}")
        ax.set_xlim(edges_x[0], edges_x[-1])
        ax.set_ylim(edges_y[0], edges_y[-1])
        ax.set_title(title, fontsize=9)
        ax.set_xlabel(label_of(keys[-1].key), fontsize=9)
        if place == 0:
            ax.set_ylabel(label_of(keys[-2].key), fontsize=9)
    grid.legend()
    return grid.figure


def _draw_cells(ax: Any, edges_x: Array, edges_y: Array, verdicts: Array) -> None:
    from matplotlib.colors import ListedColormap

    colours = list(_VERDICTS.values())
    ax.grid(False)
    ax.pcolormesh(
        edges_x, edges_y, verdicts, cmap=ListedColormap(colours), vmin=-0.5, vmax=len(colours) - 0.5, rasterized=True
    )
    for place, (verdict, colour) in enumerate(_VERDICTS.items()):
        if (verdicts == place).any():
            ax.add_patch(pyplot().Rectangle((0, 0), 0, 0, facecolor=colour, label=verdict.replace("-", " ")))


def _gain_limits(result: Result, axes: Any) -> Figure:
    points: List[Record] = list(result.points)
    numbers: Dict[str, set[float]] = {}
    for point in points:
        for key, value in point.set.items():
            if isinstance(value, (int, float)) and not isinstance(value, bool):
                numbers.setdefault(key, set()).add(value)
    if not numbers or max(len(values) for values in numbers.values()) < 2:
        raise ValueError("no key of this map has two numbers: vary one, for instance task.pose")
    along = max(numbers, key=lambda key: len(numbers[key]))
    lines: Dict[str, List[Record]] = {}
    several_hands = len({point.hand for point in points}) > 1
    for point in points:
        hand = f"hand {point.hand}" if several_hands else ""
        lines.setdefault(", ".join(filter(None, (hand, settings_of(point.set, without=[along])))), []).append(point)
    grid = Grid(axes, 1, 1, (5.5, 3.2))
    ax = grid.axes[0][0]
    for place, (label, line) in enumerate(lines.items()):
        line = sorted(line, key=lambda point: float(point.set[along]))
        ax.plot(
            [point.set[along] for point in line], [point.drawn_limit for point in line],
            color=COLOURS[place % len(COLOURS)], marker="o", markersize=3.5, label=label or "gain limit",
        )
        beyond = [point for point in line if point.drawn_limit_censored]
        if beyond:
            ax.plot(
                [point.set[along] for point in beyond], [point.drawn_limit for point in beyond], linestyle="",
                marker="^", markersize=6, color=BLACK, label="beyond the search",
            )
    ax.set_xlabel(label_of(along), fontsize=9)
    ax.set_ylabel(with_unit("limit of the force gain", ""), fontsize=9)
    ax.set_ylim(bottom=0.0)
    grid.legend()
    return grid.figure
