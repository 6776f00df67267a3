"""Measured over predicted chatter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from matplotlib.figure import Figure

from brunovsky.comparison import drawing

MARKERS = ("o", "s", "D", "^")


class Predicted(Protocol):
    """What is drawn of a prediction."""

    @property
    def source(self) -> str:
        """How it is predicted."""

    @property
    def pairs(self) -> tuple[tuple[float, float] | None, ...]:
        """Predicted and measured frequency (rad/s), and amplitude (m/s2)."""


def predicted_chatter_figure(found: Sequence[Predicted]) -> Figure | None:
    """Frequency and amplitude, measured over predicted; None where no prediction meets a measurement."""
    if not any(pair for one in found for pair in one.pairs):
        return None
    figure = drawing.new_figure(9.4, 4.2)
    sources = list(dict.fromkeys(one.source for one in found if any(one.pairs)))
    panels = figure.subplots(1, 2)
    for k, (axes, title) in enumerate(zip(panels, ("frequency, rad/s", "amplitude of S, m/s²"), strict=True)):
        shown = [value for one in found for value in one.pairs[k] or ()]
        if shown:
            ends = [0.8 * min(shown), 1.25 * max(shown)]
            axes.plot(ends, ends, color="#000000", linewidth=0.9)
            for factor in (0.9, 1.1):
                axes.plot(ends, [factor * one for one in ends], **drawing.REFERENCE)
            axes.set_xscale("log")
            axes.set_yscale("log")
        for index, source in enumerate(sources):
            points = [one.pairs[k] for one in found if one.source == source]
            known = [pair for pair in points if pair is not None]
            axes.plot(
                [pair[0] for pair in known],
                [pair[1] for pair in known],
                linestyle="none",
                marker=MARKERS[index % len(MARKERS)],
                fillstyle="none",
                markersize=6.0 + 2.0 * index,
                color=drawing.marker_color(index),
                label=source,
            )
        axes.set_title(title, loc="left")
        axes.set_xlabel("predicted")
        axes.set_ylabel("measured")
    drawing.plain_decades(figure)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", ncols=4, frameon=False)
    return figure
