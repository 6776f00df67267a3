"""Paired Monte-Carlo on toy laws whose differences are known."""

import json
import math

import numpy as np
import pytest
from scipy.stats import kstest

from brunovsky.comparison import drawing
from brunovsky.comparison.protocols import (
    Distribution,
    Failure,
    draw_case,
    monte_carlo,
    monte_carlo_figure,
    noise_seed,
    step_sensitive_metrics,
)
from brunovsky.errors import ParameterError

DRAWN = {"rho[1]": Distribution("uniform", 0.5, 1.5), "x_start": Distribution("normal", 2.0, 0.1)}
LAWS = {"linear": {"P": 0.0}, "relay": {"P": 2.5}}


def toy(offset=0.0, own=0.0, *, fails=lambda law, case: False, seed=1):
    """IAE = 10 rho + offset for the relay + noise of the law's own; rho is common."""

    def evaluate(law, parameters, case):
        if fails(law, case):
            return Failure("at the singularity", singular=True)
        rng = np.random.default_rng([seed, case, len(law)])
        relay = offset if law == "relay" else 0.0
        return {
            "iae": 10.0 * parameters["rho[1]"] + relay + own * rng.normal(),
            "min_speed_moving": 0.5 * parameters["rho[1]"] - 0.25,
            "settling_time": 1.0 + relay,
        }

    return evaluate


def study(evaluate, laws=LAWS, *, cases=60, metrics=("iae",), **more):
    return monte_carlo(evaluate, laws, DRAWN, metrics=metrics, cases=cases, seed=7, **more)


def told(result) -> str:
    return " ".join(result.findings())


def test_adding_laws_or_draws_changes_no_draw():
    alone, three = study(toy(), {"linear": {}}), study(toy(), LAWS | {"layer": {}})
    drawn = [one.parameters["rho[1]"] for one in alone.trials]
    for law in three.laws:
        assert [one.parameters["rho[1]"] for one in three.trials if one.law == law] == drawn
    more = draw_case(DRAWN | {"Q": Distribution("loguniform", 1.0, 9.0)}, 7, 11)
    assert (
        {name: more[name] for name in DRAWN}
        == draw_case(DRAWN, 7, 11)
        == draw_case(dict(reversed(DRAWN.items())), 7, 11)
    )
    assert draw_case(DRAWN, 7, 11) != draw_case(DRAWN, 8, 11) != draw_case(DRAWN, 8, 12)
    assert len({noise_seed(7, case) for case in range(1000)}) == 1000


@pytest.mark.parametrize(
    ("distribution", "cdf"),
    [
        (Distribution("uniform", 2.0, 4.0), lambda x: np.clip((x - 2.0) / 2.0, 0.0, 1.0)),
        (Distribution("normal", 1.0, 3.0), lambda x: 0.5 * (1.0 + np.vectorize(math.erf)((x - 1.0) / 3.0 / 2**0.5))),
        (Distribution("loguniform", 0.1, 10.0), lambda x: np.clip(0.5 * (np.log10(x) + 1.0), 0.0, 1.0)),
    ],
)
def test_draws_follow_their_distribution(distribution, cdf):
    drawn = [draw_case({"a": distribution}, 0, case)["a"] for case in range(1000)]
    assert kstest(drawn, cdf).pvalue > 1e-3


@pytest.mark.parametrize(
    "wrong", [("uniform", 1.0, 1.0), ("normal", 0.0, 0.0), ("loguniform", 0.0, 1.0), ("cauchy", 0, 1)]
)
def test_impossible_distributions_are_refused(wrong):
    with pytest.raises(ParameterError, match="distribution"):
        Distribution(*wrong)


def test_a_known_difference_is_found_though_the_laws_overlap():
    result = study(toy(offset=-0.3, own=0.2))
    (difference,) = result.differences
    assert not difference.mean.excludes(0.3) and difference.lower == "relay"  # linear - relay = 0.3
    linear, relay = (one.mean for one in result.summaries)
    assert linear.low < relay.high  # unpaired, the two are not told apart
    assert "The IAE is lower under “relay” than under “linear” over 60 cases" in told(result)


def test_the_verdict_flips_with_the_numbers_and_is_silent_without_a_difference():
    assert "The IAE is lower under “linear” than under “relay”" in told(study(toy(offset=0.3, own=0.2)))
    same = study(toy(own=0.2))
    assert same.differences[0].lower is None
    assert "not told apart over 60 cases" in told(same) and "lower under" not in told(same)


@pytest.mark.slow
def test_verdicts_without_a_difference_are_rare():
    """At 95 %, and with three conditions to meet: at most one in twenty, of 100 studies."""
    wrong = sum(study(toy(own=1.0, seed=k), cases=20).differences[0].lower is not None for k in range(100))
    assert wrong <= 8


