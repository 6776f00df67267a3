"""Linear loops of a study: poles, and Bode and Nyquist plots of the loop cut at v."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from brunovsky.comparison import drawing
from brunovsky.comparison.analyze_loop_figures import loop_figure
from brunovsky.comparison.analyzed_loops import analyzed_laws, loops_by_name
from brunovsky.comparison.study import Study


def bode_figure(study: Study) -> Figure | None:
    """Bode and Nyquist plots of the stable linear loops of a study, cut at v; None if none is stable."""
    stable = {name: loop for name, loop in loops_by_name(analyzed_laws(study)).items() if loop.stable}
    if not stable:
        return None
    figure = loop_figure(stable)
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
