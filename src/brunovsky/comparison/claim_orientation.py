"""The claim of the paper about the initial orientation, held against pairs of runs and maps over the heading."""

from __future__ import annotations

from statistics import median

import numpy as np

from brunovsky.comparison.claim import Case, Finding, Verdict
from brunovsky.comparison.facts import joined, number, percent
from brunovsky.comparison.findings_steady import HARDLY
from brunovsky.comparison.protocols import Map
from brunovsky.comparison.protocols.evaluation import phrase, unit
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import both, converged, settled, told

GREAT = 2.0  # factor between two headings from which its influence is said to be great
_KEY = "theta_start_rad"
_METRICS = ("peak_yaw_acceleration", "min_speed_moving", "settling_time", "iae")


def orientation(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """On what another initial heading has a great influence, from maps over it and from runs that differ in it alone.

    A number that the step decides speaks for nothing: it is told, and the claim rests on the others.
    """
    great: list[str] = []
    small: list[str] = []
    parts = _maps(comparison, great, small)
    marked = 0
    pair = _pair(comparison, cases)
    if pair is not None:
        text, marked = _turned(*pair, great, small)
        parts.append(text)
    if not parts:
        return None
    shown = " ".join(parts)
    if not great and not small:
        return Finding("not examined", f"{shown} All that speaks to it is marked: the step decides on it.")
    mixed = [name for name in dict.fromkeys(great) if name in small]
    sure = [name for name in dict.fromkeys(great) if name not in mixed]
    rest = [name for name in dict.fromkeys(small) if name not in mixed]
    if not great:
        return Finding("contradicted", f"{shown} The influence is great (a factor of {number(GREAT, 2)}) on nothing.")
    words = f"The influence is great (a factor of {number(GREAT, 2)} or more)"
    words += f" on {_list(sure)}" if sure else ""
    words += f"{', and' if sure else ''} in some of these on {_list(mixed)}" if mixed else ""
    words += f", not on {_list(rest)}" if rest else ""
    verdict: Verdict = "confirmed" if not small and not marked else "confirmed under conditions"
    return Finding(verdict, f"{shown} {words}.")


def _list(names: list[str]) -> str:
    return joined([f"the {phrase(name)}" for name in names])


def _maps(comparison: Comparison, great: list[str], small: list[str]) -> list[str]:
    """What the heading alone changes on each map, under the first of the paper's laws that the map has."""
    family = [law.name for law in comparison.study.laws if law.in_family]
    told_ = []
    for protocol in comparison.protocols:
        result = protocol.result
        if not isinstance(result, Map):
            continue
        keys = [axis.key for axis in (result.across, result.up) if axis is not None]
        law = next((one for one in family if one in result.laws), None)
        if _KEY not in keys or law is None:
            continue
        by_metric = {one: _factors(result, law, one, across=keys[0] == _KEY) for one in result.metrics}
        known = {name: factors for name, factors in by_metric.items() if factors}
        for name, factors in known.items():
            (great if median(factors) >= GREAT else small).append(name)
        if known:
            title = comparison.study.scenario(protocol.table.scenario).title
            listed = joined([f"the {phrase(name)} {_by(factors)}" for name, factors in known.items()])
            told_.append(f"Map over {result.keys}, “{title}” (“{law}”): the heading alone changes {listed}.")
    return told_


def _factors(result: Map, law: str, metric: str, *, across: bool) -> list[float]:
    """Largest over least of a metric along the heading, for each value of the other key; what is 0 is left out."""
    values = result.sure(law, metric)
    rows = [row[np.isfinite(row) & (row > 0.0)] for row in (values if across else values.T)]
    return [float(row.max() / row.min()) for row in rows if row.size > 1]


def _by(factors: list[float]) -> str:
    if max(factors) <= 1.0 / (1.0 - HARDLY):
        return f"by {percent(1.0 - 1.0 / max(factors))} of its largest value at most"
    low, high = (number(one, 2) for one in (min(factors), max(factors)))
    return f"by a factor of {low}" + (f" to {high} (median {number(median(factors), 2)})" if low != high else "")


def _pair(comparison: Comparison, cases: list[Case]) -> tuple[Run, Run, str] | None:
    """Two runs under one law that differ in nothing but the heading at the start."""
    for index, (scenario, runs) in enumerate(cases):
        for other, others in cases[index + 1 :]:
            for name, run in runs.items():
                twin = others.get(name)
                if twin is not None and _differ_in_heading(run, twin) and scenario.parameters != other.parameters:
                    return run, twin, name
    return None


def _differ_in_heading(run: Run, twin: Run) -> bool:
    a, b = (
        {name: value for name, value in one.planned.parameters.items() if name != "theta_start"} for one in (run, twin)
    )
    return a == b and run.planned.duration == twin.planned.duration and _same_disturbances(run, twin)


def _same_disturbances(run: Run, twin: Run) -> bool:
    a, b = run.planned, twin.planned
    return (a.inputs, a.signals, a.noise, a.loop) == (b.inputs, b.signals, b.noise, b.loop)


def _turned(run: Run, twin: Run, law: str, great: list[str], small: list[str]) -> tuple[str, int]:
    """What another heading changes between two runs, and how many of the numbers the step decides."""
    parts, marked = [], 0
    for name in _METRICS:
        if None in (both(run, name)[0], both(twin, name)[0]):
            continue
        size = f"\u00a0{unit(name)}" if unit(name) else ""
        parts.append(f"the {phrase(name)} is {told(twin, name)} instead of {told(run, name)}{size}")
        low, high = sorted(both(one, name)[0] or 0.0 for one in (run, twin))
        if not (converged(run, name) and converged(twin, name)):
            marked += 1
        elif name != "settling_time" or (settled(run) and settled(twin)):
            (great if high >= GREAT * low and high > 0.0 else small).append(name)
    starts = [number(one.planned.parameters["theta_start"]) for one in (twin, run)]
    return f"From {starts[0]} rad instead of {starts[1]} rad (“{law}”) {joined(parts)}.", marked
