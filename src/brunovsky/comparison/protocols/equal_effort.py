"""The second protocol: every law tuned to the same effort in one physical input, then compared."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from brunovsky.comparison.facts import TINY, joined, number, percent
from brunovsky.comparison.output import plain
from brunovsky.comparison.protocols.evaluation import Evaluate, Trial, check_laws, phrase, unit
from brunovsky.comparison.protocols.explanation import EQUAL_EFFORT, Explanation
from brunovsky.comparison.protocols.tuning import Knob, Tuning, tune
from brunovsky.comparison.symbols import setting, symbol
from brunovsky.errors import ParameterError

LISTED = 4  # laws, beyond which a headline tells the best and the worst of them


@dataclass(frozen=True)
class EqualEffort:
    """Laws tuned to one effort.

    Attributes
    ----------
    effort : str
        The metric that is made equal.
    target : float
        Its value.
    rtol : float
        Relative tolerance within which it is hit.
    budget : int
        Evaluations that each law may take.
    metrics : tuple of str
        Metrics that are told.
    tunings : tuple of Tuning
        One for each law.
    step_sensitive : frozenset of str
        Metrics that depend on the step.
    explanation : Explanation
        The protocol in words.
    """

    effort: str
    target: float
    rtol: float
    budget: int
    metrics: tuple[str, ...]
    tunings: tuple[Tuning, ...]
    step_sensitive: frozenset[str] = frozenset()
    explanation: Explanation = EQUAL_EFFORT

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws."""
        return tuple(one.law for one in self.tunings)

    @property
    def tuned(self) -> dict[str, Trial]:
        """Runs at equal effort, by law; only those that hit it."""
        return {one.law: one.trial for one in self.tunings if one.trial is not None}

    def rows(self) -> list[dict[str, Any]]:
        """One row for each law: how it was tuned, and its metrics there."""
        return [self._row(one) for one in self.tunings]

    def _row(self, one: Tuning) -> dict[str, Any]:
        trial = one.trial or Trial(one.law, {}, one.trials[0].case, {}, None)
        cells = trial.row([], list(dict.fromkeys((self.effort, *self.metrics))))
        cells["failure"] = one.reason
        return {"knob": one.knob.parameter, "value": one.value, "status": one.status, "runs": one.runs} | cells

    def as_dict(self) -> dict[str, Any]:
        """The same as plain data, for JSON."""
        found: dict[str, Any] = plain(self)
        return found | {"step_sensitive": sorted(self.step_sensitive), "findings": self.findings()}

    @property
    def idle(self) -> bool:
        """Whether all tuned laws have the effort at the same value of the knob, so that the tuning changed nothing."""
        values = [one.value for one in self.tunings if one.value is not None]
        return len(values) > 1 and max(values) - min(values) <= self.rtol * max(values)

    def findings(self) -> list[str]:
        """Sentences that follow from the numbers."""
        told = [self._tuning(one) for one in self.tunings]
        if len(self.tuned) < 2:
            return [*told, "Fewer than two laws reach the effort, so there is nothing to compare."]
        if self.effort in self.step_sensitive:
            return [
                *told,
                f"The effort itself, {phrase(self.effort)}, depends on the step of the simulation: no law is ranked.",
            ]
        compared = [self._compared(metric) for metric in self.metrics if metric != self.effort]
        if self.idle:
            told.append(
                "All laws have this effort at the same value of the knob: it is that of the common start, the tuning "
                "changed nothing, and what follows compares the laws as they are."
            )
        return told + compared

    def _tuning(self, one: Tuning) -> str:
        of = f"“{one.law}”"
        if one.trial is None or one.value is None:
            return f"{of} is not compared: {one.reason} ({one.runs} of {self.budget} runs)."
        effort = one.trial.value(self.effort)
        off = 0.0 if effort is None else abs(effort / self.target - 1.0)
        told_off = percent(off) if off > 1e-4 else "less than 0.01\u00a0%"
        text = (
            f"{of} has {phrase(self.effort)} = {number(effort)} {unit(self.effort)}".rstrip()
            + f", {told_off} off the target, at {setting(one.knob.parameter, one.value, number)} ({one.runs} of "
            f"{self.budget} runs)"
        )
        return text + ("." if one.monotone else f"; its effort is not monotone in {symbol(one.knob.parameter)}.")

    def headline(self) -> str:
        """The one sentence for a verdict: the first metric at equal effort; of many laws the best and the worst."""
        if self.idle:
            return ""
        unranked = {self.effort, *self.step_sensitive}
        ranked = [one for one in self.metrics if one not in unranked and len(self._ordered(one)) > 1]
        if not ranked or self.effort in self.step_sensitive:
            return self.findings()[0]
        return self._extremes(ranked[0])

    def brief(self) -> list[str]:
        """Findings without how each law was tuned and how far each is from the best."""
        told = self.findings()
        if len(self.tuned) < 2 or self.effort in self.step_sensitive:
            return told
        missed = [self._tuning(one) for one in self.tunings if one.trial is None or one.value is None]
        idle = told[len(self.tunings) : len(self.tunings) + self.idle]
        return [*missed, *idle, *(self._extremes(one) for one in self.metrics if one != self.effort)]

    def _extremes(self, metric: str) -> str:
        """A metric at equal effort; of many laws the best and the worst."""
        if metric in self.step_sensitive or len(self._ordered(metric)) < 2:
            return self._compared(metric)
        (least, low), *others, (most, high) = self._ordered(metric)
        if len(others) + 2 <= LISTED or self._excess(least, most, metric, low, high) is None:
            return self._compared(metric)
        alike = [f"“{law}”" for law, value in others if self._excess(least, law, metric, low, value) is None]
        size = f"\u00a0{unit(metric)}".rstrip()
        text = f"{self._of(metric)} is, of {len(others) + 2} laws, lowest under “{least}” ({number(low)}{size})"
        text += (
            f", from which {joined(alike)} {_is(alike)} not told apart by the tolerance of the tuning," if alike else ""
        )
        return f"{text} and highest under “{most}” ({number(high)}{size}); the table has each."

    def _of(self, metric: str) -> str:
        return f"At equal effort the {phrase(metric)}"

    def _ordered(self, metric: str) -> list[tuple[str, float]]:
        """Laws at equal effort with a metric that is defined, the lowest first."""
        known = [(law, trial.value(metric)) for law, trial in self.tuned.items()]
        return sorted([(law, value) for law, value in known if value is not None], key=lambda one: one[1])

    def _compared(self, metric: str) -> str:
        if metric in self.step_sensitive:
            return f"The {phrase(metric)} depends on the step of the simulation: it ranks no law."
        ordered = self._ordered(metric)
        if len(ordered) < 2:
            return f"The {phrase(metric)} is defined under fewer than two laws."
        listed = ", ".join(f"{number(value)} ({law})" for law, value in ordered)
        text = f"{self._of(metric)}{f', {unit(metric)},' if unit(metric) else ''} is {listed}"
        (least, low), *others = ordered
        higher = {law: self._excess(least, law, metric, low, value) for law, value in others}
        alike = [f"“{law}”" for law, one in higher.items() if one is None]
        tiny = unit(metric) == "m" and low < TINY
        apart = [
            f"under “{law}” it is higher by {f'{number(value - low)} m' if tiny else percent(share)}"
            for law, value in others
            if (share := higher[law]) is not None
        ]
        if not apart:
            return f"{text}: the laws do not differ by more than what the tolerance of the tuning explains."
        lowest = f"{text}: in this case lowest under “{least}”"
        if alike:
            lowest += f", from which {joined(alike)} {_is(alike)} not told apart by the tolerance of the tuning"
        return f"{lowest}; {joined(apart)}."

    def _excess(self, least: str, law: str, metric: str, low: float, value: float) -> float | None:
        """By what share a law's metric is above the lowest; None where the tolerance of the tuning explains it."""
        size = max(abs(low), abs(value))
        slack = sum(one.slack(self.effort, metric, self.rtol) for one in self.tunings if one.law in (least, law))
        if size == 0.0 or value - low <= max(self.rtol, slack) * size:
            return None
        return (value - low) / abs(low) if low else 1.0


