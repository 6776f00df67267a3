"""Figures of the chatter grids of an analysis."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from brunovsky.analysis import ChatterRow, SwitchingLoop, describing_function_plot, relay_locus_plot
from brunovsky.comparison import drawing
from brunovsky.comparison.facts import given
from brunovsky.comparison.study.chatter_grid import ChatterGrid

if TYPE_CHECKING:
    from brunovsky.comparison.analyze import Analysis

_QUANTITIES = (("amplitude", "amplitude of S, m/s²"), ("frequency_rad_s", "frequency, rad/s"))
_LINES: dict[str, dict[str, Any]] = {
    "predicted": {"linestyle": "solid", "linewidth": 1.1},
    "locus": {"linestyle": (0, (4, 2.5)), "linewidth": 2.2},
    "simulated": {"linestyle": "none", "markersize": 6.0},
}
_TITLES = {"predicted": "describing function", "locus": "relay locus", "simulated": "simulated"}
_DECADE = 8.0  # range of an axis from which it is logarithmic
_MARKERS = ("o", "s", "^", "D", "v", "P")


def chatter_figures(analysis: Analysis) -> dict[str, Callable[[], Figure]]:
    """What draws predicted against simulated chatter of each grid, and both predictions for one loop, by name."""
    figures: dict[str, Callable[[], Figure]] = {}
    shown = _example(analysis)
    if shown is not None:
        figures["describing-function"] = partial(_prediction, shown, describing_function_plot)
        figures["relay-locus"] = partial(_prediction, shown, relay_locus_plot)
    for number, (grid, rows) in enumerate(analysis.grids, 1):
        if any(len(curve) > 1 for curve in curves(rows).values()):
            figures[f"chatter-{number}"] = partial(_grid, grid, rows)
    return figures


def dead_time(row: ChatterRow) -> float:
    """Sum of lags, delay and sampling period of a row, s."""
    return sum(row.lag_s) + row.delay_s + (row.sampling_s or 0.0)


def _example(analysis: Analysis) -> SwitchingLoop | None:
    """The first loop whose chatter both methods predict, which is a continuous relay."""
    for grid, rows in analysis.grids:
        for loop, row in zip(grid.loops, rows, strict=True):
            if row.predicted_amplitude is not None and row.locus_amplitude is not None and row.sampling_s is None:
                return loop
    return None


def curves(rows: Sequence[ChatterRow]) -> dict[tuple[Any, ...], list[ChatterRow]]:
    """Rows that differ in their lags alone and oscillate, by everything else."""
    found: dict[tuple[Any, ...], list[ChatterRow]] = {}
    for row in rows:
        if row.simulated_amplitude is not None or row.predicted_amplitude is not None:
            found.setdefault((row.C, row.Q, row.P, row.phi, row.delay_s, row.sampling_s), []).append(row)
    return found


def _prediction(loop: SwitchingLoop, draw: Callable[..., Any]) -> Figure:
    figure = drawing.new_figure(6.4, 4.6)
    axes = figure.subplots()
    draw(loop, ax=axes)
    C = ", ".join(map(given, loop.surface))
    lags = ", ".join(f"{1e3 * lag:.4g}" for lag in loop.lags) or "none"
    axes.set_title(
        f"{axes.get_title()}: C = [{C}], Q = {given(loop.reaching_rate)}, P = {given(loop.switching_gain)},\n"
        f"lags {lags} ms, delay {1e3 * loop.delay:.4g} ms"
    )
    axes.set(xlabel="real part, m/s²", ylabel="imaginary part, m/s²")
    return figure


def _grid(grid: ChatterGrid, rows: Sequence[ChatterRow]) -> Figure:
    """Amplitude and frequency over the sum of the lags; filled where the linear part is unstable."""
    figure = drawing.new_figure(9.2, 3.8)
    found = curves(rows)
    axes = figure.subplots(1, 2)
    for place, (quantity, label) in zip(axes, _QUANTITIES, strict=True):
        for index, curve in enumerate(found.values()):
            _curve(place, curve, quantity, index)
        place.set(xlabel="sum of lags, delay and sampling period, ms", ylabel=label)
        drawn = [y for line in place.get_lines() for y in line.get_ydata()]
        if max(drawn) > _DECADE * min(drawn):
            place.set_yscale("log")
    handles = [Line2D([], [], color="#5c666e", label=_TITLES[key], **_LINES[key]) for key in ("predicted", "locus")]
    handles += [
        Line2D(
            [],
            [],
            color=drawing.marker_color(k),
            marker=_MARKERS[k % 6],
            fillstyle="none",
            linestyle="none",
            label=f"simulated{name}",
        )
        for k, name in enumerate(_names(list(found)))
    ]
    if any(not row.linear_part_stable for row in rows):
        handles.append(Line2D([], [], color="#0b3c6f", marker="o", linestyle="none", label="… linear part unstable"))
    figure.legend(handles=handles, loc="outside right upper", frameon=False)
    figure.suptitle(grid.title, fontsize=9.5)
    return figure


def _curve(place: Any, curve: Sequence[ChatterRow], quantity: str, index: int) -> None:
    curve = sorted(curve, key=dead_time)
    for source, look in _LINES.items():
        points = [(1e3 * dead_time(row), getattr(row, f"{source}_{quantity}"), row.linear_part_stable) for row in curve]
        known = [one for one in points if one[1] is not None]
        if source != "simulated":
            place.plot([x for x, _, _ in known], [y for _, y, _ in known], color=drawing.marker_color(index), **look)
            continue
        for filled in (False, True):
            some = [(x, y) for x, y, stable in known if stable is not filled]
            style = {"marker": _MARKERS[index % 6], "fillstyle": "full" if filled else "none"}
            place.plot([x for x, _ in some], [y for _, y in some], color=drawing.marker_color(index), **style, **look)


def _names(keys: Sequence[tuple[Any, ...]]) -> list[str]:
    """What tells the curves of a grid apart: the numbers that differ."""
    labels = ("C", "Q", "P", "φ", "delay", "sampling")
    differing = [k for k in range(len(labels)) if len({key[k] for key in keys}) > 1]
    return ["".join(f", {labels[k]} = {_told(labels[k], key[k])}" for k in differing) for key in keys]


def _told(label: str, value: Any) -> str:
    if value is None:
        return "none"
    if isinstance(value, tuple):
        return f"[{', '.join(map(given, value))}]"
    return f"{given(1e3 * value)} ms" if label in ("delay", "sampling") else given(value)
