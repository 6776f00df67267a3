"""Linear loops of a study: poles, and Bode and Nyquist plots of the loop cut at v."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from brunovsky.comparison import drawing
from brunovsky.comparison.analyze_loop_figures import Frequencies, loop_figure, loop_frequencies
from brunovsky.comparison.analyzed_loops import analyzed_laws, loops_by_name
from brunovsky.comparison.chain_hardware import ChainHardware
from brunovsky.comparison.loop_curves import LoopCurve, loop_curves
from brunovsky.comparison.study import Study


def bode_figures(study: Study) -> tuple[Figure, ...]:
    """Bode and Nyquist plots of the linear loops of a study, cut at v, with the hardware of its scenarios.

    One figure of all loops where the hardware is the same everywhere, else one for each loop, with a curve for each
    hardware.
    """
    found = loop_curves(study)
    if not found:
        return ()
    kinds = list(dict.fromkeys(hardware for curves in found.values() for hardware in curves))
    if len(kinds) == 1:
        suffix = "" if kinds == [ChainHardware().text] else f", {kinds[0]}"
        groups = [{f"{name}{suffix}": curves[kinds[0]] for name, curves in found.items()}]
    else:
        groups = [{f"{name}, {hardware}": one for hardware, one in curves.items()} for name, curves in found.items()]
    w = loop_frequencies({name: loop for name, loop in loops_by_name(analyzed_laws(study)).items() if name in found})
    return tuple(_bode_figure(group, w) for group in groups if group)


def _bode_figure(curves: Mapping[str, LoopCurve], w: Frequencies) -> Figure:
    figure = loop_figure(curves, w)
    drawing.plain_decades(figure)
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
