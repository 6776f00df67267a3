"""Estimates with confidence intervals: means, medians, paired differences and rates, failures counted beside them.

Nothing here is ever not a number: what a sample does not allow to say is None, with a note why.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np
from scipy import stats

from brunovsky.errors import ParameterError

LEVEL = 0.95
RESAMPLES = 2000
FEWEST = 8  # values that an interval is given for: the bootstrap of fewer covers too rarely

Sample = Sequence[float | None]


@dataclass(frozen=True)
class Estimate:
    """An estimate with its confidence interval.

    Attributes
    ----------
    estimate : float or None
        None where there are no values.
    low, high : float or None
        Ends of the confidence interval; None where the sample allows none.
    n : int
        Values that it is made of.
    failures : int
        Runs, or pairs of runs, without a value, which are left out.
    level : float
        Confidence level of the interval.
    note : str
        What is special: why there is no interval, or that all values are equal; otherwise empty.
    """

    estimate: float | None
    low: float | None
    high: float | None
    n: int
    failures: int
    level: float = LEVEL
    note: str = ""

    def excludes(self, value: float = 0.0) -> bool:
        """Whether there is an interval, and the value lies outside it."""
        return self.low is not None and self.high is not None and not self.low <= value <= self.high

    def as_dict(self) -> dict[str, Any]:
        """The same by name, ready for JSON."""
        return asdict(self)


def mean_estimate(
    values: Sample, *, seed: int = 0, level: float = LEVEL, resamples: int = RESAMPLES, fewest: int = FEWEST
) -> Estimate:
    """Mean with its bias-corrected and accelerated bootstrap interval.

    Parameters
    ----------
    values : sequence of float or None
        One for each run; None for a run that failed or has no such value.
    seed : int
        Of the resampling.
    level : float
        Confidence level, between 0 and 1.
    resamples : int
        Of the bootstrap.
    fewest : int
        Values below which no interval is given.

    References
    ----------
    B. Efron, "Better bootstrap confidence intervals", Journal of the American Statistical Association 82(397),
    171-185, 1987, doi:10.1080/01621459.1987.10478410.
    """
    known, failures = _known(values, level)
    with np.errstate(over="ignore"):
        mean = float(np.mean(known)) if known.size else None
    special = _special(known, failures, level, fewest, mean)
    if special is not None:
        return special
    low, high, note = _bootstrap(known, seed, level, resamples)
    return Estimate(mean, low, high, known.size, failures, level, note)


def median_estimate(values: Sample, *, level: float = LEVEL, fewest: int = FEWEST) -> Estimate:
    """Median with the interval between order statistics, which covers at least at its level for any distribution.

    Parameters
    ----------
    values : sequence of float or None
        As in :func:`mean_estimate`.
    level : float
        Confidence level, between 0 and 1.
    fewest : int
        Values below which no interval is given.

    References
    ----------
    W. J. Conover, *Practical Nonparametric Statistics*, 3rd ed., Wiley, 1999, section 3.2.
    """
    known, failures = _known(values, level)
    special = _special(known, failures, level, fewest, float(np.median(known)) if known.size else None)
    if special is not None:
        return special
    found = stats.quantile_test(known, q=0.0, p=0.5).confidence_interval(level)
    low, high = _ends(found)
    note = "" if low is not None else f"no interval: {known.size} values are too few for this level"
    return Estimate(float(np.median(known)), low, high, known.size, failures, level, note)


def paired_differences(first: Sample, second: Sample) -> list[float | None]:
    """Differences first - second of runs with the same draws; None where one of a pair has no value.

    Raises
    ------
    ParameterError
        If the samples are not of equal length, so that they are not paired.
    """
    if len(first) != len(second):
        raise ParameterError(
            f"paired_differences: {len(first)} values against {len(second)}; pass one for each case, in the same order"
        )
    return [None if a is None or b is None else a - b for a, b in zip(first, second, strict=True)]


def rate_estimate(
    count: int, n: int, *, level: float = LEVEL, method: Literal["wilson", "exact"] = "wilson"
) -> Estimate:
    """Rate of an event with its binomial interval.

    Parameters
    ----------
    count, n : int
        Events, and runs in which they could have occurred.
    level : float
        Confidence level, between 0 and 1.
    method : {"wilson", "exact"}
        Wilson's interval, near its level on average, or that of Clopper and Pearson, which never falls below it.

    References
    ----------
    L. D. Brown, T. T. Cai and A. DasGupta, "Interval estimation for a binomial proportion", Statistical Science 16(2),
    101-133, 2001, doi:10.1214/ss/1009213286.
    """
    _check_level(level)
    if not 0 <= count <= n:
        raise ParameterError(f"rate_estimate: {count} events in {n} runs; pass 0 <= count <= n")
    if n == 0:
        return Estimate(None, None, None, 0, 0, level, "no runs")
    low, high = _ends(stats.binomtest(count, n).proportion_ci(level, method=method))
    return Estimate(count / n, low, high, n, 0, level)


def sign_estimate(differences: Sample, *, level: float = LEVEL) -> Estimate:
    """Share of the pairs in which the first is larger, among those that differ, with its exact binomial interval.

    Parameters
    ----------
    differences : sequence of float or None
        From :func:`paired_differences`.
    level : float
        Confidence level, between 0 and 1.

    Returns
    -------
    Estimate
        One half means no effect; `n` counts the pairs that differ.
    """
    known, failures = _known(differences, level)
    differing = known[known != 0.0]
    found = rate_estimate(int(np.count_nonzero(differing > 0.0)), differing.size, level=level, method="exact")
    note = "no pair differs" if not differing.size else ""
    return Estimate(found.estimate, found.low, found.high, found.n, failures, level, note)


def _check_level(level: float) -> None:
    if not 0.0 < level < 1.0:
        raise ParameterError(f"the confidence level {level!r} is out of range; pass one between 0 and 1, such as 0.95")


def _known(values: Sample, level: float) -> tuple[np.ndarray[Any, np.dtype[np.float64]], int]:
    _check_level(level)
    known = np.array([one for one in values if one is not None and math.isfinite(one)], dtype=np.float64)
    return known, len(values) - known.size


def _special(
    known: np.ndarray[Any, np.dtype[np.float64]], failures: int, level: float, fewest: int, estimate: float | None
) -> Estimate | None:
    """Estimate of a sample that is too small or has no spread; None for any other."""
    n = int(known.size)
    if n == 0:
        note = "no runs" if failures == 0 else "all runs failed or have no value"
        return Estimate(None, None, None, 0, failures, level, note)
    if n < fewest:
        return Estimate(_finite(estimate), None, None, n, failures, level, f"no interval: fewer than {fewest} values")
    if np.all(known == known[0]):
        value = float(known[0])
        return Estimate(value, value, value, n, failures, level, "all values are equal")
    return None if _finite(estimate) is not None else Estimate(None, None, None, n, failures, level, "overflow")


def _bootstrap(
    known: np.ndarray[Any, np.dtype[np.float64]], seed: int, level: float, resamples: int
) -> tuple[float | None, float | None, str]:
    """Interval by BCa; by plain percentiles where that is degenerate."""
    for method, note in (("BCa", ""), ("percentile", "percentile interval: the corrected one is degenerate")):
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            found = stats.bootstrap(
                (known,),
                np.mean,
                confidence_level=level,
                n_resamples=resamples,
                method=method,
                random_state=np.random.default_rng(seed),
            )
        low, high = _ends(found.confidence_interval)
        if low is not None:
            return low, high, note
    return None, None, "no interval: the bootstrap is degenerate"


def _ends(interval: Any) -> tuple[float | None, float | None]:
    low, high = float(interval.low), float(interval.high)
    return (low, high) if math.isfinite(low) and math.isfinite(high) else (None, None)


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None
