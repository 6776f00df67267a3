"""Paths of the robot in the plane."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from brunovsky.comparison import drawing
from brunovsky.comparison.claim import is_regulation
from brunovsky.comparison.figures.traces import (
    END,
    START,
    TARGET,
    Drawn,
    add_legend,
    drawable,
    place_handles,
)
from brunovsky.comparison.metrics import Array, error_names, values
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.study import Law, Scenario

_AWAY = 20.0  # a path that diverged is drawn up to so many times its first distance from the reference


def path_figure(comparison: Comparison, scenario: Scenario) -> Figure:
    """Path of one scenario under its laws, on equal scales."""
    laws = drawable(comparison, scenario)
    figure = drawing.new_figure(6.6, 4.4, left=0.1, right=0.98, bottom=0.11, top=0.88)
    axes = figure.subplots()
    _draw_paths(axes, laws, framed=True)
    regulation = {is_regulation(run) for _, _, run in laws}
    add_legend(figure, [(index, law) for index, law, _ in laws], place_handles(regulation))
    return figure


def paths_figure(comparison: Comparison, scenarios: Sequence[Scenario], laws: Sequence[str] | None = None) -> Figure:
    """Paths of several scenarios side by side, on equal scales."""
    count = max(len(scenarios), 1)
    runs = [run for scenario in scenarios for _, _, run in drawable(comparison, scenario)]
    spans = [_span(runs, name) for name in "xy"]
    width = 9.4 / count
    height = min(max((width - 0.5) * spans[1] / spans[0], 1.5), 6.0)
    titles = [textwrap.fill(one.title, int(14 * width)) for one in scenarios]
    top = 0.2 + 0.16 * max((one.count("\n") for one in titles), default=0)
    tall = height + 0.55 + top
    sides = {"left": 0.07, "right": 0.985, "bottom": 0.55 / tall, "top": 1.0 - top / tall}
    figure = drawing.new_figure(9.4, tall, wspace=0.14, **sides)
    found: dict[int, Law] = {}
    regulation: set[bool] = set()
    row = np.atleast_1d(figure.subplots(1, count, sharex=True, sharey=True))
    for axes, scenario, title in zip(row, scenarios, titles, strict=True):
        drawn = [one for one in drawable(comparison, scenario) if laws is None or one[1].name in laws]
        _draw_paths(axes, drawn, framed=False)
        axes.set_title(title, loc="left")
        found |= {index: law for index, law, _ in drawn}
        regulation |= {is_regulation(run) for _, _, run in drawn}
    for axes in row[1:]:
        axes.set_ylabel("")
    add_legend(figure, sorted(found.items()), place_handles(regulation))
    return figure


def _span(runs: Sequence[Run], name: str) -> float:
    """Extent of all paths along one axis, m, never zero."""
    ends = [extreme(path_of(run)["xy".index(name)]) for run in runs for extreme in (np.min, np.max)]
    return max(float(np.max(ends) - np.min(ends)), 1e-6) if ends else 1.0


def path_of(run: Run) -> tuple[Array, Array, Array, Array]:
    """Positions of the robot and of its reference (x, y, xd, yd; m), without what diverged beyond all scales."""
    x, y, e1, e2 = (values(run.trajectory, name) for name in ("x", "y", *error_names(run.trajectory)))
    error = np.hypot(e1, e2)
    near = error <= (np.inf if run.ok else _AWAY * max(float(error[0]), 1.0))
    count = near.size if near.all() else int(np.argmin(near))
    x, y, e1, e2 = (one[:count] for one in (x, y, e1, e2))
    return x, y, x - e1, y - e2


def _draw_paths(axes: Axes, laws: Drawn, *, framed: bool) -> None:
    for index, _, run in laws:
        x, y, _, _ = path_of(run)
        step = max(1, x.size // 8000)
        axes.plot(x[::step], y[::step], **drawing.style(index), **drawing.marks(index, x[::step].size))
    if laws:
        run = max((run for _, _, run in laws), key=lambda one: path_of(one)[0].size)
        x, y, xd, yd = path_of(run)
        axes.plot(xd[::10], yd[::10], **drawing.REFERENCE)
        if not is_regulation(run):
            axes.plot(x[-1:], y[-1:], **END)
        axes.plot(x[:1], y[:1], markerfacecolor="#ffffff", **START)
        if is_regulation(run):
            axes.plot(xd[:1], yd[:1], **TARGET)
    axes.set_aspect("equal", adjustable="datalim" if framed else "box")
    axes.margins(0.08)
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
