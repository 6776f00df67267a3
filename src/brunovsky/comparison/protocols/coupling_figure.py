"""Figure of coupling errors: over the communication step, a panel for each law."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure

from brunovsky.comparison import drawing
from brunovsky.comparison.protocols.coupling import Coupling, coupling_name
from brunovsky.comparison.protocols.figures import MARKERS, Titles


def coupling_figure(result: Coupling, titles: Titles | None = None) -> Figure:
    """Largest distance over the step, a line for each coupling.

    A tick at the bottom is its predicted limit, a dashed one at the top that within the layer.
    """
    figure = drawing.new_figure(9.4, 4.4)
    panels = np.atleast_1d(figure.subplots(1, len(result.laws), sharey=True))
    for axes, law in zip(panels, result.laws, strict=True):
        for index, key in enumerate(one for one in result.keys if one[0] == law):
            known = [one for one in result.of(key) if one.error <= result.large]
            style = drawing.style(index) | {"marker": MARKERS[index % len(MARKERS)], "markersize": 4.5}
            steps = [1e3 * one.communication_step for one in known]
            axes.plot(steps, [one.error for one in known], label=coupling_name(*key[1:]), **style)
            limit = result.limits.get(key, math.inf)
            if math.isfinite(limit):
                axes.axvline(1e3 * limit, ymax=0.08, color=style["color"], linewidth=2.0)
            within = result.layer_limit(key)
            if within is not None:
                axes.axvline(1e3 * within, ymin=0.92, color=style["color"], linewidth=2.0, linestyle=(0, (1.5, 1)))
        axes.set_xscale("log")
        axes.set_yscale("log")
        axes.set_title((titles or {}).get(law) or law, loc="left")
        axes.set_xlabel("communication step, ms")
    panels[0].set_ylabel("largest distance, m")
    drawing.plain_decades(figure)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=2, frameon=False)
    return figure
