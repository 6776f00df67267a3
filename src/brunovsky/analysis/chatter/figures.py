"""Figures of the chatter prediction, as python-control draws its own."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import control
import matplotlib.pyplot as plt
import numpy as np

from brunovsky.analysis.chatter.limit_cycles import LimitCycle, crossing_level, harmonic_balance, predicted_cycles
from brunovsky.analysis.chatter.relay_locus import relay_cycles, relay_locus
from brunovsky.analysis.chatter.switching_loop import SwitchingLoop


def describing_function_plot(loop: SwitchingLoop, ax: Any = None) -> control.ControlPlot:
    """Nyquist plot of the linear part W(j w) with -1/N(a) and their intersections.

    Parameters
    ----------
    loop : SwitchingLoop
        With P > 0.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    control.ControlPlot
        Of `control.describing_function_plot`; the legend gives amplitude and frequency of each intersection.

    Raises
    ------
    ParameterError
        If P is zero.

    References
    ----------
    See `harmonic_balance`.
    """
    place = ax if ax is not None else plt.figure().add_subplot()
    drawn = control.describing_function_plot(
        harmonic_balance(loop), ax=place, title="", point_label=None, max_curve_magnitude=np.inf, mirror_style=False
    )
    place.set_title("Linear part W(jω) and −1/N(a)")
    _mark(place, predicted_cycles(loop), loop.frequency_response)
    return drawn


def relay_locus_plot(loop: SwitchingLoop, ax: Any = None) -> control.ControlPlot:
    """Tsypkin's locus beside W(j w), with the level at which the relay switches and the exact limit cycles.

    Parameters
    ----------
    loop : SwitchingLoop
        A continuous one with P > 0 and no boundary layer.
    ax : matplotlib.axes.Axes, optional
        Where to draw; a new figure by default.

    Returns
    -------
    control.ControlPlot
        Its lines are the locus, W, the level at which the relay switches, and the limit cycles; the legend gives
        amplitude and frequency of each.

    Raises
    ------
    ParameterError
        As `relay_locus`.

    References
    ----------
    See `relay_locus`.
    """
    place = ax if ax is not None else plt.figure().add_subplot()
    cycles = relay_cycles(loop)
    w = loop.frequencies(2000)
    if cycles:  # far below them the locus winds around without a meaning
        w = w[w > 0.3 * min(one.frequency for one in cycles)]
    locus, curve = relay_locus(loop, w, 256), loop.frequency_response(w)
    lines = [
        *place.plot(locus.real, locus.imag, label="relay locus"),
        *place.plot(curve.real, curve.imag, "--", label="W(jω)"),
        *place.plot([-np.max(np.abs(curve)), 0.0], [crossing_level(loop)] * 2, color="grey", label="relay switches"),
    ]
    place.set(xlabel="Real axis", ylabel="Imaginary axis", title="Relay locus and W(jω)")
    lines += _mark(place, cycles, lambda frequency: relay_locus(loop, [frequency])[0])
    return control.ControlPlot(np.array(lines, dtype=object), np.array([[place]], dtype=object), place.get_figure())


def _mark(ax: Any, cycles: tuple[LimitCycle, ...], place: Callable[[float], Any]) -> list[Any]:
    """Mark the limit cycles, the stable ones filled, and show their surroundings."""
    lines: list[Any] = []
    points = [complex(place(one.frequency)) for one in cycles]
    for cycle, at in zip(cycles, points, strict=True):
        word, style = ("stable", "full") if cycle.stable else ("unstable", "none")
        label = f"{word}: {cycle.amplitude:.3g} @ {cycle.frequency:.4g} rad/s"
        lines += ax.plot(at.real, at.imag, "o", color="k", fillstyle=style, label=label)
    if points:
        reach = 2.0 * max(abs(one) for one in points)
        ax.set(xlim=(-reach, 0.5 * reach), ylim=(-0.5 * reach, 0.5 * reach))
    ax.legend()
    return lines
