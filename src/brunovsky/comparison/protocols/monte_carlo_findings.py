"""Sentences on a paired Monte-Carlo study, never stronger than its intervals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from brunovsky.comparison.facts import TINY, joined, number, percent
from brunovsky.comparison.protocols.evaluation import failures_told, phrase, unit, with_unit
from brunovsky.comparison.protocols.paired import Difference, LawRates, RateDifference
from brunovsky.comparison.statistics import FEWEST, Estimate

if TYPE_CHECKING:
    from brunovsky.comparison.protocols.monte_carlo import MonteCarlo


def monte_carlo_findings(study: MonteCarlo) -> list[str]:
    """Failures and near-singularities first, then each metric."""
    told = failures_told(study.trials)
    told += _all_rates(study)
    told += [_failures(one) for one in study.rate_differences if one.only_first or one.only_second]
    if study.cases < FEWEST:
        told.append(
            f"{study.cases} cases are fewer than the {FEWEST} from which medians, means and differences have an "
            "interval: no two laws are told apart."
        )
    ranked = [metric for metric in study.metrics if metric not in study.step_sensitive]
    for metric in study.metrics:
        told.append(_medians(study, metric))
        if metric in study.step_sensitive:
            told.append(f"The {phrase(metric)} depends on the step of the simulation: it ranks no law.")
        else:
            pairs = [one for one in study.differences if one.metric == metric]
            told += [_difference(study, one) for one in pairs if study.cases >= FEWEST or one.median.n == 0]
    count = sum(one.metric in ranked and one.mean.low is not None for one in study.differences)
    if count > 1:
        told.append(
            f"{count} pairs of laws and metrics were looked at, each at the level of {percent(study.level)}: were "
            f"there no differences at all, up to {number(count * (1.0 - study.level), 2)} of them would still be told "
            "on average."
        )
    return told


def monte_carlo_headline(study: MonteCarlo) -> str:
    """Median of the first metric under each law, and which laws no other beats by it, as far as intervals tell."""
    return f"Over {study.cases} drawn cases {_first_medians(study)}{_unbeaten(study)}."


def _first_medians(study: MonteCarlo) -> str:
    """Median of the first metric under each law, and in how many cases it has none."""
    metric, parts = study.metrics[0], []
    for one in study.summaries:
        if one.metric != metric:
            continue
        failed = sum(trial.failure is not None for trial in study.trials if trial.law == one.law)
        missing = sum(value is None for value in study.values(one.law, metric)) - failed
        text = f"unknown under “{one.law}”" if one.median.estimate is None else f"{interval(one.median)} (“{one.law}”)"
        lost = [f"{count} {word}" for count, word in ((failed, "failed"), (missing, "without it")) if count]
        parts.append(f"{text}, {' and '.join(lost)}" if lost else text)
    return f"the median of the {with_unit(metric)}, is {'; '.join(parts)}"


def _unbeaten(study: MonteCarlo) -> str:
    """Which laws no other beats by the first metric that may rank, as far as the intervals tell laws apart."""
    metric = next((one for one in study.metrics if one not in study.step_sensitive), None)
    pairs = [one for one in study.differences if one.metric == metric and one.median.n]
    if metric is None or not pairs:
        return ""
    told = [one for one in pairs if one.lower is not None]
    if not told:
        return f". No two laws are told apart by the {phrase(metric)}"
    beaten = {one.second if one.lower == one.first else one.first for one in told}
    names = dict.fromkeys(name for one in pairs for name in (one.first, one.second))
    best = [f"“{name}”" for name in names if name not in beaten]
    if not best:
        return f". Each law is beaten by another one by the {phrase(metric)}"
    return (
        f". No law has a lower {phrase(metric)} than {joined(best)}, as far as laws are told apart ({len(told)} of "
        f"{len(pairs)} pairs are)"
    )


def interval(one: Estimate, digits: int = 3) -> str:
    """Estimate with its interval, or with the reason why there is none."""
    if one.estimate is None:
        return f"unknown ({one.note})"
    if one.low is None or one.high is None:  # where the cases are too few for any, that is said once
        few = one.n + one.failures < FEWEST
        return number(one.estimate, digits) if few else f"{number(one.estimate, digits)} ({one.note})"
    return f"{number(one.estimate, digits)} [{number(one.low, digits)}, {number(one.high, digits)}]"


def _all_rates(study: MonteCarlo) -> list[str]:
    """Rates of each law, in one sentence where they are nil under all."""
    first = study.rates[0]
    nil = all(one.failure.estimate == 0.0 and one.near_singular.estimate == 0.0 for one in study.rates)
    if not nil or len({one.failure.n for one in study.rates}) > 1:
        return [_rates(one, study) for one in study.rates]
    limit = f"{number(study.singular_below)} {unit(study.singular_metric)}".rstrip()
    return [
        f"Under no law any of {first.failure.n} runs failed ({_share(first.failure)} of each), nor came nearer to the "
        f"singularity than {limit} while moving."
    ]


def _rates(one: LawRates, study: MonteCarlo) -> str:
    near = one.near_singular
    text = f"Under “{one.law}” {_share(one.failure)} of {one.failure.n} runs failed; "
    if near.estimate is None:
        return text + f"how near they came to the singularity is not known ({near.note})."
    limit = f"{number(study.singular_below)} {unit(study.singular_metric)}".rstrip()
    return (
        text + f"{_share(near)} of {near.n} came nearer to the singularity than {limit} while moving, or ended at it."
    )


def _share(one: Estimate) -> str:
    if one.estimate is None or one.low is None or one.high is None:
        return "an unknown share"
    return f"{percent(one.estimate)} [{percent(one.low)}, {percent(one.high)}]"


def _failures(one: RateDifference) -> str:
    counts = f"In {one.only_first} case(s) only “{one.first}” failed, in {one.only_second} only “{one.second}”"
    if not one.sign.excludes(0.5):
        return f"{counts}: that does not tell which fails more often."
    return f"{counts}: “{one.first if one.only_first > one.only_second else one.second}” fails more often."


def _medians(study: MonteCarlo, metric: str) -> str:
    parts = [f"{interval(one.median)} ({one.law})" for one in study.summaries if one.metric == metric]
    return f"Median {with_unit(metric)}: {'; '.join(parts)}."


def _difference(study: MonteCarlo, one: Difference) -> str:
    what, n = phrase(one.metric), one.median.n
    left = f"; {one.median.failures} pair(s) without a value are left out" if one.median.failures else ""
    if n == 0:
        return f"“{one.first}” and “{one.second}” have no case with the {what} of both ({one.median.note})."
    if one.mean.low is None or one.median.low is None:
        note = one.mean.note or one.median.note
        return f"By the {what} “{one.first}” and “{one.second}” are not told apart: {note}{left}."
    numbers = (
        f"paired difference “{one.first}” − “{one.second}”: median {interval(one.median)}, mean "
        f"{interval(one.mean)} {unit(one.metric)}".rstrip()
    )
    if (
        one.lower is None
        and one.sign.failures < one.median.failures
        and one.mean.excludes(0.0)
        and one.median.excludes(0.0)
    ):
        return (
            f"By the {what} “{one.first}” and “{one.second}” are not told apart over all cases: where both have it the "
            f"intervals exclude zero ({numbers}), but not with the runs that failed or never got there counted as the "
            f"worse{left}."
        )
    if one.lower is None:
        return f"By the {what} “{one.first}” and “{one.second}” are not told apart over {n} cases ({numbers}{left})."
    other = one.second if one.lower == one.first else one.first
    if one.sign.failures < one.median.failures:
        left += "; the order holds with runs that failed alone counted as the worse"
    base = next(two.median.estimate for two in study.summaries if (two.law, two.metric) == (other, one.metric))
    if base and not (unit(one.metric) == "m" and base < TINY):
        share = percent(abs((one.median.estimate or 0.0) / base))
        numbers += f"; the median difference is {share} of the median under “{other}”"
    return f"The {what} is lower under “{one.lower}” than under “{other}” over {n} cases ({numbers}{left})."
