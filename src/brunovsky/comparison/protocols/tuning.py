"""Tuning one knob of a law until a metric has a given value."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.optimize import brentq

from brunovsky.comparison.facts import given, number
from brunovsky.comparison.protocols.evaluation import Evaluate, Trial, attempt, check_range, phrase
from brunovsky.comparison.symbols import key_value, setting, symbol

TuningStatus = Literal["tuned", "out of range", "ambiguous", "jumps", "failed", "budget"]
_SHARE = 0.25  # of the tolerance, at which the search ends
_NEAR = 1e-5  # relative change of the knob within which a metric that is not at its target is said to jump
_APART = 0.005  # of the logarithm of the effort, from which two runs give a slope
_SMALLEST = 1e-300


@dataclass(frozen=True)
class Knob:
    """What is tuned about a law.

    Attributes
    ----------
    parameter : str
        Name as the evaluation takes it: a parameter of the law, or a scaling that the evaluation understands.
    low, high : float
        Range, 0 < low < high; the search goes over the logarithm.
    """

    parameter: str
    low: float
    high: float

    def __post_init__(self) -> None:
        check_range("Knob", self.parameter, self.low, self.high)


@dataclass(frozen=True)
class Tuning:
    """How a law was tuned.

    Attributes
    ----------
    law : str
        Name of the law.
    knob : Knob
        What was tuned.
    status : str
        ``"tuned"``, or why not: ``"out of range"``, ``"ambiguous"`` (the metric passes the target more than once),
        ``"jumps"`` (past the target), ``"failed"`` (runs failed where it was looked for), ``"budget"`` (spent).
    value : float or None
        Knob at the target.
    trial : Trial or None
        The run there.
    monotone : bool
        Whether the metric was monotone in the knob, as far as was seen.
    trials : tuple of Trial
        All runs, in the order in which they were made.
    reason : str
        Why it was not tuned, in words; empty if it was.
    """

    law: str
    knob: Knob
    status: TuningStatus
    value: float | None
    trial: Trial | None
    monotone: bool
    trials: tuple[Trial, ...]
    reason: str = ""

    @property
    def runs(self) -> int:
        """Evaluations that were taken."""
        return len(self.trials)

    def slack(self, effort: str, metric: str, target: float) -> float:
        """Relative change of a metric that the offset of the effort from its target brings about.

        By the slope to the nearest other run whose effort differs. At most 1, and 1 where it can't be told.
        """
        at = None if self.trial is None else _logarithms(self.trial, effort, metric)
        if at is None:
            return 1.0
        offset = abs(at[0] - math.log(target))
        others = [found for found in (_logarithms(one, effort, metric) for one in self.trials) if found is not None]
        far = [one for one in others if abs(one[0] - at[0]) >= max(_APART, offset)]
        if not far:
            return 1.0
        near = min(far, key=lambda one: abs(one[0] - at[0]))
        return min(1.0, offset * abs((near[1] - at[1]) / (near[0] - at[0])))


def _logarithms(trial: Trial, *names: str) -> tuple[float, ...] | None:
    """Logarithms of metrics; None unless all are defined and not zero."""
    values = [trial.value(name) for name in names]
    known = [math.log(abs(one)) for one in values if one is not None and one != 0.0]
    return tuple(known) if len(known) == len(names) else None


class _Stopped(Exception):
    """The search can't go on."""

    def __init__(self, status: TuningStatus, reason: str) -> None:
        super().__init__(reason)
        self.status, self.reason = status, reason


