"""Figures of a report, drawn with matplotlib's object-oriented interface."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from brunovsky.comparison import drawing
from brunovsky.comparison.metrics import SETTLED, Array, instants, position_error, values
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.study import Law, Scenario

_SMALLEST_ERROR = 1e-9  # m; lower end of the error axis
_AWAY = 20.0  # a path that diverged is drawn up to so many times its first distance from the reference
_POINT: dict[str, Any] = {"linestyle": "none", "color": "#000000", "zorder": 8.0}
_START = {**_POINT, "marker": "o", "markersize": 6.0}
_END = {**_POINT, "marker": "o", "markersize": 4.5}
_TARGET = {**_POINT, "marker": "x", "markersize": 7.0, "markeredgewidth": 1.8}


def scenario_figure(comparison: Comparison, scenario: Scenario) -> Figure:
    """Path, position error, speed, inputs and sliding variables of one scenario under its laws."""
    laws = _drawable(comparison, scenario)
    figure = drawing.new_figure(9.4, 8.8, left=0.07, right=0.98, bottom=0.055, top=0.925, hspace=0.62, wspace=0.17)
    grid = figure.add_gridspec(4, 2)
    path = figure.add_subplot(grid[:2, 0])
    error, speed = figure.add_subplot(grid[2, 0]), figure.add_subplot(grid[3, 0])
    right = [figure.add_subplot(grid[row, 1]) for row in range(4)]
    window = transient_window(comparison, scenario)
    _draw_paths(path, laws, titled=True)
    _draw_error(error, laws, window)
    _draw_speed(speed, laws, window)
    layers = [run.planned.parameters["phi"] for _, law, run in laws if law.kind == "saturation"]
    for axes, name, label, linear in zip(
        right,
        ("u[1]", "u[2]", "S[1]", "S[2]"),
        (
            "forward acceleration u₁, m/s²",
            "yaw acceleration u₂, rad/s²",
            *(f"sliding variable S{k}, m/s²" for k in "₁₂"),
        ),
        (1.0, 1.0, 0.01, 0.01),
        strict=True,
    ):
        _draw_signal(axes, laws, name, window)
        if name.startswith("S") and layers:
            _draw_limits(axes, layers)
            label += ";  dotted: boundary layer ±φ"
        drawing.signed_decades(axes, linear, at_least=10.0 * linear if name.startswith("u") else linear)
        axes.set_title(label, loc="left")
    for axes in (error, speed, *right):
        axes.set_xlabel("time, s")
    _legend(figure, [(index, law) for index, law, _ in laws], {_is_regulation(run) for _, _, run in laws})
    return figure


def paths_figure(comparison: Comparison, scenarios: Sequence[Scenario], laws: Sequence[str] | None = None) -> Figure:
    """Paths of several scenarios side by side, on equal scales."""
    count = max(len(scenarios), 1)
    runs = [run for scenario in scenarios for _, _, run in _drawable(comparison, scenario)]
    spans = [_span(runs, name) for name in "xy"]
    width = 9.4 / count
    height = min(max((width - 0.5) * spans[1] / spans[0], 1.5), 6.0)
    figure = drawing.new_figure(9.4, height + 1.1)
    shown: dict[int, Law] = {}
    regulation: set[bool] = set()
    row = np.atleast_1d(figure.subplots(1, count, sharex=True, sharey=True))
    for axes, scenario in zip(row, scenarios, strict=True):
        drawn = [one for one in _drawable(comparison, scenario) if laws is None or one[1].name in laws]
        _draw_paths(axes, drawn, titled=False)
        axes.set_title(textwrap.fill(scenario.title, int(14 * width)), loc="left")
        shown |= {index: law for index, law, _ in drawn}
        regulation |= {_is_regulation(run) for _, _, run in drawn}
    for axes in row[1:]:
        axes.set_ylabel("")
    _legend(figure, sorted(shown.items()), regulation)
    return figure


def poles_figure(groups: Sequence[tuple[str, np.ndarray[Any, np.dtype[np.complex128]]]]) -> Figure:
    """Poles of several linear loops in the complex plane."""
    figure = drawing.new_figure(6.2, 2.6)
    axes = figure.subplots()
    markers = (("x", "#0b3c6f", 9.0, 2.0), ("s", "#e8730c", 12.0, 1.3), ("o", "#7d878e", 16.0, 1.0))
    for (label, poles), (marker, color, size, width) in zip(groups, markers, strict=False):
        style: dict[str, Any] = {"markeredgecolor": color, "markersize": size, "markeredgewidth": width}
        axes.plot(poles.real, poles.imag, linestyle="none", marker=marker, markerfacecolor="none", label=label, **style)
    axes.axvline(0.0, color="#000000", linewidth=0.8)
    axes.axhline(0.0, color="#000000", linewidth=0.8)
    axes.set_xlabel("real part, 1/s")
    axes.set_ylabel("imaginary part, rad/s")
    axes.margins(0.12, 0.25)
    figure.legend(loc="outside right center", frameon=False, labelspacing=1.1)
    return figure


def transient_window(comparison: Comparison, scenario: Scenario) -> float:
    """Time up to which inputs are shown, s: two and a half times the longest settling time, at least 2 s."""
    settled = [run.metrics.settling_time for _, run in comparison.laws_of(scenario) if run.ok]
    known = [one for one in settled if one is not None]
    if not known or len(known) < len(settled):
        return scenario.duration_s
    return min(scenario.duration_s, max(2.0, float(np.ceil(2.5 * max(known)))))


def _span(runs: Sequence[Run], name: str) -> float:
    """Extent of all paths along one axis, m, never zero."""
    ends = [extreme(path_of(run)["xy".index(name)]) for run in runs for extreme in (np.min, np.max)]
    return max(float(np.max(ends) - np.min(ends)), 1e-6) if ends else 1.0


def path_of(run: Run) -> tuple[Array, Array, Array, Array]:
    """Positions of the robot and of its reference (x, y, xd, yd; m), without what diverged beyond all scales."""
    x, y, e1, e2 = (values(run.trajectory, name) for name in ("x", "y", "e1[1]", "e2[1]"))
    error = np.hypot(e1, e2)
    near = error <= (np.inf if run.ok else _AWAY * max(float(error[0]), 1.0))
    count = near.size if near.all() else int(np.argmin(near))
    x, y, e1, e2 = (one[:count] for one in (x, y, e1, e2))
    return x, y, x - e1, y - e2


def _drawable(comparison: Comparison, scenario: Scenario) -> list[tuple[int, Law, Run]]:
    """Laws of a scenario with something to draw: index in the study, law and run."""
    index = {law.name: number for number, law in enumerate(comparison.study.laws)}
    pairs = comparison.laws_of(scenario)
    return [(index[law.name], law, run) for law, run in pairs if run.trajectory.sizes["time"] > 0]


def _draw_paths(axes: Axes, laws: Sequence[tuple[int, Law, Run]], *, titled: bool) -> None:
    for index, _, run in laws:
        x, y, _, _ = path_of(run)
        step = max(1, x.size // 8000)
        axes.plot(x[::step], y[::step], **drawing.style(index))
    if laws:
        run = max((run for _, _, run in laws), key=lambda one: path_of(one)[0].size)
        x, y, xd, yd = path_of(run)
        axes.plot(xd[::10], yd[::10], **drawing.REFERENCE)
        if not _is_regulation(run):
            axes.plot(x[-1:], y[-1:], **_END)
        axes.plot(x[:1], y[:1], markerfacecolor="#ffffff", **_START)
        if _is_regulation(run):
            axes.plot(xd[:1], yd[:1], **_TARGET)
    axes.set_aspect("equal", adjustable="datalim" if titled else "box")
    axes.margins(0.08)
    axes.set_xlabel("x, m")
    axes.set_ylabel("y, m")
    if titled:
        axes.set_title("path", loc="left")


def _draw_error(axes: Axes, laws: Sequence[tuple[int, Law, Run]], window: float) -> None:
    highest = 10 * SETTLED
    for index, _, run in laws:
        time = instants(run.trajectory)
        shown = time <= window * (1.0 + 1e-9)
        time, error = drawing.thinned(time[shown], position_error(run.trajectory)[shown])
        axes.plot(time, np.maximum(error, _SMALLEST_ERROR), **drawing.style(index))
        highest = max(highest, float(np.max(error, initial=0.0)))
    drawing.limit_decades(axes, _SMALLEST_ERROR, highest, most=5)
    axes.axhline(SETTLED, **drawing.REFERENCE)
    axes.set_title(f"position error, m;  dotted: {SETTLED * 100:g} cm", loc="left")
    axes.set_xlim(0.0, window)


def _draw_speed(axes: Axes, laws: Sequence[tuple[int, Law, Run]], window: float) -> None:
    _draw_signal(axes, laws, "eta[1]", window)
    _draw_limits(axes, [run.planned.parameters["eta_min"] for _, _, run in laws])
    drawing.signed_decades(axes, 0.1, at_least=0.1)
    axes.set_title("forward velocity η₁, m/s;  dotted: guard ±$\\eta_\\mathrm{min}$", loc="left")


def _draw_limits(axes: Axes, limits: Sequence[float]) -> None:
    for limit in sorted(set(limits)):
        for value in (-limit, limit):
            axes.axhline(value, **drawing.REFERENCE)


def _draw_signal(axes: Axes, laws: Sequence[tuple[int, Law, Run]], name: str, window: float) -> None:
    for index, _, run in laws:
        time = instants(run.trajectory)
        shown = time <= window * (1.0 + 1e-9)
        axes.plot(*drawing.thinned(time[shown], values(run.trajectory, name)[shown]), **drawing.style(index))
    axes.set_xlim(0.0, window)


def _legend(figure: Figure, laws: Sequence[tuple[int, Law]], regulation: set[bool]) -> None:
    handles = [Line2D([], [], label=law.title or law.name, **drawing.style(index)) for index, law in laws]
    handles.append(Line2D([], [], label="start", markerfacecolor="#ffffff", **_START))
    if True in regulation:
        handles.append(Line2D([], [], label="target", **_TARGET))
    if False in regulation:
        handles.append(Line2D([], [], label="end", **_END))
        handles.append(Line2D([], [], label="reference", **drawing.REFERENCE))
    figure.legend(handles=handles, loc="outside upper center", ncols=len(handles), frameon=False, columnspacing=1.4)


def _is_regulation(run: Run) -> bool:
    return run.planned.parameters["radius"] == 0.0
