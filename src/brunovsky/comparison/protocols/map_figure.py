"""The figure of a map: a heat map for each law and metric, or lines over one key; failures are crossed."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
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
        norm = _norm(np.concatenate([one.ravel() for one in values]))
        mesh = None
        for axes, law, one in zip(grid[row], laws, values, strict=True):
            axes.grid(False)
            if norm is not None:
                mesh = ScalarMappable(norm, matplotlib.colormaps[_COLOURS].resampled(_LEVELS))
                _cells(axes, _edges(result.across), _edges(result.up), one, mesh)
                _contours(axes, result.across, result.up, one, norm)
            _crosses(axes, result, law, metric, one)
            sensitive = " (depends on the step)" if metric in result.step_sensitive else ""
            axes.set_title(f"{phrase(metric)}{sensitive}\n{titles.get(law) or law}", loc="left", fontsize=8.0)
        if mesh is not None:
            bar = figure.colorbar(mesh, ax=list(grid[row]), pad=0.01, fraction=0.03, label=with_unit(metric))
            bar.ax.grid(False)
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


def _contours(axes: Axes, across: Axis, up: Axis, values: Any, norm: Normalize) -> None:
    """Lines of equal value with their numbers, dark on light, so that they read on any colour."""
    if min(values.shape) < 2 or np.isfinite(values).sum() < 4 or np.nanmax(values) <= np.nanmin(values):
        return
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    locator = LogLocator(subs=(1.0, 3.0), numticks=_LINES) if isinstance(norm, LogNorm) else MaxNLocator(_LINES)
    levels = [one for one in locator.tick_values(low, high) if low < one < high]
    if not levels:
        return
    found = axes.contour(
        across.values, up.values, np.ma.masked_invalid(values), levels=levels, colors="#000000", linewidths=0.7
    )
    for text in axes.clabel(found, fmt=lambda one: number(one, 2), fontsize=7.0):
        text.set_bbox({"boxstyle": "square,pad=0.1", "facecolor": "#ffffff", "alpha": 0.8, "linewidth": 0.0})


def _crosses(axes: Axes, result: Map, law: str, metric: str, values: Any) -> None:
    """A cross where the run failed, a ring where the metric is undefined, a dot where the step decides on it."""
    assert result.up is not None
    failed = result.failed(law)
    x, y = np.meshgrid(result.across.values, result.up.values)
    known = np.isfinite(values)
    unsure = known & ~result.converged(law, metric)
    for marker, where, size in (("x", failed, 3.5), ("o", ~known & ~failed, 3.5), (".", unsure, 2.0)):
        spots: dict[str, Any] = {"linestyle": "none", "color": "#000000", "markersize": size}
        spots |= {"fillstyle": "none"} if marker == "o" else {}
        axes.plot(x[where], y[where], marker=marker, **spots)


def _edges(axis: Axis) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Borders of the cells about the values of an axis."""
    values = np.asarray(axis.values)
    middle = 0.5 * (values[1:] + values[:-1])
    return np.concatenate(([2.0 * values[0] - middle[0]], middle, [2.0 * values[-1] - middle[-1]]))