def _is(some: Sequence[str]) -> str:
    return "is" if len(some) == 1 else "are"


def equal_effort(
    evaluate: Evaluate,
    laws: Mapping[str, Mapping[str, float]],
    knobs: Mapping[str, Knob],
    effort: str,
    target: float,
    *,
    metrics: Sequence[str],
    rtol: float = 0.01,
    budget: int = 40,
    scan: int = 9,
    case: int = 0,
    step_sensitive: Collection[str] = (),
) -> EqualEffort:
    """Tune each law's knob until a physical input has the same RMS, peak or other effort, and compare.

    Parameters
    ----------
    evaluate : Evaluate
        Makes one run.
    laws : mapping of str to mapping
        For each law the parameters that stay.
    knobs : mapping of str to Knob
        For each law what is tuned, and its range.
    effort : str
        Metric that is made equal, such as ``rms_u2`` or ``peak_yaw_acceleration``.
    target : float
        Its value, above zero.
    metrics : sequence of str
        Metrics to tell.
    rtol : float
        Relative tolerance within which the target is hit.
    budget : int
        Evaluations that each law may take, those of the scan among them.
    scan : int
        Evaluations, evenly spaced in the logarithm of the knob, that look for the target first.
    case : int
        Number of the case.
    step_sensitive : collection of str
        Metrics by which no law may be ranked.

    Raises
    ------
    ParameterError
        If the target, a range, the tolerance or the budget is not usable, or a law has no knob.
    """
    check_laws("equal_effort", laws, 1)
    if not 0.0 < target < math.inf or not 0.0 < rtol < 1.0:
        raise ParameterError(f"equal_effort: target = {target!r}, rtol = {rtol!r}; give target > 0 and 0 < rtol < 1")
    if not 3 <= scan < budget:
        raise ParameterError(f"equal_effort: scan = {scan}, budget = {budget}; give 3 <= scan < budget")
    missing = [law for law in laws if law not in knobs]
    if missing:
        raise ParameterError(f"equal_effort: there is no knob for {', '.join(missing)}; give one for each law")
    tunings = [
        tune(evaluate, law, fixed, knobs[law], effort, target, rtol=rtol, budget=budget, scan=scan, case=case)
        for law, fixed in laws.items()
    ]
    return EqualEffort(effort, target, rtol, budget, tuple(metrics), tuple(tunings), frozenset(step_sensitive))
