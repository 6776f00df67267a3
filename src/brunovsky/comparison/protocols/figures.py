"""One figure for each protocol, in styles that survive grey printing."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from brunovsky.comparison import drawing
from brunovsky.comparison.facts import power_of_ten
from brunovsky.comparison.protocols.equal_effort import EqualEffort
from brunovsky.comparison.protocols.evaluation import Trial, phrase, unit, with_unit
from brunovsky.comparison.protocols.monte_carlo import MonteCarlo
from brunovsky.comparison.protocols.paired import Difference
from brunovsky.comparison.protocols.pareto import Pareto
from brunovsky.comparison.protocols.swept import Swept
from brunovsky.comparison.protocols.tuning import Tuning
from brunovsky.comparison.statistics import Estimate
from brunovsky.comparison.symbols import with_key_unit

MARKERS = ("o", "s", "D", "^", "v", "P")
_WIDTH = 9.4
_DRAWN = 1e-9  # share of the largest value, below which a distribution is not told apart
_PANELS = 4  # metrics in a row
_CURVE = 2.9  # inches, of the panel of the tuning
_DECADES = 30.0  # ratio of the ends from which an axis is logarithmic

Titles = Mapping[str, str]
"""Titles of the laws, by name."""


def swept_figure(result: Swept, titles: Titles | None = None) -> Figure:
    """Each metric over the swept parameter, a line for each law."""
    columns = min(len(result.metrics), 2)
    rows = -(-len(result.metrics) // columns)
    figure = drawing.new_figure(_WIDTH, 0.5 + 2.3 * rows)
    grid = np.atleast_1d(figure.subplots(rows, columns, sharex=True)).ravel()
    for axes, metric in zip(grid, result.metrics, strict=False):
        shown = []
        for index, law in enumerate(result.laws):
            x, y = result.curve(law, metric)
            axes.plot(x, y, **_line(index))
            shown += y
        _scale(axes, shown, "y")
        _scale_knob(axes, result.values)
        axes.set_title(_marked(metric, result.step_sensitive), loc="left")
        axes.set_xlabel(with_key_unit(result.knob))
        axes.tick_params(labelbottom=True)  # of the upper panels too, though the axes are shared
    for axes in grid[len(result.metrics) :]:
        axes.set_visible(False)
    _legend(figure, result.laws, titles)
    return figure


def equal_effort_figure(result: EqualEffort, titles: Titles | None = None) -> Figure:
    """Effort of each law over its knob with the target; below, each metric there, with a row for each law."""
    metrics = [metric for metric in result.metrics if metric != result.effort]
    columns = min(len(metrics), _PANELS)
    rows = -(-len(metrics) // _PANELS)
    row = 0.75 + 0.19 * len(result.tunings)
    figure = drawing.new_figure(_WIDTH, 0.6 + _CURVE + rows * row)
    grid = figure.add_gridspec(1 + rows, max(columns, 1), height_ratios=[_CURVE, *[row] * rows])
    _draw_tuning(figure.add_subplot(grid[0, :]), result)
    for index, metric in enumerate(metrics):
        axes = figure.add_subplot(grid[1 + index // _PANELS, index % _PANELS])
        _draw_at_equal_effort(axes, result, metric, named=index % _PANELS == 0)
    drawing.plain_decades(figure)
    _legend(figure, result.laws, titles)
    return figure


def _draw_tuning(curve: Axes, result: EqualEffort) -> None:
    """Effort over the knob: the runs of the search, and the tuned ones as the legend has them."""
    for index, one in enumerate(result.tunings):
        known = sorted((trial.parameters[one.knob.parameter], effort) for trial, effort in _with(one, result))
        small = _line(index) | {"markersize": 2.5, "markeredgewidth": 0.4}
        curve.plot([x for x, _ in known], [y for _, y in known], **small)
        effort = one.trial.value(result.effort) if one.trial is not None else None
        if one.value is not None and effort is not None:
            curve.plot([one.value], [effort], linestyle="none", **_marker(index))
    curve.axhline(result.target, **drawing.REFERENCE)
    if any(_with(one, result) for one in result.tunings):
        curve.set_xscale("log")
        curve.set_yscale("log")
    curve.set_title(f"{_marked(result.effort, result.step_sensitive)};  dotted: target", loc="left")
    curve.set_xlabel(", ".join(dict.fromkeys(with_key_unit(one.knob.parameter) for one in result.tunings)))


def _draw_at_equal_effort(axes: Axes, result: EqualEffort, metric: str, *, named: bool) -> None:
    """One metric of the tuned runs, a row for each law, so that those that coincide are told apart."""
    shown = []
    for index, one in enumerate(result.tunings):
        value = one.trial.value(metric) if one.trial is not None else None
        if value is None:
            continue
        shown.append(value)
        axes.plot([value], [index], linestyle="none", **_marker(index))
        if metric in result.unsure.get(one.law, frozenset()):
            axes.annotate("≈", (value, index), (7, 0), textcoords="offset points", va="center")
    axes.set_yticks(range(len(result.laws)), result.laws if named else [""] * len(result.laws))
    axes.set_ylim(len(result.laws) - 0.5, -0.5)
    _scale(axes, shown, "x")
    if axes.get_xscale() == "linear":
        axes.set_xlim(min(0.0, 1.1 * min(shown, default=0.0)), 1.1 * max([*shown, 0.0]) or 1.0)
        axes.xaxis.set_major_locator(MaxNLocator(4))
    axes.set_title(_marked(metric, result.step_sensitive, units=False).replace(" (", "\n("), loc="left", fontsize=8.5)
    axes.set_xlabel(unit(metric) or "1")


def pareto_figure(result: Pareto, titles: Titles | None = None) -> Figure:
    """All designs in the plane of the two objectives, and the front of each law."""
    figure = drawing.new_figure(_WIDTH, 4.8)
    axes = figure.subplots()
    shown: list[tuple[float, float]] = []
    for index, law in enumerate(result.laws):
        points = [point for point, _ in result.designs(law)]
        shown += points
        small = _marker(index) | {"markersize": 3.5, "alpha": 0.55}
        axes.plot([x for x, _ in points], [y for _, y in points], linestyle="none", **small)
        front = result.fronts[law]
        axes.plot([x for x, _ in front], [y for _, y in front], drawstyle="steps-post", **_line(index))
    if result.reference is not None:
        axes.plot(*([one] for one in result.reference), linestyle="none", marker="x", color="#000000", markersize=8.0)
        axes.annotate("reference point", result.reference, (-6, 6), textcoords="offset points", ha="right")
        shown.append(result.reference)
    _scale(axes, [x for x, _ in shown], "x")
    _scale(axes, [y for _, y in shown], "y")
    axes.set_xlabel(_marked(result.objectives[0], result.step_sensitive))
    axes.set_ylabel(_marked(result.objectives[1], result.step_sensitive))
    drawing.plain_decades(figure)
    _legend(figure, result.laws, titles)
    return figure


def monte_carlo_figure(result: MonteCarlo, titles: Titles | None = None) -> Figure:
    """For each metric its distribution under each law and the paired differences; the rates below."""
    rows = len(result.metrics) + 1
    pairs = len(result.laws) * (len(result.laws) - 1) // 2
    heights = [max(2.1, 0.6 + 0.27 * pairs)] * len(result.metrics) + [max(2.1, 0.6 + 0.27 * len(result.laws))]
    figure = drawing.new_figure(_WIDTH, 0.5 + sum(heights))
    grid = figure.subplots(rows, 2, height_ratios=heights)
    for row, metric in enumerate(result.metrics):
        _draw_distributions(grid[row, 0], result, metric)
        _draw_differences(grid[row, 1], result, metric)
    for axes, name, title in zip(
        grid[-1],
        ("failure", "near_singular"),
        ("share of runs that failed", "share of runs near the singularity"),
        strict=True,
    ):
        for index, one in enumerate(result.rates):
            _draw_interval(axes, index, getattr(one, name), index)
        axes.set_yticks(range(len(result.laws)), result.laws)
        axes.set_ylim(len(result.laws) - 0.5, -0.5)
        axes.set_xlim(left=-0.02 * axes.get_xlim()[1])
        axes.set_title(title, loc="left")
    drawing.plain_decades(figure)
    _legend(figure, result.laws, titles)
    return figure


def _draw_distributions(axes: Axes, result: MonteCarlo, metric: str) -> None:
    shown = [value for law in result.laws for value in result.values(law, metric) if value is not None]
    least = _least_drawn(shown)
    for index, law in enumerate(result.laws):
        known = sorted(max(value, least) for value in result.values(law, metric) if value is not None)
        share = np.arange(1, len(known) + 1) / result.cases
        axes.plot(known, share, drawstyle="steps-post", **drawing.style(index))
    _scale(axes, [max(value, least) for value in shown], "x")
    axes.set_ylim(0.0, 1.02)
    axes.set_ylabel("share of cases")
    axes.set_title(_marked(metric, result.step_sensitive), loc="left")


def _least_drawn(values: Sequence[float]) -> float:
    """What smaller values are drawn at: nothing if any is negative, else nine decades below the largest."""
    return -math.inf if not values or min(values) < 0.0 else _DRAWN * max(values)


def _draw_differences(axes: Axes, result: MonteCarlo, metric: str) -> None:
    pairs = [one for one in result.differences if one.metric == metric]
    for row, one in enumerate(pairs):
        _draw_interval(axes, row - 0.14, one.median, 0)
        _draw_interval(axes, row + 0.14, one.mean, 1)
    axes.axvline(0.0, color="#000000", linewidth=0.8)
    axes.set_yticks(range(len(pairs)), [f"{one.first} − {one.second}" for one in pairs])
    axes.set_ylim(max(len(pairs), 1) - 0.5, -0.5)
    axes.xaxis.set_major_locator(MaxNLocator(6))
    _spread_signed(axes, pairs)
    axes.set_title("paired differences: ● median, ■ mean", loc="left")


def _spread_signed(axes: Axes, pairs: Sequence[Difference]) -> None:
    """Logarithmic on both sides of zero where the differences are decades apart."""
    sizes = [abs(one.estimate) for pair in pairs for one in (pair.median, pair.mean) if one.estimate]
    ends = [abs(end) for pair in pairs for one in (pair.median, pair.mean) for end in (one.low, one.high) if end]
    if sizes and max(sizes) > _DECADES**2 * min(sizes):
        smallest = max(min(sizes), 1e-4 * max(sizes))
        drawing.signed_scale(axes, "x", 10.0 ** math.floor(math.log10(smallest)), max(*sizes, *ends))


def _draw_interval(axes: Axes, height: float, one: Estimate, index: int) -> None:
    if one.estimate is None:
        return
    axes.plot([one.estimate], [height], linestyle="none", **_marker(index))
    if one.low is not None and one.high is not None:
        color = drawing.STYLES[index % len(drawing.STYLES)].color
        axes.plot([one.low, one.high], [height, height], color=color, linewidth=2.0, solid_capstyle="butt", zorder=2.0)


def _with(tuning: Tuning, result: EqualEffort) -> list[tuple[Trial, float]]:
    """Runs of a tuning that have the effort, with it."""
    known = [(one, one.value(result.effort)) for one in tuning.trials]
    return [(one, effort) for one, effort in known if effort is not None]


def _line(index: int) -> dict[str, Any]:
    """Line and markers of a law, in the panels and in the legend."""
    return _marker(index) | drawing.style(index)


def _hollow(index: int) -> dict[str, Any]:
    """Markers of laws beyond the styles are hollow, of those yet further on grey."""
    turn = index // len(drawing.STYLES)
    return {"markerfacecolor": "#ffffff" if turn % 2 else "#9aa4ab"} if turn else {}


def _size(index: int) -> float:
    """Size of a law's marker: what lies further back is larger, so that coinciding points all show."""
    return max(4.0, 11.0 - 1.5 * drawing.STYLES[index % len(drawing.STYLES)].order)


