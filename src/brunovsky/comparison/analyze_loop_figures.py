"""Figures of the linear loops of an analysis: Bode, Nyquist, gang of four, step response."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import control
import numpy as np
from matplotlib.figure import Figure

from brunovsky.analysis import Margins, gang_of_four, set_point_transfer
from brunovsky.comparison import drawing
from brunovsky.comparison.analyzed_loops import AnalyzedLoop
from brunovsky.comparison.loop_curves import LoopCurve, ResponseMargins

Loops = Mapping[str, AnalyzedLoop]
Frequencies = np.ndarray[Any, np.dtype[np.float64]]
_LOWEST = -450.0  # degrees; where a delay turns the phase further, it is not drawn


def loop_figure(loops: Mapping[str, AnalyzedLoop | LoopCurve], w: Frequencies) -> Figure:
    """Bode plot of loops at v with their margins, and the Nyquist plot with the circles of the modulus margins."""
    figure = drawing.new_figure(9.4, 4.7 + 0.19 * len(loops))
    grid = figure.add_gridspec(2, 2)
    gain, nyquist = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[:, 1])
    phase = figure.add_subplot(grid[1, 0], sharex=gain)
    for index, (name, loop) in enumerate(loops.items()):
        look, margins = drawing.style(index), loop.margins
        response = loop.response(w)
        angle = np.rad2deg(np.unwrap(np.angle(response)))
        angle -= 360.0 * np.round((angle[0] + 270.0) / 360.0)  # three integrators
        gain.loglog(w, np.abs(response), label=f"{name}: {margins_text(margins)}", **look)
        phase.semilogx(w, np.where(angle >= _LOWEST, angle, np.nan), **look)
        nyquist.plot(response.real, response.imag, **look)
        if margins is None:
            continue
        at = {**look, "linestyle": "solid", "linewidth": 1.4, "markersize": 7.0}
        phase.plot([margins.gain_crossover] * 2, [-180.0, np.rad2deg(margins.phase) - 180.0], marker="_", **at)
        gain.plot(margins.gain_crossover, 1.0, "o", color=look["color"], markersize=5)
        for factor in (margins.gain_lower, margins.gain_upper):
            if 0.0 < factor < np.inf:
                nyquist.plot(-1.0 / factor, 0.0, "s", fillstyle="none", color=look["color"], zorder=8.0)
        circle = margins.modulus * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 200)) - 1.0
        nyquist.plot(circle.real, circle.imag, color=look["color"], linewidth=0.8, linestyle=":")
    gain.axhline(1.0, color="#000000", linewidth=0.8)
    phase.axhline(-180.0, color="#000000", linewidth=0.8)
    phase.set_yticks(np.arange(_LOWEST, 1.0, 90.0))
    lowest = min(float(np.nanmin(line.get_ydata())) for line in phase.get_lines())
    phase.set_ylim(max(_LOWEST, lowest - 15.0), -45.0)
    nyquist.plot(-1.0, 0.0, "k+", markersize=9)
    gain.set(ylabel="|L|, 1", title="loop transfer function L, cut at v")
    phase.set(xlabel="frequency, rad/s", ylabel="phase of L, degrees")
    nyquist.set(
        xlim=(-4.2, 1.0),
        ylim=(-3.0, 3.0),
        xlabel="Re L, 1",
        ylabel="Im L, 1",
        title="Nyquist plot, positive frequencies",
    )
    nyquist.set_aspect("equal")
    figure.legend(loc="outside lower center", frameon=False)
    return figure


def margins_text(margins: Margins | ResponseMargins | None) -> str:
    """Margins of a loop in a line of a legend."""
    if margins is None:
        return "unstable"
    upper = f" to {margins.gain_upper:.3g}" if np.isfinite(margins.gain_upper) else " and more"
    return (
        f"phase margin {np.rad2deg(margins.phase):.3g}° at {margins.gain_crossover:.3g} rad/s, "
        f"gain times {margins.gain_lower:.3g}{upper}, Ms = {1.0 / margins.modulus:.3g}"
    )


def gang_of_four_figure(loops: Loops) -> Figure:
    """T, P S, C S and S of one chain over frequency."""
    figure = drawing.new_figure(9.0, 5.4)
    grid = figure.subplots(2, 2, sharex=True)
    w = loop_frequencies(loops)
    labels = (("T, 1", "P S, s³"), ("C S, 1/s³", "S, 1"))
    for index, (name, loop) in enumerate(loops.items()):
        four = gang_of_four(loop.gain, omega=w)
        for row in (0, 1):
            for column in (0, 1):
                grid[row, column].loglog(w, four.magnitude[row, column], label=name, **drawing.style(index))
    for row in (0, 1):
        for column in (0, 1):
            grid[row, column].set_ylabel(labels[row][column])
            grid[1, column].set_xlabel("frequency, rad/s")
    grid[0, 0].set_title("position to position measurement error")
    grid[0, 1].set_title("position to addition to v")
    grid[1, 0].set_title("v to position measurement error")
    grid[1, 1].set_title("sensitivity at v")
    grid[1, 1].legend()
    return figure


def step_response_figure(loops: Loops) -> Figure:
    """Position after a step of its set point."""
    figure = drawing.new_figure(6.4, 3.4)
    axes = figure.subplots()
    slowest = min(float(np.min(-loop.poles.real)) for loop in loops.values())
    time = np.linspace(0.0, 8.0 / slowest, 1500)
    for index, (name, loop) in enumerate(loops.items()):
        response = control.step_response(set_point_transfer(loop.gain), time)
        step = loop.step or {}
        label = f"{name}: overshoot {step['Overshoot']:.3g} %, settles in {step['SettlingTime']:.3g} s"
        axes.plot(time, response.outputs, label=label, **drawing.style(index))
    axes.axhline(1.0, color="#000000", linewidth=0.8)
    axes.set(xlabel="time, s", ylabel="position / set point, 1", title="step of the position set point")
    axes.legend(loc="lower right")
    return figure


def loop_frequencies(loops: Loops) -> Frequencies:
    """Frequencies (rad/s) that show what the poles of loops do."""
    sizes = np.concatenate([np.abs(loop.poles) for loop in loops.values()])
    return np.geomspace(0.02 * sizes.min(), 50.0 * sizes.max(), 800)
