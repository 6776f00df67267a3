"""The figure of a map: a heat map for each law and metric, or lines over one key; failures are crossed."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.ticker import LogLocator, MaxNLocator

from brunovsky.comparison import drawing
from brunovsky.comparison.facts import number
from brunovsky.comparison.protocols.evaluation import phrase, with_unit
from brunovsky.comparison.protocols.mapped import Axis, Map
from brunovsky.comparison.symbols import with_key_unit

_DECADES = 10.0  # ratio of the ends from which colours are logarithmic
_COLOURS = "cividis"  # lightness rises evenly, so that it reads in grey
_LEVELS = 32  # of the colours
_WIDTH = 9.4
_LINES = 5  # contour lines
_ROUND = MaxNLocator(_LINES, steps=[1.0, 2.0, 5.0, 10.0])
_ROOM = 0.2  # share of a panel that a contour's number keeps from others, if it can
_SHORT = 0.3  # lines shorter than this share of a panel have none
Titles = Mapping[str, str]
Values = np.ndarray[Any, np.dtype[np.float64]]


def map_figure(result: Map, titles: Titles | None = None) -> Figure:
    """Each metric over the keys: rows of heat maps with one scale for all laws, or lines where one key is swept."""
    return _lines(result, titles or {}) if result.up is None else _heat_maps(result, titles or {})


def _heat_maps(result: Map, titles: Titles) -> Figure:
    assert result.up is not None
    laws = result.laws
    figure = drawing.new_figure(_WIDTH, 0.4 + 2.5 * len(result.metrics))
    grid = np.atleast_2d(figure.subplots(len(result.metrics), len(laws), sharex=True, sharey=True, squeeze=False))
    for row, metric in enumerate(result.metrics):
        values = [result.grid(law, metric) for law in laws]
        sure = [result.sure(law, metric) for law in laws]
        norm = _norm(np.concatenate([one.ravel() for one in sure]))  # chance values of the step stretch no scale
        levels = _levels(np.concatenate([one.ravel() for one in sure]), norm)
        mesh = None
        for axes, law, one, known in zip(grid[row], laws, values, sure, strict=True):
            axes.grid(False)
            if norm is not None:
                mesh = ScalarMappable(norm, matplotlib.colormaps[_COLOURS].resampled(_LEVELS))
                _cells(axes, _edges(result.across), _edges(result.up), one, mesh)
                _contours(axes, result.across, result.up, known, levels)
            _crosses(axes, result, law, one)
            axes.set_title(f"{phrase(metric)}\n{titles.get(law) or law}", loc="left", fontsize=8.0)
        if mesh is not None:
            bar = figure.colorbar(mesh, ax=list(grid[row]), pad=0.01, fraction=0.03, label=with_unit(metric))
            bar.ax.grid(False)
            bar.ax.hlines(levels, 0.0, 1.0, colors="#000000", linewidths=0.7, transform=bar.ax.get_yaxis_transform())
    for axes in grid[-1]:
        axes.set_xlabel(with_key_unit(result.across.key))
    for axes in grid[:, 0]:
        axes.set_ylabel(with_key_unit(result.up.key))
    drawing.plain_decades(figure)
    return figure


def _lines(result: Map, titles: Titles) -> Figure:
    columns = min(len(result.metrics), 2)
    rows = -(-len(result.metrics) // columns)
    figure = drawing.new_figure(_WIDTH, 0.5 + 2.3 * rows)
    panels = np.atleast_1d(figure.subplots(rows, columns, sharex=True)).ravel()
    for axes, metric in zip(panels, result.metrics, strict=False):
        found = [result.grid(law, metric)[0] for law in result.laws]
        for index, (law, values) in enumerate(zip(result.laws, found, strict=True)):
            label = titles.get(law) or law
            axes.plot(result.across.values, values, label=label, marker=".", markersize=3.0, **drawing.style(index))
        if isinstance(_norm(np.concatenate(found)), LogNorm):
            axes.set_yscale("log")
        for index, law in enumerate(result.laws):
            failed = np.flatnonzero(result.failed(law)[0])
            if not failed.size:
                continue
            where: dict[str, Any] = {"transform": axes.get_xaxis_transform(), "linestyle": "none", "clip_on": False}
            color = drawing.STYLES[index % len(drawing.STYLES)].color
            spots = [result.across.values[k] for k in failed]
            axes.plot(spots, [0.02 + 0.05 * index] * len(spots), marker="x", color=color, markersize=5.0, **where)
        axes.set_title(f"{with_unit(metric)};  ×: failed", loc="left")
        axes.set_xlabel(with_key_unit(result.across.key))
    for axes in panels[len(result.metrics) :]:
        axes.set_visible(False)
    handles, labels = panels[0].get_legend_handles_labels()
    columns = drawing.legend_columns(labels, float(figure.get_figwidth()), 4)
    figure.legend(handles, labels, loc="outside upper center", ncols=columns, frameon=False)
    drawing.plain_decades(figure)
    return figure


def _norm(values: np.ndarray[Any, np.dtype[np.float64]]) -> Normalize | None:
    """Scale of the colours of a metric, one for all laws; None where it is defined nowhere."""
    known = values[np.isfinite(values)]
    if not known.size:
        return None
    low, high = float(known.min()), float(known.max())
    if low > 0.0 and high > _DECADES * low:
        return LogNorm(low, high)
    return Normalize(low, high if high > low else low + max(abs(low), 1e-9))


def _cells(axes: Axes, x: Values, y: Values, values: Values, colours: ScalarMappable) -> None:
    """Cells of a map: one path for each colour, neighbours in a row joined, which keeps the picture small."""
    rectangles: dict[tuple[float, ...], list[Path]] = {}
    for row, below, above in zip(colours.to_rgba(np.ma.masked_invalid(values)), y[:-1], y[1:], strict=True):
        column = 0
        for colour, cells in itertools.groupby(map(tuple, row)):
            first, column = column, column + len(list(cells))
            corners = [(x[first], below), (x[column], below), (x[column], above), (x[first], above), (0.0, 0.0)]
            rectangles.setdefault(colour, []).append(Path(corners, closed=True))
    for colour, paths in rectangles.items():
        if colour[3]:  # what is undefined is clear
            joined = Path.make_compound_path(*paths)
            axes.add_patch(PathPatch(joined, facecolor=colour, edgecolor=colour, linewidth=0.5))
    axes.set(xlim=x[[0, -1]], ylim=y[[0, -1]])


def _levels(values: Values, norm: Normalize | None) -> list[float]:
    """Levels of the contour lines of all laws, strictly within what is known."""
    known = values[np.isfinite(values)]
    if norm is None or not known.size:
        return []
    low, high = float(known.min()), float(known.max())
    locator = LogLocator(subs=(1.0, 3.0), numticks=_LINES) if isinstance(norm, LogNorm) else _ROUND
    return [float(one) for one in locator.tick_values(low, high) if low < one < high]


def _label(level: float, levels: Sequence[float]) -> str:
    """A level to the precision of the spacing of all, so that no two read alike."""
    for decimals in range(5):
        if max(map(abs, levels)) < 1e4 and all(abs(round(one, decimals) - one) <= 1e-9 for one in levels):
            return f"{level:.{decimals}f}".replace("-", "−")
    return next(
        (
            number(level, digits)
            for digits in range(1, 6)
            if len({number(one, digits) for one in levels}) == len(levels)
        ),
        number(level),
    )


def _contours(axes: Axes, across: Axis, up: Axis, values: Values, levels: Sequence[float]) -> None:
    """Lines of equal value, those of the scale; a number on each that has the room, dark on light."""
    if min(values.shape) < 2 or np.isfinite(values).sum() < 4:
        return
    every, levels = levels, [one for one in levels if np.nanmin(values) < one < np.nanmax(values)]
    if not levels:
        return
    masked = np.ma.masked_invalid(values)
    found = axes.contour(across.values, up.values, masked, levels=levels, colors="#000000", linewidths=0.7)
    for level, place in zip(levels, _places(axes, found.allsegs), strict=True):
        if place is not None:
            box = {"boxstyle": "square,pad=0.1", "facecolor": "#ffffff", "alpha": 0.8, "linewidth": 0.0}
            axes.text(
                place[0],
                place[1],
                _label(level, every),
                fontsize=7.0,
                ha="center",
                va="center",
                bbox=box,
                clip_on=True,
            )


def _places(axes: Axes, lines: Sequence[Sequence[Values]]) -> list[Values | None]:
    """A point of each level for its number: on its longest line, far from other numbers and the ends."""
    (left, right), (below, above) = axes.get_xlim(), axes.get_ylim()
    origin, size = np.array([left, below]), np.array([right - left, above - below])
    taken: list[Values] = []
    found: list[Values | None] = []
    for level in lines:
        scaled = [(np.asarray(one) - origin) / size for one in level if len(one) > 1]
        if not scaled:
            found.append(None)
            continue
        line = max(scaled, key=lambda one: float(np.abs(np.diff(one, axis=0)).sum()))
        long = float(np.abs(np.diff(line, axis=0)).sum())
        room = np.min([line[:, 0], 1.0 - line[:, 0], 2.0 * line[:, 1], 2.0 * (1.0 - line[:, 1])], axis=0)
        for other in taken:
            apart = np.abs(line - other)
            room = np.minimum(room, np.maximum(apart[:, 0], 1.5 * apart[:, 1]))
        best = int(np.argmax(np.round(np.minimum(room, _ROOM), 2)))
        if long < _SHORT or room[best] < 0.5 * _ROOM:
            found.append(None)
            continue
        taken.append(line[best])
        found.append(origin + line[best] * size)
    return found


def _crosses(axes: Axes, result: Map, law: str, values: Any) -> None:
    """A cross where the run failed, a triangle if at this step alone; a ring where undefined, a dot where unsure."""
    assert result.up is not None
    failed, finer = result.failed(law), result.failed_finer(law) if result.finer else result.failed(law)
    x, y = np.meshgrid(result.across.values, result.up.values)
    known = np.isfinite(values)
    unsure = known & ~result.alike(law)
    for marker, where, size in (
        ("x", failed & finer, 3.5),
        ("^", failed & ~finer, 3.5),
        ("o", ~known & ~failed, 3.5),
        (".", unsure, 2.0),
    ):
        spots: dict[str, Any] = {"linestyle": "none", "color": "#000000", "markersize": size}
        spots |= {"fillstyle": "none"} if marker in "o^" else {}
        axes.plot(x[where], y[where], marker=marker, **spots)


def _edges(axis: Axis) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Borders of the cells about the values of an axis."""
    values = np.asarray(axis.values)
    middle = 0.5 * (values[1:] + values[:-1])
    return np.concatenate(([2.0 * values[0] - middle[0]], middle, [2.0 * values[-1] - middle[-1]]))
