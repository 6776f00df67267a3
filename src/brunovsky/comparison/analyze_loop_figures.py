"""Figures of the linear loops of an analysis: Bode, Nyquist, gang of four, step response."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import control
import numpy as np
from matplotlib.figure import Figure

from brunovsky.analysis import gang_of_four, loop_transfer, set_point_transfer
from brunovsky.comparison import drawing
from brunovsky.comparison.analyzed_loops import AnalyzedLoop

Loops = Mapping[str, AnalyzedLoop]


def loop_figure(loops: Loops) -> Figure:
    """Bode plot of the loop at v with its margins, and its Nyquist plot with the circle of the modulus margin."""
    figure = drawing.new_figure(9.4, 5.0)
    grid = figure.add_gridspec(2, 2)
    gain, nyquist = figure.add_subplot(grid[0, 0]), figure.add_subplot(grid[:, 1])
    phase = figure.add_subplot(grid[1, 0], sharex=gain)
    w = _frequencies(loops)
    for index, (name, loop) in enumerate(loops.items()):
        look, margins = drawing.style(index), loop.margins
        response = loop_transfer(loop.gain)(1j * w)
        angle = np.rad2deg(np.unwrap(np.angle(response)))
        angle -= 360.0 * np.round((angle[-1] + 90.0) / 360.0)  # three integrators and two zeros: -90 degrees at the end
        assert margins is not None
        gain.loglog(w, np.abs(response), label=name, **look)
        phase.semilogx(
            w, angle, label=f"margin {np.rad2deg(margins.phase):.3g}° at {margins.gain_crossover:.3g} rad/s", **look
        )
        nyquist.plot(response.real, response.imag, label=name, **look)
        crossing = np.rad2deg(margins.phase) - 180.0
        phase.plot(
            [margins.gain_crossover] * 2,
            [-180.0, crossing],
            marker="_",
            markersize=7,
            **{**look, "linestyle": "solid", "linewidth": 1.4},
        )
        gain.plot(margins.gain_crossover, 1.0, "o", color=look["color"], markersize=5)
        if margins.gain_lower > 0.0:
            place = -1.0 / margins.gain_lower
            nyquist.plot(
                place,
                0.0,
                "s",
                fillstyle="none",
                color=look["color"],
                label=f"lower gain margin {margins.gain_lower:.3g}",
            )
        circle = margins.modulus * np.exp(1j * np.linspace(0.0, 2.0 * np.pi, 200)) - 1.0
        nyquist.plot(
            circle.real,
            circle.imag,
            color=look["color"],
            linewidth=0.8,
            linestyle=":",
            label=f"Ms = {margins.max_sensitivity:.3g}",
        )
    gain.axhline(1.0, color="#000000", linewidth=0.8)
    phase.axhline(-180.0, color="#000000", linewidth=0.8)
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
    gain.legend()
    phase.legend()
    nyquist.legend(loc="upper left")
    return figure


def gang_of_four_figure(loops: Loops) -> Figure:
    """T, P S, C S and S of one chain over frequency."""
    figure = drawing.new_figure(9.0, 5.4)
    grid = figure.subplots(2, 2, sharex=True)
    w = _frequencies(loops)
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


def _frequencies(loops: Loops) -> np.ndarray[Any, np.dtype[np.float64]]:
    sizes = np.concatenate([np.abs(loop.poles) for loop in loops.values()])
    return np.geomspace(0.02 * sizes.min(), 50.0 * sizes.max(), 800)
