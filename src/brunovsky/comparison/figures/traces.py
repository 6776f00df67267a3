"""What the figures of a scenario share: which runs, until when, signals over time, and the legend."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from brunovsky.comparison import drawing
from brunovsky.comparison.facts import given, joined
from brunovsky.comparison.metrics import Array, instants, values
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.study import Law, Scenario

Drawn = Sequence[tuple[int, Law, Run]]
POINT: dict[str, Any] = {"linestyle": "none", "color": "#000000", "zorder": 8.0, "clip_on": False}
START = {**POINT, "marker": "o", "markersize": 6.0}
END = {**POINT, "marker": "o", "markersize": 4.5}
# inches: a row of the legend, what is below it with and without titles, each further row of these
_LEGEND_ROW, _TITLE, _MARGIN, _TITLE_ROW = 0.19, 0.39, 0.08, 0.16
_WRITTEN: dict[str, Any] = {"va": "bottom", "fontsize": 7.5, "zorder": 9.0, "clip_on": True}
_WRITTEN["bbox"] = {"facecolor": "#ffffff", "edgecolor": "none", "alpha": 0.85, "pad": 0.8}
_SUBSCRIPT = re.compile(r"\$_\\mathrm\{(\w+)\}\$")
TARGET = {**POINT, "marker": "x", "markersize": 7.0, "markeredgewidth": 1.8}


def drawable(comparison: Comparison, scenario: Scenario) -> list[tuple[int, Law, Run]]:
    """Laws of a scenario with something to draw: index in the study, law and run."""
    index = {law.name: number for number, law in enumerate(comparison.study.laws)}
    pairs = comparison.laws_of(scenario)
    return [(index[law.name], law, run) for law, run in pairs if run.trajectory.sizes["time"] > 0]


def transient_window(comparison: Comparison, scenario: Scenario) -> float:
    """Time up to which signals are shown, s: two and a half times the longest settling time, at least 2 s.

    The whole run where something acts on it that varies.
    """
    if scenario.signals:
        return scenario.duration_s
    settled = [run.metrics.settling_time for _, run in comparison.laws_of(scenario) if run.ok]
    known = [one for one in settled if one is not None]
    if not known or len(known) < len(settled):
        return scenario.duration_s
    return min(scenario.duration_s, max(2.0, float(np.ceil(2.5 * max(known)))))


def shown(run: Run, window: float) -> tuple[Array, np.ndarray[Any, np.dtype[np.bool_]]]:
    """Instants of a run within the window (s), and which of the recorded ones they are."""
    time = instants(run.trajectory)
    inside = time <= window * (1.0 + 1e-9)
    return time[inside], inside


def draw_signal(axes: Axes, laws: Drawn, name: str, window: float) -> None:
    """One recorded variable of all laws over time; a law that does not record it has no line."""
    for index, _, run in laws:
        if name not in run.trajectory:
            continue
        time, inside = shown(run, window)
        time, signal = drawing.thinned(time, values(run.trajectory, name)[inside])
        axes.plot(time, signal, **drawing.style(index), **drawing.marks(index, time.size))
    axes.set_xlim(0.0, window)
    axes.set_xlabel("time, s")


def draw_limits(axes: Axes, limits: Sequence[float], symbol: str, *, vertical: bool = False) -> None:
    """Dotted lines at plus and minus each limit, which is written at the positive one."""
    for limit in sorted(set(limits)):
        for value in (-limit, limit):
            (axes.axvline if vertical else axes.axhline)(value, **drawing.REFERENCE)
        text = f"{symbol} = {given(limit)}"
        if vertical:
            axes.text(limit, 0.02, text, transform=axes.get_xaxis_transform(), rotation=90.0, ha="left", **_WRITTEN)
        else:
            axes.text(0.995, limit, text, transform=axes.get_yaxis_transform(), ha="right", **_WRITTEN)


def linear_parts(figure: Figure) -> str:
    """Up to where each axis is linear that is logarithmic on both sides of zero, in a sentence; empty without one."""
    found: dict[str, list[str]] = {}
    for axes in figure.axes:
        for axis, label in (
            (axes.xaxis, axes.get_xlabel()),
            (axes.yaxis, axes.get_ylabel() or axes.get_title(loc="left")),
        ):
            scale: Any = axis.get_transform()
            if axis.get_scale() == "symlog":
                name, _, unit = _SUBSCRIPT.sub(r"_\1", label).partition(";")[0].rpartition(", ")
                found.setdefault(f"±{given(scale.linthresh)}\u00a0{unit}", []).append(name)
    parts = [f"{value} ({joined(list(dict.fromkeys(names)))})" for value, names in found.items()]
    return f"Linear up to {joined(parts)}, logarithmic beyond." if parts else ""


def layers(laws: Drawn) -> list[float]:
    """Half-widths of the boundary layers, m/s2."""
    return [run.planned.parameters["phi"] for _, law, run in laws if law.kind == "saturation"]


def add_legend(figure: Figure, laws: Sequence[tuple[int, Law]], more: Sequence[Line2D] = ()) -> None:
    """Legend of the laws, above everything."""
    handles = [
        Line2D([], [], label=law.title or law.name, **drawing.style(index), **drawing.marks(index))
        for index, law in laws
    ]
    handles += more
    labels, width = [str(one.get_label()) for one in handles], float(figure.get_figwidth())
    columns = drawing.legend_columns(labels, width, 4 if width > 9.0 else 3)
    _make_room(figure, -(-len(handles) // columns))
    figure.legend(handles=handles, loc="outside upper center", ncols=columns, frameon=False, columnspacing=1.4)


def _make_room(figure: Figure, rows: int) -> None:
    """Let a figure of a fixed layout grow at its top until the rows of a legend fit above its titles."""
    if figure.get_layout_engine() is not None:
        return
    height, sides = float(figure.get_figheight()), figure.subplotpars
    lines = max(len(axes.get_title(loc="left").splitlines()) for axes in figure.axes)
    needed = _LEGEND_ROW * rows + (_TITLE + _TITLE_ROW * (lines - 1) if lines else _MARGIN)
    grown = max(0.0, needed - (1.0 - sides.top) * height)
    if grown > 0.0:
        figure.set_figheight(height + grown)
        figure.subplots_adjust(top=1.0 - needed / (height + grown), bottom=sides.bottom * height / (height + grown))


def place_handles(regulation: set[bool]) -> list[Line2D]:
    """Legend of the points along a path, for scenarios that end at a point, on a trajectory, or both."""
    handles = [Line2D([], [], label="start", markerfacecolor="#ffffff", **START)]
    if True in regulation:
        handles.append(Line2D([], [], label="target", **TARGET))
    if False in regulation:
        handles.append(Line2D([], [], label="end", **END))
        handles.append(Line2D([], [], label="reference", **drawing.REFERENCE))
    return handles
