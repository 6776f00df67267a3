"""Figure of measured margins: one panel for each margin, measured beside predicted."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from brunovsky.comparison import drawing
from brunovsky.comparison.protocols.figures import MARKERS, Titles
from brunovsky.comparison.protocols.margin_rows import CUTS, MarginRow
from brunovsky.comparison.protocols.margins import MeasuredLoopMargins


def margins_figure(result: MeasuredLoopMargins, titles: Titles | None = None) -> Figure:
    """One panel for each limited margin: markers measured (open: no margin), bars for P = 0, crosses in layers."""
    quantities = list(dict.fromkeys(one.quantity for one in result.found if _shown(one)))
    cuts = list(dict.fromkeys(one.cut for one in result.found))
    columns = min(max(len(quantities), 1), 3)
    lines = -(-max(len(quantities), 1) // columns)
    figure = drawing.new_figure(9.4, 0.9 + (0.75 + 0.3 * len(cuts) * len(result.laws)) * lines)
    grid = np.atleast_1d(figure.subplots(lines, columns, sharey=True)).ravel()
    places = {(law, cut): k for k, (cut, law) in enumerate((cut, law) for cut in cuts for law in result.laws)}
    for axes, quantity in zip(grid, quantities, strict=False):
        scale = 1.0 if quantity.unit == "1" else 1e3
        for one in (one for one in result.found if one.quantity == quantity):
            place, index = places[one.law, one.cut], result.laws.index(one.law)
            if one.predicted and one.predicted != float("inf"):
                axes.plot([scale * one.predicted] * 2, [place - 0.35, place + 0.35], color="#555555", linewidth=2.2)
            if one.within_layer and one.within_layer != float("inf"):
                axes.plot([scale * one.within_layer], [place], "x", color="#555555", markersize=7.0)
            if one.measured.value is not None:
                look = _point(index) | ({"fillstyle": "none"} if one.bound or one.regained else {})
                axes.plot([scale * one.measured.value], [place], MARKERS[index % len(MARKERS)], **look)
        axes.set_title(quantity.title + ("" if scale == 1.0 else ", ms"), loc="left")
        axes.set_yticks(range(len(places)), [f"{law} {CUTS[cut]}" for law, cut in places])
        axes.set_ylim(len(places) - 0.5, -0.5)
        axes.set_xlim(left=0.0)
        axes.margins(x=0.08)
    for axes in grid[len(quantities) :]:
        axes.set_visible(False)
    handles = [
        Line2D(
            [],
            [],
            linestyle="none",
            marker=MARKERS[k % len(MARKERS)],
            label=(titles or {}).get(law) or law,
            **_point(k),
        )
        for k, law in enumerate(result.laws)
    ]
    handles.append(
        Line2D([], [], linestyle="none", marker="|", markersize=11.0, color="#555555", label="predicted, P = 0")
    )
    if any(one.within_layer for one in result.found):
        handles.append(
            Line2D([], [], linestyle="none", marker="x", color="#555555", label="predicted within the layer")
        )
    open_ = {"limited by the step": any(one.bound for one in result.found)}
    open_["first loss, stands more"] = any(one.regained for one in result.found)
    if any(open_.values()):
        label = f"open: {', or '.join(text for text, there in open_.items() if there)}"
        look = {"marker": MARKERS[0], "fillstyle": "none", "color": "#555555", "label": label}
        handles.append(Line2D([], [], linestyle="none", **look))
    figure.legend(handles=handles, loc="outside upper center", ncols=3, frameon=False)
    return figure


def _shown(one: MarginRow) -> bool:
    numbers = (one.measured.value, one.predicted, one.within_layer)
    return any(value is not None and 0.0 < value < float("inf") for value in numbers)


def _point(index: int) -> dict[str, Any]:
    return {"color": drawing.style(index)["color"], "markersize": 6.5, "zorder": 5.0}