def _marker(index: int) -> dict[str, Any]:
    one = drawing.STYLES[index % len(drawing.STYLES)]
    return {
        "marker": MARKERS[index % len(MARKERS)],
        "color": drawing.style(index)["color"],
        "markeredgecolor": "#000000",
        "markeredgewidth": 1.0 if index >= len(drawing.STYLES) else 0.5,
        "markersize": _size(index) + 1.0,
        "zorder": one.order,
    } | _hollow(index)


def _marked(metric: str, step_sensitive: frozenset[str], *, units: bool = True) -> str:
    text = with_unit(metric) if units else phrase(metric)
    return f"{text} (depends on the step)" if metric in step_sensitive else text


def _scale(axes: Axes, values: Sequence[float], which: str) -> None:
    """Logarithmic where all values are positive and far apart."""
    if values and min(values) > 0.0 and max(values) > _DECADES * min(values):
        (axes.set_xscale if which == "x" else axes.set_yscale)("log")


def _scale_knob(axes: Axes, values: Sequence[float]) -> None:
    """Logarithmic over a knob that spans decades; zero, if it is there, gets its own place beside them."""
    positive = [one for one in values if one > 0.0]
    if min(values) < 0.0 or len(positive) < 2 or max(positive) <= _DECADES * min(positive):
        return
    if len(positive) == len(values):
        axes.set_xscale("log")
    else:
        axes.set_xscale("symlog", linthresh=min(positive), linscale=0.3)
        powers = range(math.ceil(math.log10(min(positive))), math.floor(math.log10(max(positive))) + 1)
        axes.set_xticks([0.0, *(10.0**k for k in powers)], ["0", *(power_of_ten(10.0**k) for k in powers)])


def _legend(figure: Figure, laws: Sequence[str], titles: Titles | None) -> None:
    handles = [Line2D([], [], label=(titles or {}).get(law) or law, **_line(index)) for index, law in enumerate(laws)]
    labels = [str(one.get_label()) for one in handles]
    columns = drawing.legend_columns(labels, float(figure.get_figwidth()), 4)
    figure.legend(handles=handles, loc="outside upper center", ncols=columns, frameon=False)