def tune(
    evaluate: Evaluate,
    law: str,
    fixed: Mapping[str, float],
    knob: Knob,
    metric: str,
    target: float,
    *,
    rtol: float,
    budget: int,
    scan: int,
    case: int,
) -> Tuning:
    """Scan the knob's range, then close in on the one place where the metric passes the target.

    Parameters
    ----------
    evaluate, law, fixed, knob, metric, target, rtol, budget, scan, case
        As in :func:`~brunovsky.comparison.protocols.equal_effort`.
    """
    trials: list[Trial] = []

    def run(logarithm: float) -> tuple[Trial, float | None]:
        """A trial, and the logarithm of metric over target."""
        if len(trials) >= budget:
            raise _Stopped("budget", f"the budget of {budget} runs is spent before {phrase(metric)} is at its target")
        trial = attempt(evaluate, law, {**fixed, knob.parameter: math.exp(logarithm)}, case)
        trials.append(trial)
        found = trial.value(metric)
        return trial, None if found is None else math.log(max(abs(found), _SMALLEST) / target)

    def distance(logarithm: float) -> float:
        trial, found = run(logarithm)
        if found is None:
            reason = trial.failure.reason if trial.failure else f"it has no {phrase(metric)}"
            where = setting(knob.parameter, trial.parameters[knob.parameter])
            raise _Stopped("failed", f"the run at {where} failed: {reason.rstrip('.')}")
        return 0.0 if abs(found) <= close else found

    close = _SHARE * math.log1p(rtol)
    grid = [float(one) for one in np.linspace(math.log(knob.low), math.log(knob.high), scan)]
    points = [(x, run(x)[1]) for x in grid]
    known = [one for _, one in points if one is not None]
    steady = _monotone(known)
    try:
        low, high = _bracket(points, trials, knob, metric, target, close)
        root = float(brentq(distance, low, high, xtol=_NEAR, rtol=1e-13)) if low < high else low
    except _Stopped as stopped:
        return Tuning(law, knob, stopped.status, None, None, steady, tuple(trials), stopped.reason)
    best = min(
        (one for one in trials if one.value(metric) is not None),
        key=lambda one: abs(math.log(one.parameters[knob.parameter]) - root),
    )
    if abs((best.value(metric) or 0.0) / target - 1.0) > rtol:
        reason = (
            f"{phrase(metric)} jumps past its target {number(target)} at "
            f"{setting(knob.parameter, math.exp(root), number)}"
        )
        return Tuning(law, knob, "jumps", None, None, steady, tuple(trials), reason)
    return Tuning(law, knob, "tuned", best.parameters[knob.parameter], best, steady, tuple(trials))


def _bracket(
    points: list[tuple[float, float | None]], trials: list[Trial], knob: Knob, metric: str, target: float, close: float
) -> tuple[float, float]:
    """Ends of the only interval of the scan in which the metric passes the target; twice the point that hits it."""
    known = [(x, y) for x, y in points if y is not None]
    span = f"{symbol(knob.parameter)} from {given(knob.low)} to {key_value(knob.high, knob.parameter)}"
    if not known:
        reason = trials[0].failure.reason if trials[0].failure else f"there is no {phrase(metric)}"
        raise _Stopped("failed", f"no run over {span} gives its {phrase(metric)}: {reason.rstrip('.')}")
    hits = [x for x, y in known if abs(y) <= close]
    passes = [(a, b) for (a, ya), (b, yb) in itertools.pairwise(known) if ya * yb < 0.0 and not {a, b} & set(hits)]
    if len(hits) + len(passes) > 1:
        raise _Stopped(
            "ambiguous",
            f"{phrase(metric)} is not monotone over {span} and meets its target {number(target)} in "
            f"{len(hits) + len(passes)} places, so that no one tuning is the one of equal effort",
        )
    if hits:
        return hits[0], hits[0]
    if passes:
        return passes[0]
    lowest, highest = (number(target * math.exp(edge([y for _, y in known]))) for edge in (min, max))
    missing = "" if len(known) == len(points) else f", where {len(points) - len(known)} of {len(points)} runs failed"
    raise _Stopped(
        "out of range",
        f"its {phrase(metric)} lies between {lowest} and {highest} over {span}{missing}, and the target is "
        f"{number(target)}",
    )


def _monotone(values: list[float]) -> bool:
    steps = [b - a for a, b in itertools.pairwise(values)]
    return all(one >= 0.0 for one in steps) or all(one <= 0.0 for one in steps)
