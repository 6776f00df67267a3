"""The fourth protocol: paired Monte-Carlo with common random numbers."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from brunovsky._frozen import FrozenMapping
from brunovsky.comparison.output import plain
from brunovsky.comparison.protocols.draws import Distribution, draw_case
from brunovsky.comparison.protocols.evaluation import Evaluate, Trial, attempt, check_laws, header
from brunovsky.comparison.protocols.explanation import MONTE_CARLO, Explanation
from brunovsky.comparison.protocols.monte_carlo_findings import monte_carlo_findings, monte_carlo_headline
from brunovsky.comparison.protocols.paired import (
    Difference,
    LawRates,
    LawSummary,
    RateDifference,
    difference,
    rate_difference,
    rates,
    summary,
)
from brunovsky.comparison.statistics import LEVEL, Estimate
from brunovsky.errors import ParameterError


@dataclass(frozen=True)
class MonteCarlo:
    """Runs of all laws over the same drawn cases, and what follows from them.

    Attributes
    ----------
    laws, metrics : tuple of str
        Names.
    cases, seed : int
        How many cases, and what they were drawn from.
    level : float
        Of all intervals.
    distributions : mapping of str to Distribution
        What was drawn.
    singular_metric : str
        Metric that tells how near a run came to the singularity.
    singular_below : float
        Value below which it is called near.
    trials : tuple of Trial
        Law by law, case by case.
    summaries, differences, rates, rate_differences : tuple
        For each law and metric; each pair of laws and metric; each law; each pair.
    step_sensitive : frozenset of str
        Metrics that depend on the step.
    explanation : Explanation
        The protocol in words.
    """

    laws: tuple[str, ...]
    metrics: tuple[str, ...]
    cases: int
    seed: int
    level: float
    distributions: Mapping[str, Distribution]
    singular_metric: str
    singular_below: float
    trials: tuple[Trial, ...]
    summaries: tuple[LawSummary, ...]
    differences: tuple[Difference, ...]
    rates: tuple[LawRates, ...]
    rate_differences: tuple[RateDifference, ...]
    step_sensitive: frozenset[str] = frozenset()
    explanation: Explanation = MONTE_CARLO

    def values(self, law: str, metric: str) -> list[float | None]:
        """A metric of a law in each case; None where it is undefined or the run failed."""
        return [one.value(metric) for one in self.trials if one.law == law]

    def rows(self) -> list[dict[str, Any]]:
        """One row for each run, with what was drawn."""
        metrics = list(dict.fromkeys((*self.metrics, self.singular_metric)))
        return [one.row(list(self.distributions), metrics) for one in self.trials]

    def summary_rows(self) -> list[dict[str, Any]]:
        """One row for each estimate: of laws, of paired differences, of rates."""
        found = [
            _row(one.law, "", header(one.metric), kind, estimate)
            for one in self.summaries
            for kind, estimate in (("mean", one.mean), ("median", one.median))
        ]
        found += [
            _row(one.first, one.second, header(one.metric), kind, estimate)
            for one in self.differences
            for kind, estimate in (
                ("mean of paired differences", one.mean),
                ("median of paired differences", one.median),
                ("share of differing pairs with the first larger", one.sign),
            )
        ]
        return found + [
            _row(one.law, "", name, "rate", estimate)
            for one in self.rates
            for name, estimate in (("failure", one.failure), ("near singularity", one.near_singular))
        ]

    def as_dict(self) -> dict[str, Any]:
        """The same as plain data, for JSON."""
        found: dict[str, Any] = plain(self)
        return found | {"step_sensitive": sorted(self.step_sensitive), "findings": self.findings()}

    def headline(self) -> str:
        """What the verdict says of it."""
        return monte_carlo_headline(self)

    def findings(self) -> list[str]:
        """Sentences that follow from the numbers."""
        return monte_carlo_findings(self)


def monte_carlo(
    evaluate: Evaluate,
    laws: Mapping[str, Mapping[str, float]],
    distributions: Mapping[str, Distribution],
    *,
    metrics: Sequence[str],
    cases: int,
    seed: int = 0,
    level: float = LEVEL,
    singular_metric: str = "min_speed_moving",
    singular_below: float = 0.05,
    step_sensitive: Collection[str] = (),
) -> MonteCarlo:
    """Run every law in the same randomly drawn cases, and estimate how they differ.

    Parameters
    ----------
    evaluate : Evaluate
        Makes one run; it makes the noise of a case from :func:`noise_seed` and the number of the case.
    laws : mapping of str to mapping
        For each law its parameters.
    distributions : mapping of str to Distribution
        What is drawn for each case; of the same name, a law's own parameter gives way.
    metrics : sequence of str
        Metrics to tell.
    cases : int
        How many.
    seed : int
        Of all draws.
    level : float
        Confidence level of the intervals.
    singular_metric : str
        Metric that tells how near a run came to the singularity.
    singular_below : float
        Value below which it is called near.
    step_sensitive : collection of str
        Metrics by which no law may be ranked.

    Raises
    ------
    ParameterError
        If there is no law or no case, or the level is out of range.
    """
    check_laws("monte_carlo", laws)
    if cases < 1:
        raise ParameterError(f"monte_carlo: cases = {cases}; give at least one, and a hundred for narrow intervals")
    if seed < 0:
        raise ParameterError(f"monte_carlo: seed = {seed}; give zero or more")
    drawn = [draw_case(distributions, seed, case) for case in range(cases)]
    by_law = {
        law: [attempt(evaluate, law, {**fixed, **one}, case) for case, one in enumerate(drawn)]
        for law, fixed in laws.items()
    }
    pairs = list(itertools.combinations(laws, 2))
    return MonteCarlo(
        laws=tuple(laws),
        metrics=tuple(metrics),
        cases=cases,
        seed=seed,
        level=level,
        distributions=FrozenMapping(distributions),
        singular_metric=singular_metric,
        singular_below=singular_below,
        trials=tuple(itertools.chain.from_iterable(by_law.values())),
        summaries=tuple(summary(law, metric, by_law[law], seed, level) for metric in metrics for law in laws),
        differences=tuple(difference(*pair, metric, by_law, seed, level) for metric in metrics for pair in pairs),
        rates=tuple(rates(law, by_law[law], singular_metric, singular_below, level) for law in laws),
        rate_differences=tuple(rate_difference(*pair, by_law, level) for pair in pairs),
        step_sensitive=frozenset(step_sensitive),
    )


def _row(first: str, second: str, what: str, kind: str, estimate: Estimate) -> dict[str, Any]:
    return {"law": first, "against": second, "what": what, "kind": kind} | estimate.as_dict()
