"""Tables of a report: metrics, conditions, poles and margins as text."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from brunovsky.analysis import disk_margin, loop_transfer
from brunovsky.comparison.condition_words import what_acts
from brunovsky.comparison.definitions import METRIC_DEFINITIONS, Definition
from brunovsky.comparison.facts import CONVERGED, given, joined, number, percent
from brunovsky.comparison.linear_part import LinearLoop
from brunovsky.comparison.run import Run
from brunovsky.comparison.sensitivity import MARK, both, converged, is_tiny, sensitivity, told

MARGIN_ROWS = (
    ("gain_lower", "lower gain margin (factor)", 1.0),
    ("gain_upper", "upper gain margin (factor)", 1.0),
    ("phase", "phase margin, degrees", 180.0 / math.pi),
    ("gain_crossover", "gain crossover, rad/s", 1.0),
    ("modulus", "modulus margin", 1.0),
    ("max_sensitivity", "Ms", 1.0),
    ("disk_margin", "disk margin", 1.0),
    ("delay", "longest delay, ms", 1e3),
    ("lag", "longest first-order lag, ms", 1e3),
    ("two_lags", "two equal lags, each at most, ms", 1e3),
)
_NOTHING, _MANIFOLD = 0.9, 10.0  # relative changes beyond which both numbers are told


def told_metrics(names: Sequence[str] = ()) -> tuple[Definition, ...]:
    """Definitions of metrics of these names, of all without any, in their fixed order."""
    return tuple(one for one in METRIC_DEFINITIONS if not names or one.name in names)


def metric_rows(runs: list[Run], names: Sequence[str] = ()) -> list[tuple[str, str, list[str]]]:
    """Label, unit and one cell for each run; the first row is how the runs ended."""
    status = ("status", "", [_status(run) for run in runs])
    return [
        status,
        *((one.title, one.unit, [metric_cell(run, one.name) for run in runs]) for one in told_metrics(names)),
    ]


def _status(run: Run) -> str:
    return "ok" if run.ok else f"{run.status.state} at {number(run.status.time)} s"


def metric_cell(run: Run, name: str, digits: int = 4) -> str:
    """A metric of a run for a table, marked where the step decides on it."""
    value = both(run, name)[0]
    if value is None:
        return "never" if run.ok and name.startswith("settling") else "–"
    if name.startswith("settling"):
        return f"{'' if converged(run, name) else MARK}{value:.3f}"
    return told(run, name, digits)


def footnote(runs: list[Run], names: Sequence[str] = ()) -> str:
    """Which numbers of a table are marked, and by how much they change at half the step; empty if none is.

    Parameters
    ----------
    runs : list of Run
        Columns of the table.
    names : sequence of str, optional
        Metrics that it tells; by default all.
    """
    parts = []
    for one in told_metrics(names):
        marked = [run for run in runs if both(run, one.name)[0] is not None and not converged(run, one.name)]
        if marked:
            changes = [f"{_change(run, one)} ({run.planned.law})" for run in marked]
            parts.append(f"{one.phrase} {joined(changes)}")
    if not parts:
        return ""
    return (
        f"{MARK.strip()} changes by more than {100 * CONVERGED:g} % at half the step: {'; '.join(parts)}. Such a "
        "number is a property of the step too, not of the law alone, and ranks no law."
    )


def _change(run: Run, one: Definition) -> str:
    """By how much a metric changes at half the step; from what to what where a share of its base says nothing."""
    value, half = both(run, one.name)
    share = sensitivity(run, one.name)
    if half is None:
        return "to none"
    if is_tiny(run, one.name) or share is None or not -_NOTHING < share < _MANIFOLD:
        unit = "" if one.unit == "1" else f"\u00a0{one.unit}"
        return f"from {number(value, 2)} to {number(half, 2)}{unit}"
    return f"by {percent(share)}"


def conditions(run: Run) -> str:
    """Duration, start, reference, disturbances and uncertainty of a run, in a sentence."""
    p = run.planned.parameters
    where = f"({given(p['x_start'])} m, {given(p['y_start'])} m, {given(p['theta_start'])} rad)"
    text = f"{given(run.planned.duration)} s from (x, y, θ) = {where} with η₁ = {given(p['eta_start[1]'])} m/s"
    others = {"η₂": ("eta_start[2]", "rad/s"), "u₁": ("u_start[1]", "m/s²")}
    text += "".join(f", {name} = {given(p[key])} {unit}" for name, (key, unit) in others.items() if p.get(key))
    if run.planned.target is not None:
        text += f" to rest at ({given(run.planned.target[0])} m, {given(run.planned.target[1])} m)"
        heading = run.planned.goal_heading
        text += "" if heading is None else f" with heading {given(heading)} rad"
    else:
        center = f"({given(p['center[1]'])} m, {given(p['center[2]'])} m)"
        text += f", along a circle of radius {given(p['radius'])} m about {center} at {given(p['rate'])} rad/s"
    extra = what_acts(run.planned)
    return f"{text}; {', '.join(extra)}." if extra else f"{text}."


def loop_row(loop: LinearLoop) -> dict[str, str]:
    """Title, gain and poles of a linear loop."""
    return {
        "title": loop.title,
        "gain": ", ".join(given(float(one)) for one in loop.gain),
        "poles": poles_text(loop.poles),
    }


def margin_rows(loops: list[LinearLoop]) -> list[tuple[str, list[str]]]:
    """Label and one cell for each loop."""
    return [
        (label, ["unstable" if one.margins is None else _margin(one, name, scale) for one in loops])
        for name, label, scale in MARGIN_ROWS
    ]


def _margin(one: LinearLoop, name: str, scale: float) -> str:
    found = disk_margin(loop_transfer(one.gain)).radius if name == "disk_margin" else getattr(one.margins, name)
    return number(scale * found, 4)


def poles_text(poles: Any) -> str:
    """Poles as text, conjugate pairs as one."""
    told = []
    for one in poles:
        if abs(one.imag) < 1e-9 * abs(one):
            told.append(given(float(one.real)))
        elif one.imag > 0.0:
            told.append(f"{given(float(one.real))} ± {given(float(one.imag))}j")
    return ", ".join(told)
