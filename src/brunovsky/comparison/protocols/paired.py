"""Estimates of paired runs: of each law, of each pair of laws, of how often runs fail."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from brunovsky.comparison.definitions import BETTER_GREATER, UNREACHED
from brunovsky.comparison.protocols.evaluation import Trial
from brunovsky.comparison.statistics import (
    Estimate,
    mean_estimate,
    median_estimate,
    paired_differences,
    rate_estimate,
    sign_estimate,
)

ByLaw = Mapping[str, Sequence[Trial]]
"""Trials of each law, case by case."""


@dataclass(frozen=True)
class LawSummary:
    """One metric under one law.

    Attributes
    ----------
    law, metric : str
        Which.
    mean, median : Estimate
        Over the cases in which the metric is defined.
    """

    law: str
    metric: str
    mean: Estimate
    median: Estimate


@dataclass(frozen=True)
class Difference:
    """One metric of two laws over the same cases, first - second.

    Attributes
    ----------
    first, second, metric : str
        Which.
    mean, median : Estimate
        Of the differences.
    sign : Estimate
        Share of the cases that differ in which the first is larger. Here a run that failed alone counts as the worse,
        and so does a time that only one run reached, so that no law gains by leaving out its hardest cases.
    """

    first: str
    second: str
    metric: str
    mean: Estimate
    median: Estimate
    sign: Estimate

    @property
    def lower(self) -> str | None:
        """The law with the lower metric; None where the intervals do not tell the two apart."""
        if not (self.mean.excludes(0.0) and self.median.excludes(0.0)):
            return None
        if not self.sign.excludes(0.5):
            return None
        sides = {
            (self.mean.estimate or 0.0) < 0.0,
            (self.median.estimate or 0.0) < 0.0,
            (self.sign.estimate or 0.0) < 0.5,
        }
        return None if len(sides) > 1 else self.first if True in sides else self.second


@dataclass(frozen=True)
class LawRates:
    """How often things went wrong under one law.

    Attributes
    ----------
    law : str
        Which.
    failure : Estimate
        Rate of the runs that failed.
    near_singular : Estimate
        Rate of the runs that came near the singularity while moving, or ended at it.
    """

    law: str
    failure: Estimate
    near_singular: Estimate


@dataclass(frozen=True)
class RateDifference:
    """How two laws differ in the cases in which only one of them failed.

    Attributes
    ----------
    first, second : str
        Which.
    only_first, only_second : int
        Cases in which only this one failed.
    sign : Estimate
        Share of those cases in which the first failed, with its exact interval.
    """

    first: str
    second: str
    only_first: int
    only_second: int
    sign: Estimate


def summary(law: str, metric: str, trials: Sequence[Trial], seed: int, level: float) -> LawSummary:
    """Mean and median of a metric under a law."""
    values = [one.value(metric) for one in trials]
    return LawSummary(law, metric, mean_estimate(values, seed=seed, level=level), median_estimate(values, level=level))


def difference(first: str, second: str, metric: str, by_law: ByLaw, seed: int, level: float) -> Difference:
    """Paired differences of a metric between two laws."""
    pairs = list(zip(by_law[first], by_law[second], strict=True))
    found = paired_differences([a.value(metric) for a, _ in pairs], [b.value(metric) for _, b in pairs])
    signs = [_sign(a, b, metric, known) for (a, b), known in zip(pairs, found, strict=True)]
    return Difference(
        first,
        second,
        metric,
        mean_estimate(found, seed=seed, level=level),
        median_estimate(found, level=level),
        sign_estimate(signs, level=level),
    )


def _sign(first: Trial, second: Trial, metric: str, difference: float | None) -> float | None:
    """Sign of a difference; that of the worse where only one run failed, or only one reached a time."""
    if difference is not None:
        return difference
    lost = [_lost(one, metric) for one in (first, second)]
    if lost[0] == lost[1]:
        return None
    larger = 1.0 if metric not in BETTER_GREATER else -1.0
    return larger if lost[0] else -larger


def _lost(trial: Trial, metric: str) -> bool:
    return trial.failure is not None or (trial.value(metric) is None and metric in UNREACHED)


def rates(law: str, trials: Sequence[Trial], metric: str, below: float, level: float) -> LawRates:
    """How often a law failed, and how often it came near the singularity or ended at it."""
    failed = [one.failure for one in trials if one.failure]
    at_it = sum(one.singular for one in failed)
    known = [value for value in (one.value(metric) for one in trials) if value is not None]
    near = sum(value < below for value in known)
    return LawRates(
        law,
        rate_estimate(len(failed), len(trials), level=level),
        rate_estimate(near + at_it, len(known) + at_it, level=level),
    )


def rate_difference(first: str, second: str, by_law: ByLaw, level: float) -> RateDifference:
    """Cases in which only one of two laws failed."""
    pairs = [(a.failure is not None, b.failure is not None) for a, b in zip(by_law[first], by_law[second], strict=True)]
    found = [float(a) - float(b) for a, b in pairs]
    return RateDifference(first, second, found.count(1.0), found.count(-1.0), sign_estimate(found, level=level))