def test_too_few_cases_rank_no_law():
    result = study(toy(offset=-5.0), cases=5)
    assert told(result).count("cases are fewer than the 8") == 1 and "no two laws are told apart" in told(result)
    assert "no interval" not in told(result)


def test_what_depends_on_the_step_ranks_no_law():
    result = study(toy(offset=-5.0, own=0.1), step_sensitive=["iae"])
    assert "it ranks no law" in told(result) and "lower under" not in told(result)


def test_failures_and_near_singularities_are_counted_with_intervals():
    result = study(toy(own=0.1, fails=lambda law, case: law == "relay" and case < 12))
    rates = {one.law: one for one in result.rates}
    assert rates["relay"].failure.estimate == 0.2 and rates["linear"].failure.estimate == 0.0
    speeds = [one.value("min_speed_moving") for one in result.trials if one.law == "linear"]
    assert rates["linear"].near_singular.estimate == np.mean([one < 0.05 for one in speeds])
    near = sum(one < 0.05 for one in speeds[12:])
    assert rates["relay"].near_singular.estimate == pytest.approx((near + 12) / 60)  # those that ended at it count
    (pair,) = result.rate_differences
    assert (pair.only_first, pair.only_second) == (0, 12)
    assert "“relay” fails more often" in told(result)
    assert "Under “relay” 12 of 60 runs failed; the first: at the singularity." in told(result)
    (difference,) = result.differences
    assert (difference.mean.n, difference.mean.failures) == (48, 12)


def test_few_failures_do_not_tell_which_fails_more_often():
    result = study(toy(fails=lambda law, case: law == "relay" and case < 4))
    assert "does not tell which fails more often" in told(result)


def test_a_law_gains_nothing_by_failing_in_its_hard_cases():
    """Where it ends the relay is better, but it fails alone in half of the cases."""
    result = study(toy(offset=-3.0, own=0.1, fails=lambda law, case: law == "relay" and case % 2 == 0))
    (difference,) = result.differences
    assert difference.mean.excludes(0.0) and difference.median.excludes(0.0) and difference.lower is None
    assert "lower under" not in told(result) and "counted as the worse" in told(result)


def test_a_time_that_is_never_reached_is_the_longer():
    def evaluate(law, parameters, case):
        late = law == "relay" and case % 2 == 0
        return {"settling_time": None if late else 1.0 + 0.1 * parameters["rho[1]"] - 0.5 * (law == "relay")}

    result = study(evaluate, metrics=("settling_time",))
    assert result.differences[0].sign.n == 60 and result.differences[0].lower is None


def test_all_failed_and_all_equal():
    failed = study(toy(fails=lambda law, case: law == "relay"))
    assert "all of 60 runs failed" in told(failed) and "have no case with the IAE of both" in told(failed)
    equal = study(toy(offset=1.0), metrics=("settling_time",))
    assert equal.differences[0].mean.note == "all values are equal" and equal.differences[0].lower == "linear"
    none = study(lambda law, parameters, case: None)
    for result in (failed, equal, none):
        json.dumps(result.as_dict(), allow_nan=False)
        assert all(row["estimate"] is not None or row["note"] for row in result.summary_rows())
        with drawing.settings():
            assert drawing.svg(monte_carlo_figure(result), "test").startswith("<svg")


def test_rows_hold_what_was_drawn():
    result = study(toy(), cases=3)
    assert len(result.rows()) == 6
    assert set(result.rows()[0]) >= {
        "law",
        "case",
        "rho[1]",
        "x_start",
        "iae [m s]",
        "min_speed_moving [m/s]",
        "failure",
    }
    assert len(result.summary_rows()) == 2 * 2 + 3 + 4


@pytest.mark.parametrize("wrong", [{"cases": 0}, {"level": 1.0}, {"laws": {}}])
def test_unusable_requests_are_refused(wrong):
    with pytest.raises(ParameterError):
        study(toy(), **wrong)


def test_chance_is_told_where_many_were_looked_at():
    result = study(toy(own=0.1), LAWS | {"layer": {}})
    assert "3 pairs of laws and metrics were looked at, each at the level of 95" in told(result)


def test_metrics_that_change_at_half_the_step_are_found():
    full = [{"iae": 1.0, "total_variation_u2": 10.0, "settling_time": None, "a": 0.0}, {"iae": 2.0}]
    half = [{"iae": 1.005, "total_variation_u2": 20.0, "settling_time": None, "a": 0.0}, {"iae": 2.0}]
    assert step_sensitive_metrics(full, half) == {"total_variation_u2"}
    assert step_sensitive_metrics([{"iae": 1.0}], [{}]) == {"iae"}
