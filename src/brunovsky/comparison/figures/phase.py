"""Phase portraits of a scenario: error and its rate, sliding variable and its rate, for each chain."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import ScalarFormatter

from brunovsky.comparison import drawing
from brunovsky.comparison.drawing_once import drawn_once
from brunovsky.comparison.figures.traces import START, Drawn, add_legend, draw_limits, drawable, layers, place_handles
from brunovsky.comparison.metrics import Array, error_names, instants, values
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.study import Scenario

_LINEAR = 0.01  # m/s2; up to it the axis of S is linear


def phase_figure(comparison: Comparison, scenario: Scenario) -> Figure:
    """(e, e') and (S, S') of both chains, over the whole run; dotted is the reaching law without disturbance."""
    laws = drawable(comparison, scenario)
    figure = drawing.new_figure(9.4, 5.6, left=0.07, right=0.985, bottom=0.085, top=0.9, hspace=0.32, wspace=0.17)
    grid = figure.subplots(2, 2)
    for axes, k, name in zip(grid[0], (1, 2), "xy", strict=True):
        _draw_portrait(axes, [(index, *_error_plane(run, k)) for index, _, run in laws])
        axes.set(xlabel=f"e of the {name} chain, m", ylabel="e′, m/s")
    for axes, k in zip(grid[1], (1, 2), strict=True):
        planes = [(index, *_surface_plane(run, k)) for index, _, run in laws if f"S[{k}]" in run.trajectory]
        _scale(axes, planes, laws)
        _draw_portrait(axes, planes)
        _draw_reaching(axes, laws)
        draw_limits(axes, layers(laws), "φ", vertical=True)
        axes.set(xlabel=f"S{'₁₂'[k - 1]}, m/s²", ylabel=f"S{'₁₂'[k - 1]}′, m/s³")
    add_legend(figure, [(index, law) for index, law, _ in laws], place_handles(set()))
    return figure


def _error_plane(run: Run, chain: int) -> tuple[Array, Array]:
    """Error of a chain (m) and its rate (m/s), by central differences."""
    time, error = instants(run.trajectory), values(run.trajectory, error_names(run.trajectory)[chain - 1])
    keep = np.abs(error) <= drawing.LARGEST
    time, error = time[keep], error[keep]
    return (error, np.gradient(error, time)) if error.size > 1 else (error, np.zeros_like(error))


def _surface_plane(run: Run, chain: int) -> tuple[Array, Array]:
    """Sliding variable of a chain at the start of each step (m/s2), and its mean rate over the step (m/s3)."""
    time, S = instants(run.trajectory), values(run.trajectory, f"S[{chain}]")
    keep = np.abs(S) <= drawing.LARGEST
    time, S = time[keep], S[keep]
    return (S[:-1], np.diff(S) / np.diff(time)) if S.size > 1 else (S, np.zeros_like(S))


def _scale(axes: Axes, planes: list[tuple[int, Array, Array]], laws: Drawn) -> None:
    """Signed logarithmic axes that hold all planes."""
    switching = max((run.planned.parameters["P"] for _, _, run in laws if run.planned.in_family), default=0.0)
    for axis, column, at_least in (("x", 1, _LINEAR), ("y", 2, max(1.0, 2.0 * switching))):
        peak = max([at_least, *(float(np.max(np.abs(one[column]), initial=0.0)) for one in planes)])
        drawing.signed_scale(axes, axis, _LINEAR if axis == "x" else 1.0, peak)


def _draw_portrait(axes: Axes, planes: list[tuple[int, Array, Array]]) -> None:
    for _, x, y in planes:
        if axes.get_xscale() == "linear":
            axes.update_datalim(np.column_stack((x, y)))
            axes.autoscale_view()
            axes.locator_params(axis="x", nbins=7)
            for axis in (axes.xaxis, axes.yaxis):
                formatter = axis.get_major_formatter()
                if isinstance(formatter, ScalarFormatter):  # not that of a signed logarithmic axis
                    formatter.set_powerlimits((-3, 4))
    for index, x, y in planes:
        xs, ys = drawn_once(axes, x, y)
        axes.plot(xs, ys, **drawing.style(index), **drawing.marks(index, xs.size))
        axes.plot(x[:1], y[:1], markerfacecolor="#ffffff", **START)
    axes.axhline(0.0, color="#7d878e", linewidth=0.6)
    axes.axvline(0.0, color="#7d878e", linewidth=0.6)


def _draw_reaching(axes: Axes, laws: Drawn) -> None:
    """S' = -Q S - P f(S) of each law of the paper's form, without disturbance."""
    low, high = axes.get_xlim()
    size = np.geomspace(1e-3 * _LINEAR, max(-low, high), 200)
    S = np.concatenate((-size[::-1], size))
    for _, law, run in laws:
        if not run.planned.in_family:
            continue
        p = run.planned.parameters
        width = p["phi"] if law.kind == "saturation" else 0.0
        switching = np.clip(S / width, -1.0, 1.0) if width else np.sign(S)
        axes.plot(S, -p["Q"] * S - p["P"] * switching, **drawing.REFERENCE)
    axes.set_xlim(low, high)
