"""Figures of an analysis, as SVG."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from brunovsky.analysis import (
    boundary_layer_plot,
    boundary_layer_trade_off,
    input_sensitivity_plot,
    pole_zero_map,
    root_locus_over_reaching_rate,
)
from brunovsky.blocks import robot_linearization
from brunovsky.comparison import drawing
from brunovsky.comparison.analyze_chatter_figures import chatter_figures
from brunovsky.comparison.analyze_loop_figures import (
    Loops,
    gang_of_four_figure,
    loop_figure,
    loop_frequencies,
    step_response_figure,
)
from brunovsky.comparison.analyzed_loops import AnalyzedLaw, loops_by_name
from brunovsky.comparison.facts import given
from brunovsky.comparison.run import Progress

if TYPE_CHECKING:
    from brunovsky.comparison.analyze import Analysis

_MARKERS = ("x", "s", "^", "D", "v", "P")
_RATES = 800  # values of Q along a root locus
_SPEEDS = np.geomspace(0.01, 10.0, 13)  # m/s


def analysis_figures(analysis: Analysis, progress: Progress | None = None) -> dict[str, str]:
    """SVG of each figure by its name: those of the laws, then those of the chatter grids."""
    loops = loops_by_name(analysis.laws)
    stable = {name: loop for name, loop in loops.items() if loop.stable}
    makers: dict[str, Callable[[], Figure]] = {}
    if loops:
        makers |= {"poles": lambda: _poles(loops), "root-locus": lambda: _root_locus(analysis)}
    if stable:
        makers |= {
            "loop": lambda: loop_figure(stable, loop_frequencies(stable)),
            "gang-of-four": lambda: gang_of_four_figure(stable),
            "step-response": lambda: step_response_figure(stable),
        }
    layered = layered_law(analysis)
    if layered is not None:
        makers["boundary-layer"] = lambda: _boundary_layer(layered)
    makers |= {"input-sensitivity": lambda: _input_sensitivity(analysis), **chatter_figures(analysis)}
    drawn: dict[str, str] = {}
    with drawing.settings():
        for name, make in makers.items():
            if progress is not None:
                progress(len(drawn), len(makers), f"drawing {name}")
            figure = make()
            drawing.plain_decades(figure)
            drawn[name] = drawing.svg(figure, name)
    if progress is not None:
        progress(len(drawn), len(makers), "figures")
    return drawn


def _poles(loops: Loops) -> Figure:
    figure = drawing.new_figure(7.0, 3.4)
    axes = figure.subplots()
    for index, (name, loop) in enumerate(loops.items()):
        look: dict[str, Any] = {"color": drawing.STYLES[index % len(drawing.STYLES)].color, "linestyle": "none"}
        size = 7.0 + 3.0 * index
        axes.plot(
            loop.poles.real,
            loop.poles.imag,
            marker=_MARKERS[index % 6],
            markersize=size,
            fillstyle="none",
            label=name,
            **look,
        )
        zeros = pole_zero_map(loop.gain).zeros
        label = f"zeros of L, {name}"
        axes.plot(zeros.real, zeros.imag, marker="o", markersize=size - 3.0, fillstyle="none", label=label, **look)
    _complex_plane(axes)
    figure.legend(loc="outside right upper", frameon=False, labelspacing=1.0)
    return figure


def _root_locus(analysis: Analysis) -> Figure:
    law = next((one for one in analysis.laws if one.boundary_layer is not None), analysis.laws[0])
    rates = {"Q": law.Q} | ({"Q + P/φ": law.Q + law.P / law.phi} if law.boundary_layer is not None else {})
    margins = law.linear_part.margins
    lag = 0.5 * margins.lag if margins is not None and np.isfinite(margins.lag) else 0.0
    figure = drawing.new_figure(9.0, 3.8)
    highest = 1.5 * max(*rates.values(), 1.0)
    for axes, tau in zip(figure.subplots(1, 2), (0.0, lag), strict=True):
        values = (
            np.unique(np.concatenate((np.geomspace(1e-3, 1.0, _RATES), np.linspace(0.0, 1.0, 2 * _RATES)))) * highest
        )
        locus = root_locus_over_reaching_rate(law.C, lag=tau, rates=values)
        for index, branch in enumerate(locus.loci.T):
            label = "" if index else f"Q from 0 to {highest:.3g} 1/s"
            axes.plot(branch.real, branch.imag, color="#7d878e", linewidth=2.0, label=label)
        for (name, rate), marker in zip(rates.items(), _MARKERS, strict=False):
            poles = root_locus_over_reaching_rate(law.C, lag=tau, rates=[rate]).loci[0]
            axes.plot(
                poles.real,
                poles.imag,
                linestyle="none",
                marker=marker,
                color="#0b3c6f",
                fillstyle="none",
                label=f"{name} = {rate:.3g} 1/s",
            )
        _complex_plane(axes)
        axes.set_title("no lag at v" if tau == 0.0 else f"one lag of {1e3 * tau:.3g} ms at v, half of what P = 0 takes")
        axes.legend(loc="best")
    return figure


def _complex_plane(axes: Axes) -> None:
    axes.axvline(0.0, color="#000000", linewidth=0.8)
    axes.axhline(0.0, color="#000000", linewidth=0.8)
    axes.set(xlabel="real part, 1/s", ylabel="imaginary part, rad/s")
    axes.margins(0.12, 0.15)


def layered_law(analysis: Analysis) -> AnalyzedLaw | None:
    """The law whose boundary layer is drawn: the first that has one, else one that switches; None without either."""
    switching = [one for one in analysis.laws if one.P > 0.0 and one.Q > 0.0]
    return next((one for one in switching if one.boundary_layer is not None), next(iter(switching), None))


def _boundary_layer(law: AnalyzedLaw) -> Figure:
    figure = drawing.new_figure(6.4, 5.6)
    axes = figure.subplots(2, 1, sharex=True)
    center = law.phi or 0.05
    widths = np.geomspace(center / 30.0, center * 30.0, 61)
    boundary_layer_plot(
        boundary_layer_trade_off(law.C, law.Q, law.P, 0.5 * law.matched_disturbance_bound, widths), ax=axes
    )
    if law.phi:
        for one in axes:
            one.axvline(
                law.phi, color="#000000", linewidth=1.0, linestyle=":", label=f"the study's {given(law.phi)} m/s²"
            )
            one.legend()
    return figure


def _input_sensitivity(analysis: Analysis) -> Figure:
    figure = drawing.new_figure(6.4, 3.8)
    axes = figure.subplots()
    point = {"x": 0.0, "y": 0.0, "theta": 0.0, "eta_1": 1.0, "eta_2": 0.0, "u_1": 0.0}
    input_sensitivity_plot(robot_linearization(), "eta_1", _SPEEDS, point, ax=axes)
    guards = sorted({run.guard for run in analysis.study.plan() if run.guard is not None})
    for guard in guards:
        if guard > 0.0:
            axes.axvline(guard, color="#000000", linewidth=1.0, linestyle=":", label=f"eta_min = {given(guard)} m/s")
    axes.set(xlabel="speed |η₁|, m/s", ylabel="|du₂/dv|, rad s/m; |dw₁/dv|, 1", title="sensitivity of the inputs to v")
    axes.legend()
    return figure
