"""Intervals cover known truths at their level; samples that allow none say so."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import binomtest

from brunovsky.comparison.statistics import (
    FEWEST,
    mean_estimate,
    median_estimate,
    paired_differences,
    rate_estimate,
    sign_estimate,
)
from brunovsky.errors import ParameterError

REPETITIONS = 400


def coverage_is_nominal(hits: int, level: float, *, at_least: bool = False, slack: float = 0.0) -> bool:
    """Whether so many hits in all repetitions are likely at the level (probability above one in a thousand)."""
    side = "less" if at_least else "two-sided"
    expected = level - slack
    return binomtest(hits, REPETITIONS, expected, alternative=side).pvalue > 1e-3


@pytest.mark.parametrize("level", [0.8, 0.95])
def test_the_mean_of_a_skewed_sample_is_covered(level):
    """Of exponentials, n = 60, seeded."""
    samples = np.random.default_rng(1).exponential(2.0, (REPETITIONS, 60))
    found = [mean_estimate(list(one), seed=k, level=level, resamples=500) for k, one in enumerate(samples)]
    hits = sum(not one.excludes(2.0) for one in found)
    assert coverage_is_nominal(hits, level, slack=0.015)  # what the method loses at this n and so few resamples


def test_the_median_is_covered_at_least_at_the_level():
    samples = np.random.default_rng(2).lognormal(0.0, 2.0, (REPETITIONS, 30))
    hits = sum(not median_estimate(list(one)).excludes(1.0) for one in samples)
    assert coverage_is_nominal(hits, 0.95, at_least=True)


def test_the_paired_difference_is_covered_and_narrower_than_unpaired_means():
    rng = np.random.default_rng(3)
    hits = 0
    for k in range(REPETITIONS):
        common = 10.0 * rng.normal(size=40)
        a, b = (common + rng.normal(offset, 1.0, 40) for offset in (0.5, 0.0))
        paired = mean_estimate(paired_differences(list(a), list(b)), seed=k, resamples=500)
        hits += not paired.excludes(0.5)
        alone = mean_estimate(list(a), seed=k, resamples=500)
        assert paired.high - paired.low < 0.5 * (alone.high - alone.low)
    assert coverage_is_nominal(hits, 0.95, slack=0.015)


@pytest.mark.parametrize("truth", [0.02, 0.3])
def test_a_rate_is_covered(truth):
    counts = np.random.default_rng(4).binomial(100, truth, REPETITIONS)

    def hits(method):
        covers = {one: not rate_estimate(one, 100, method=method).excludes(truth) for one in set(counts.tolist())}
        return sum(covers[one] for one in counts.tolist())

    assert coverage_is_nominal(hits("exact"), 0.95, at_least=True)
    assert coverage_is_nominal(hits("wilson"), 0.95, at_least=True, slack=0.01)


def test_a_rate_of_nothing_has_an_upper_end():
    found = rate_estimate(0, 20)
    assert (found.estimate, found.low) == (0.0, 0.0)
    assert found.high == pytest.approx(3.8415 / (20 + 3.8415), rel=1e-4)  # z2/(n + z2)
    assert rate_estimate(0, 20, method="exact").high == pytest.approx(1.0 - 0.025 ** (1.0 / 20.0))
    assert rate_estimate(0, 0).note == "no runs" and rate_estimate(0, 0).estimate is None


@pytest.mark.parametrize("estimate", [mean_estimate, median_estimate])
def test_degenerate_samples_say_so(estimate):
    assert estimate([]).note == "no runs"
    failed = estimate([None] * 20)
    assert (failed.estimate, failed.n, failed.failures) == (None, 0, 20) and "failed" in failed.note
    one = estimate([3.0, None])
    assert (one.estimate, one.low, one.n, one.failures) == (3.0, None, 1, 1) and "fewer" in one.note
    assert not one.excludes(0.0)
    equal = estimate([2.5] * 10)
    assert (equal.estimate, equal.low, equal.high) == (2.5, 2.5, 2.5) and equal.note == "all values are equal"
    few = estimate([0.0, 1.0] * 3)
    assert few.n < FEWEST and few.low is None
    nan = estimate([float("nan"), float("inf"), *range(1, 10)])
    assert (nan.n, nan.failures, nan.estimate) == (9, 2, 5.0)


def test_too_few_values_for_a_median_at_a_high_level():
    found = median_estimate(list(range(8)), level=0.9999)
    assert found.estimate == 3.5 and found.low is None and "too few" in found.note


def test_sums_that_overflow_have_no_mean():
    found = mean_estimate([1.7e308] * 9 + [1.6e308])
    assert found.estimate is None and found.note == "overflow"


@settings(max_examples=60, deadline=None)
@given(st.lists(st.none() | st.floats(allow_nan=True, allow_infinity=True), max_size=30))
def test_no_sample_gives_a_nan(values):
    for found in (mean_estimate(values, resamples=50), median_estimate(values), sign_estimate(values)):
        json.dumps(found.as_dict(), allow_nan=False)
        assert found.n + found.failures <= len(values)
        if found.low is not None:
            assert found.low <= found.high


def test_signs():
    found = sign_estimate([1.0] * 9 + [-1.0] + [0.0] * 5 + [None])
    assert (found.estimate, found.n, found.failures) == (0.9, 10, 1)
    assert found.excludes(0.5) and not sign_estimate([1.0, -1.0] * 10).excludes(0.5)
    assert sign_estimate([0.0] * 9).note == "no pair differs"


def test_pairs_of_which_one_failed_are_left_out_and_others_refused():
    assert paired_differences([3.0, None, 1.0], [1.0, 2.0, None]) == [2.0, None, None]
    with pytest.raises(ParameterError, match="3 values against 2"):
        paired_differences([1.0, 2.0, 3.0], [1.0, 2.0])


@pytest.mark.parametrize("level", [0.0, 1.0, float("nan")])
def test_impossible_levels_are_refused(level):
    with pytest.raises(ParameterError, match="confidence level"):
        mean_estimate([1.0], level=level)
    with pytest.raises(ParameterError, match="confidence level"):
        rate_estimate(1, 2, level=level)


def test_more_events_than_runs_are_refused():
    with pytest.raises(ParameterError, match="3 events in 2 runs"):
        rate_estimate(3, 2)


def test_equal_seeds_give_equal_intervals():
    values = list(np.random.default_rng(0).normal(size=30))
    assert mean_estimate(values, seed=7) == mean_estimate(values, seed=7) != mean_estimate(values, seed=8)
