"""The second protocol: every law tuned to the same effort in one physical input, then compared."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from brunovsky.comparison.output import plain
from brunovsky.comparison.protocols.equal_effort_findings import effort_findings, effort_headline
from brunovsky.comparison.protocols.evaluation import (
    Evaluate,
    Trial,
    attempt,
    check_laws,
    step_sensitive_metrics,
)
from brunovsky.comparison.protocols.explanation import EQUAL_EFFORT, Explanation
from brunovsky.comparison.protocols.tuning import Knob, Tuning, tune
from brunovsky.errors import ParameterError


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
        Metrics that depend on the step: of runs that were made elsewhere, or so many of the tuned ones that fewer than
        two laws are left.
    finer : tuple of Trial
        The tuned runs at half the step; empty where these were not made.
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
    finer: tuple[Trial, ...] = ()
    explanation: Explanation = EQUAL_EFFORT

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws."""
        return tuple(one.law for one in self.tunings)

    @property
    def tuned(self) -> dict[str, Trial]:
        """Runs at equal effort, by law; only those that hit it."""
        return {one.law: one.trial for one in self.tunings if one.trial is not None}

    @property
    def unsure(self) -> dict[str, frozenset[str]]:
        """For each tuned law that was tried at half the step, the metrics that change by more than one per cent."""
        tuned = self.tuned
        return {one.law: step_sensitive_metrics([tuned[one.law].metrics], [one.metrics]) for one in self.finer}

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
        return effort_findings(self)

    def headline(self) -> str:
        """The one sentence for a verdict: the first metric at equal effort; of many laws the best and the worst."""
        return effort_headline(self)


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
    finer: Evaluate | None = None,
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
        Metrics by which no law may be ranked, unless each tuned run is held against one at half the step.
    finer : Evaluate, optional
        Makes the same run at half the step, once for each law that was tuned: what changes by more than one per cent
        then ranks that law no more.

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
    told, tuned = tuple(metrics), [one.trial for one in tunings if one.trial is not None]
    halved = () if finer is None else tuple(attempt(finer, one.law, one.parameters, case) for one in tuned)
    found = EqualEffort(effort, target, rtol, budget, told, tuple(tunings), frozenset(step_sensitive), finer=halved)
    if finer is None:
        return found
    unsure = found.unsure.values()
    fewer = (
        name for name in (effort, *told) if 0 < len(unsure) < 2 + sum(bool({name, effort} & one) for one in unsure)
    )
    return replace(found, step_sensitive=frozenset(fewer))
