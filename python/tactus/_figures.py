# SPDX-License-Identifier: Apache-2.0
"""What the functions of `plot` share: Matplotlib, colours, axes, and keys in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Sequence, Tuple

if TYPE_CHECKING:
    import numpy
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    Array = NDArray[numpy.float64]

# The colours of the reports (tactus/data/report/palette.hpp): well apart for every kind of colour vision.
BLUE, ORANGE, GREEN, MAGENTA, BROWN, LIGHT_BLUE, GREY, BLACK = COLOURS = (
    "#162fbe", "#ef6812", "#28864d", "#b8359c", "#7a4202", "#5575ff", "#919191", "#111111",
)
MUTED, FRAME, GRID = "#565e68", "#8a929b", "#e4e7ea"

_UNIT_PARTS = frozenset(
    "s Hz cycles kg m N J W mA Pa m2 m3 m5 s2 ms us ns mm rad deg mN kN A V bar Nm Nms C".split()
)
_POWERS = {"m2": "m²", "m3": "m³", "m5": "m⁵", "s2": "s²", "Nm": "N m", "Nms": "N m s", "C": "°C"}


def pyplot() -> Any:
    """`matplotlib.pyplot`, imported when a figure is drawn.

    Raises:
        ImportError: Matplotlib is missing; the message names its package.
    """
    try:
        import matplotlib.pyplot
    except ImportError as error:
        raise ImportError(
            "tactus.plot needs Matplotlib, which is not installed: install the package python3-matplotlib of Debian or "
            "Ubuntu, or matplotlib with the package manager of your environment"
        ) from error
    return matplotlib.pyplot


def in_words(key: str) -> Tuple[str, str]:
    """A key and its unit in words: environment.stiffness_N_per_m is ("environment stiffness", "N/m").

    Of the sections only the last is named, and neither `control` nor `task`.
    """
    *sections, name = key.split(".")
    parts = name.split("_")
    start = len(parts)
    while start > 1 and (parts[start - 1] in _UNIT_PARTS or parts[start - 1] == "per"):
        start -= 1
    unit = " ".join(_POWERS.get(part, part) for part in parts[start:]).replace(" per ", "/")
    unit = "1/" + unit[len("per "):] if unit.startswith("per ") else unit
    group = sections[-1] if sections and sections[-1] not in ("control", "task") else ""
    return " ".join(filter(None, (group.replace("_", " "), " ".join(parts[:start])))), unit


def with_unit(quantity: str, unit: str) -> str:
    """The label of an axis: "position (mm)"."""
    return f"{quantity} ({unit})" if unit else quantity


def label_of(key: str) -> str:
    """The label of an axis along which a key varies."""
    return with_unit(*in_words(key))


def setting_of(key: str, value: Any) -> str:
    """A key with a value: "force gain 3", "cancellation off", "force limit 2.5 N"."""
    words, unit = in_words(key)
    number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return f"{words} {value:.4g}{' ' + unit if unit else ''}" if number else f"{words} {value}"


def settings_of(settings: Mapping[str, Any], without: Sequence[str] = ()) -> str:
    return ", ".join(setting_of(key, value) for key, value in settings.items() if key not in without)


def is_even_in_logarithm(values: Array) -> bool:
    """Whether an axis looks better in decades: the steps of its logarithms are more equal than its own."""
    import numpy

    if values.size < 3 or (values <= 0).any():
        return False
    steps, ratios = numpy.diff(values), numpy.diff(numpy.log(values))
    return bool(numpy.ptp(ratios) / abs(ratios).mean() < numpy.ptp(steps) / abs(steps).mean())


class Grid:
    """Axes row by row: those of the caller, or new ones in a figure of their own.

    Args:
        axes: of the caller: one, or a sequence or array of as many as are drawn, row by row. None makes new ones.
        rows, columns: how many are drawn.
        size_in: width and height of new axes, in inches.

    Raises:
        ValueError: the caller's axes are too many or too few.
    """

    def __init__(self, axes: Any, rows: int, columns: int, size_in: Tuple[float, float]) -> None:
        self.own = axes is None
        if self.own:
            size = (columns * size_in[0] + 0.6, rows * size_in[1] + 0.4)
            self.figure = pyplot().figure(figsize=size, layout="constrained")
            self.axes: List[List[Axes]] = [
                list(row) for row in self.figure.subplots(rows, columns, squeeze=False)
            ]
            for ax in self:
                self._dress(ax)
        else:
            import numpy

            given: List[Axes] = list(numpy.atleast_1d(numpy.asarray(axes, dtype=object)).ravel())
            if len(given) != rows * columns:
                raise ValueError(
                    f"{len(given)} axes were given, and the figure has {rows} x {columns}: pass "
                    f"{rows * columns}, row by row, or none"
                )
            self.axes = [given[row * columns:(row + 1) * columns] for row in range(rows)]
            self.figure = given[0].figure

    @staticmethod
    def _dress(ax: Axes) -> None:
        """The look of new axes; the caller's own keep theirs."""
        ax.grid(True, color=GRID, linewidth=0.8)
        ax.set_axisbelow(True)
        ax.ticklabel_format(useOffset=False)
        ax.tick_params(colors=MUTED, labelsize=8)
        for side, spine in ax.spines.items():
            spine.set_visible(side in ("left", "bottom"))
            spine.set_color(FRAME)

    def __iter__(self) -> Any:
        return (ax for row in self.axes for ax in row)

    def share(self, direction: str, axes: Sequence[Axes]) -> None:
        """New axes with equal limits along "x" or "y". The caller's own axes keep the limits that they have."""
        if not self.own:
            return
        for ax in axes[1:]:
            (ax.sharex if direction == "x" else ax.sharey)(axes[0])
        outside = self.axes[-1] if direction == "x" else [row[0] for row in self.axes]
        for ax in axes:
            if ax not in outside:
                ax.tick_params(**{"labelbottom" if direction == "x" else "labelleft": False})

    def legend(self) -> None:
        """One entry for each label: above the axes of a new figure, in the first axes of the caller's."""
        entries: Dict[str, Any] = {}
        for ax in self:
            for handle, label in zip(*ax.get_legend_handles_labels()):
                entries.setdefault(label, handle)
        if not entries:
            return
        look = {"fontsize": 8, "frameon": False}
        if not self.own:
            self.axes[0][0].legend(list(entries.values()), list(entries), **look)
            return
        self.figure.align_ylabels()
        # The figure grows by the legend's lines: the layout leaves no space for it.
        width_in, height_in = self.figure.get_size_inches()
        columns = max(1, min(len(entries), int(width_in / (0.6 + 0.056 * max(len(label) for label in entries)))))
        strip_in = 0.15 + 0.18 * math.ceil(len(entries) / columns)
        self.figure.set_size_inches(width_in, height_in + strip_in)
        self.figure.get_layout_engine().set(rect=(0.0, 0.0, 1.0, height_in / (height_in + strip_in)))
        self.figure.legend(list(entries.values()), list(entries), loc="upper center", ncol=columns, **look)
