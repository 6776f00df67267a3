"""The first protocol: the same linear part, one parameter of the laws swept."""

from __future__ import annotations

import itertools
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from brunovsky.comparison.facts import HARDLY, given, number, percent
from brunovsky.comparison.output import plain
from brunovsky.comparison.protocols.evaluation import (
    Evaluate,
    Trial,
    attempt,
    check_laws,
    failures_told,
    phrase,
    unit,
)
from brunovsky.comparison.protocols.explanation import SWEPT, Explanation
from brunovsky.comparison.symbols import key_value, symbol
from brunovsky.errors import ParameterError


@dataclass(frozen=True)
class Swept:
    """Runs of all laws over the values of one parameter.

    Attributes
    ----------
    knob : str
        The swept parameter.
    values : tuple of float
        Its values, ascending.
    metrics : tuple of str
        Metrics that are told.
    trials : tuple of Trial
        Law by law, value by value.
    step_sensitive : frozenset of str
        Metrics that depend on the step.
    explanation : Explanation
        The protocol in words.
    """

    knob: str
    values: tuple[float, ...]
    metrics: tuple[str, ...]
    trials: tuple[Trial, ...]
    step_sensitive: frozenset[str] = frozenset()
    explanation: Explanation = SWEPT

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws."""
        return tuple(dict.fromkeys(one.law for one in self.trials))

    def curve(self, law: str, metric: str) -> tuple[list[float], list[float]]:
        """Values of the knob and of a metric, where it is defined."""
        pairs = [(one.parameters[self.knob], one.value(metric)) for one in self.trials if one.law == law]
        known = [(x, y) for x, y in pairs if y is not None]
        return [x for x, _ in known], [y for _, y in known]

    def rows(self) -> list[dict[str, Any]]:
        """One row for each run."""
        return [one.row([self.knob], self.metrics) for one in self.trials]

    def as_dict(self) -> dict[str, Any]:
        """The same as plain data, for JSON."""
        found: dict[str, Any] = plain(self)
        return found | {"step_sensitive": sorted(self.step_sensitive), "findings": self.findings()}

    def findings(self) -> list[str]:
        """Sentences that follow from the numbers."""
        told = failures_told(self.trials, self.knob)
        for metric in self.metrics:
            if metric in self.step_sensitive:
                told.append(f"The {phrase(metric)} depends on the step of the simulation: no trend is told of it.")
                continue
            told += [one for one in (self._trend(law, metric) for law in self.laws) if one]
        return told

    def _trend(self, law: str, metric: str) -> str:
        x, y = self.curve(law, metric)
        if len(y) < 2:
            return f"Under “{law}” the {phrase(metric)} is defined for fewer than two values of {symbol(self.knob)}."
        over = f"Under “{law}” the {phrase(metric)}"
        span = f"{given(x[0])} to {key_value(x[-1], self.knob)}"
        size = max(abs(one) for one in y)
        share = 0.0 if size == 0.0 else (max(y) - min(y)) / size
        if share <= HARDLY:
            by = percent(share) if share > 1e-4 else "less than 0.01\u00a0%"
            return f"{over} hardly depends on {symbol(self.knob)} from {span}: it varies by {by} of its largest value."
        span = f"as {symbol(self.knob)} goes from {span}"
        steps = [b - a for a, b in itertools.pairwise(y)]
        ends = f"from {number(y[0])} to {_told(y[-1], metric)}"
        if all(one >= 0.0 for one in steps) or all(one <= 0.0 for one in steps):
            return f"{over} {'rises' if y[-1] > y[0] else 'falls'} {ends} {span}."
        best, worst = y.index(min(y)), y.index(max(y))
        return (
            f"{over} goes {ends} {span}, but not steadily: of the values tried it is least at {given(x[best])} "
            f"({number(y[best])}) and largest at {given(x[worst])} ({number(y[worst])})."
        )


def _told(value: float, metric: str) -> str:
    return f"{number(value)}\u00a0{unit(metric)}" if unit(metric) else number(value)


def swept(
    evaluate: Evaluate,
    laws: Mapping[str, Mapping[str, float]],
    knob: str,
    values: Sequence[float],
    *,
    metrics: Sequence[str],
    case: int = 0,
    step_sensitive: Collection[str] = (),
) -> Swept:
    """Run every law at every value of one parameter, all else as it is.

    Parameters
    ----------
    evaluate : Evaluate
        Makes one run.
    laws : mapping of str to mapping
        For each law the parameters that stay.
    knob : str
        Parameter that is swept, such as the switching gain P.
    values : sequence of float
        Its values; ascending order is made.
    metrics : sequence of str
        Metrics to tell.
    case : int
        Number of the case.
    step_sensitive : collection of str
        Metrics of which no trend may be told.

    Raises
    ------
    ParameterError
        If there is no law, or fewer than two values, or one that is not finite.
    """
    check_laws("swept", laws)
    grid = sorted(set(map(float, values)))
    if len(grid) < 2 or not all(map(math.isfinite, grid)):
        raise ParameterError(f"swept: {knob} over {list(values)}; give at least two finite values that differ")
    trials = [attempt(evaluate, law, {**fixed, knob: value}, case) for law, fixed in laws.items() for value in grid]
    return Swept(knob, tuple(grid), tuple(metrics), tuple(trials), frozenset(step_sensitive))
