"""Errors, physical inputs and sliding variables of a scenario over time."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from brunovsky.comparison import drawing
from brunovsky.comparison.figures.traces import (
    Drawn,
    add_legend,
    draw_limits,
    draw_signal,
    drawable,
    layers,
    shown,
    transient_window,
)
from brunovsky.comparison.metrics import SETTLED, error_names, position_error
from brunovsky.comparison.run import Comparison
from brunovsky.comparison.study import Scenario

_ROW = {"left": 0.055, "right": 0.985, "bottom": 0.16, "top": 0.8, "wspace": 0.27}
_SMALLEST_ERROR = 1e-9  # m; lower end of the error axis


def errors_figure(comparison: Comparison, scenario: Scenario) -> Figure:
    """Position error, and the error of each chain."""
    laws, window = drawable(comparison, scenario), transient_window(comparison, scenario)
    figure = drawing.new_figure(9.4, 2.9, **_ROW)
    distance, *chains = figure.subplots(1, 3)
    _draw_distance(distance, laws, window)
    for axes, chain, label in zip(chains, (0, 1), ("x − x_d, m", "y − y_d, m"), strict=True):
        for one in laws:
            draw_signal(axes, [one], error_names(one[2].trajectory)[chain], window)
        drawing.signed_decades(axes, 1e-3, at_least=SETTLED)
        axes.set_title(label.replace("_d", "$_\\mathrm{d}$"), loc="left")
    add_legend(figure, [(index, law) for index, law, _ in laws])
    return figure


def inputs_figure(comparison: Comparison, scenario: Scenario) -> Figure:
    """Both inputs of the robot, and the speed that the law divides by."""
    laws, window = drawable(comparison, scenario), transient_window(comparison, scenario)
    figure = drawing.new_figure(9.4, 2.9, **_ROW)
    u1, u2, speed = figure.subplots(1, 3)
    for axes, name, label in (
        (u1, "u[1]", "forward acceleration u₁, m/s²"),
        (u2, "u[2]", "yaw acceleration u₂, rad/s²"),
    ):
        draw_signal(axes, laws, name, window)
        drawing.signed_decades(axes, 1.0, at_least=10.0)
        axes.set_title(label, loc="left")
    draw_signal(speed, laws, "eta[1]", window)
    guards = [run.planned.guard for _, _, run in laws if run.planned.guard is not None]
    draw_limits(speed, guards, "η_min")
    drawing.signed_decades(speed, 0.1, at_least=0.1)
    note = ";  dotted: ±$\\eta_\\mathrm{min}$" if guards else ""
    speed.set_title(f"velocity η₁, m/s{note}", loc="left")
    add_legend(figure, [(index, law) for index, law, _ in laws])
    return figure


def sliding_figure(comparison: Comparison, scenario: Scenario) -> Figure:
    """Sliding variable of each chain, with the boundary layers."""
    laws, window = drawable(comparison, scenario), transient_window(comparison, scenario)
    figure = drawing.new_figure(9.4, 2.7, **{**_ROW, "wspace": 0.16})
    found = layers(laws)
    for axes, k in zip(figure.subplots(1, 2), (1, 2), strict=True):
        draw_signal(axes, laws, f"S[{k}]", window)
        draw_limits(axes, found, "φ")
        drawing.signed_decades(axes, 0.01, at_least=0.01)
        note = ";  dotted: boundary layer ±φ" if found else ""
        axes.set_title(f"sliding variable S{'₁₂'[k - 1]}, m/s²{note}", loc="left")
    add_legend(figure, [(index, law) for index, law, _ in laws])
    return figure


def _draw_distance(axes: Axes, laws: Drawn, window: float) -> None:
    highest = 10 * SETTLED
    for index, _, run in laws:
        time, inside = shown(run, window)
        time, error = drawing.thinned(time, position_error(run.trajectory)[inside])
        axes.plot(time, np.maximum(error, _SMALLEST_ERROR), **drawing.style(index), **drawing.marks(index, time.size))
        highest = max(highest, float(np.max(error, initial=0.0)))
    drawing.limit_decades(axes, _SMALLEST_ERROR, highest, most=5)
    axes.axhline(SETTLED, **drawing.REFERENCE)
    axes.set_title(f"position error, m;  dotted: {SETTLED * 100:g} cm", loc="left")
    axes.set_xlim(0.0, window)
    axes.set_xlabel("time, s")
