"""Sentences on a map: failures, ranges and factors of each metric, and how the laws differ."""

from __future__ import annotations

import itertools
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np

from brunovsky.comparison.definitions import UNREACHED
from brunovsky.comparison.facts import CONVERGED, HARDLY, joined, number, percent
from brunovsky.comparison.protocols.evaluation import failures_told, phrase, unit
from brunovsky.comparison.symbols import symbol

if TYPE_CHECKING:
    from brunovsky.comparison.protocols.mapped import Map

Array = np.ndarray[Any, np.dtype[np.float64]]


def map_findings(result: Map) -> list[str]:
    """Failures first, then the range of each metric under each law, and how the laws differ by it."""
    told = failures_told(result.trials) + _failures_finer(result)
    for metric in result.metrics:
        told += [_range(result, law, metric) for law in result.laws]
        if metric in result.step_sensitive and not result.finer:
            told.append(f"The {phrase(metric)} depends on the step of the simulation: it ranks no law.")
            continue
        told += [_difference(result, *pair, metric) for pair in itertools.combinations(result.laws, 2)]
    return told


def map_headline(result: Map) -> str:
    """By what factor each metric varies over the map under the first law, and how many runs failed."""
    law = result.laws[0]
    key = result.across.key
    parts = [one for one in (_variation(result.sure(law, metric), metric, key) for metric in result.metrics) if one]
    if not parts:
        return f"Over {result.keys} no metric of “{law}” is converged anywhere."
    return (
        f"Over {result.keys} there vary, under “{law}” and where the run is converged with the step, {joined(parts)}; "
        f"of {result.shape[0] * result.shape[1]} runs under each law there failed "
        f"{', '.join(_failed(result, one) for one in result.laws)}."
    )


def _failed(result: Map, law: str) -> str:
    """How many runs of a law failed, and how many of these also do at half the step."""
    coarse, fine = result.failed(law), result.failed_finer(law)
    text = f"{int(coarse.sum())} (“{law}”"
    return f"{text}; {int((coarse & fine).sum())} of these also at half the step)" if _both(result, law) else f"{text})"


def _both(result: Map, law: str) -> bool:
    return bool(result.finer) and bool(result.failed(law).any())


def _failures_finer(result: Map) -> list[str]:
    """What is left of the failures of each law at half the step, and what comes there."""
    told = []
    for law in result.laws:
        coarse, fine = result.failed(law), result.failed_finer(law)
        kept, new = int((coarse & fine).sum()), int((fine & ~coarse).sum())
        if _both(result, law):
            count = int(coarse.sum())
            rest = "" if kept == count else f": what failed {'in the others' if kept else 'there'} is the integration"
            told.append(
                f"At half the step {kept} of the {count} that failed under “{law}” fail{'s' * (kept == 1)}{rest}."
            )
        if new:
            told.append(f"At half the step {new} other{'s' * (new > 1)} fail{'s' * (new == 1)} under “{law}”.")
    return told


def _variation(values: Array, metric: str, key: str) -> str:
    """How a metric varies along the rows and over all points; empty where it is known nowhere."""
    known = values[np.isfinite(values)]
    if not known.size:
        return ""
    above, zero = known[known > 0.0], _zeros(known)
    if not above.size:
        return f"the {phrase(metric)} not at all (it is 0 in all {known.size} points)"
    factor = float(above.max() / above.min())
    by = f"by {percent(1.0 - 1.0 / factor)} of its largest value" if _hardly(factor) else _by(factor)
    factors = _row_factors(values)
    if not _hardly(factor) and len(factors) > 1:
        alone = median(factors)
        row = f"by {percent(1.0 - 1.0 / alone)}" if _hardly(alone) else _by(alone)
        by = f"{row} with {symbol(key)} alone (median of the rows), {_by(factor)} over the map"
    return f"the {phrase(metric)} {by}" + (f" (0 in {zero}, left out here)" if zero else "")


def _range(result: Map, law: str, metric: str) -> str:
    every, values, what = result.grid(law, metric), result.sure(law, metric), phrase(metric)
    known = np.isfinite(every)
    if not np.isfinite(values).any():
        return f"Under “{law}” the {what} is defined, and converged with the step, nowhere on the map."
    low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
    size = f"\u00a0{unit(metric)}" if unit(metric) else ""
    text = (
        f"Under “{law}” the {what} is {number(values.flat[low])}{size} at least ({result.place(low)}) and "
        f"{number(values.flat[high])}{size} at most ({result.place(high)})"
    )
    text += _row_by_row(values, result.across.key)
    missing = int(np.sum(~known & ~result.failed(law)))
    if missing:
        late = ", as it is beyond the end of the run" if metric in UNREACHED else ""
        text += f"; in {missing} of {values.size} runs it is undefined{late}"
    unsure = int(np.sum(known & ~np.isfinite(values)))
    if unsure:
        which = "it" if len(result.metrics) == 1 else "it or another mapped metric"
        text += f"; in {unsure} {which} changes by more than {percent(CONVERGED)} at half the step: left out"
    return f"{text}."


def _row_by_row(values: Array, key: str) -> str:
    """By what factor the key along a row changes a metric, and how many points are in none as the metric is 0 there."""
    factors = _row_factors(values)
    zero = _zeros(values[np.isfinite(values)])
    text = f"; it is 0 in {zero}" if zero else ""
    if not factors:
        return text
    text += f"; {'elsewhere ' if zero else ''}{symbol(key)} alone "
    if _hardly(max(factors)):
        return f"{text}hardly changes it, by {percent(1.0 - 1.0 / max(factors))} of the largest in a row at most"
    if len(factors) == 1:
        return f"{text}changes it {_by(factors[0])}"
    return (
        f"{text}changes it {_by(min(factors))} to {number(max(factors), 2)}, row by row (median "
        f"{number(median(factors), 2)})"
    )


def _row_factors(values: Array) -> list[float]:
    """Largest over smallest value above zero of each row that has two."""
    above = [row[np.isfinite(row) & (row > 0.0)] for row in values]
    return [float(row.max() / row.min()) for row in above if row.size > 1]


def _zeros(known: Array) -> str:
    """How many of some values are 0, which no factor can tell; empty for none."""
    zero = int(np.sum(known <= 0.0))
    return f"{zero} of {known.size} points" if zero else ""


def _hardly(factor: float) -> bool:
    return 1.0 - 1.0 / factor <= HARDLY


def _by(factor: float) -> str:
    return f"by a factor of {number(factor, 2)}"


def _difference(result: Map, first: str, second: str, metric: str) -> str:
    a, b = result.sure(first, metric), result.sure(second, metric)
    both = np.isfinite(a) & np.isfinite(b)
    what, count = phrase(metric), int(both.sum())
    if not count:
        return f"“{first}” and “{second}” have no point of the map with the {what} of both converged."
    size = np.maximum(np.abs(a[both]), np.abs(b[both]))
    change = np.divide(b[both] - a[both], size, out=np.zeros(count), where=size > 0.0)
    lower, higher = int((change < -HARDLY).sum()), int((change > HARDLY).sum())
    text = f"By the {what} “{second}” is lower than “{first}” in {lower} and higher in {higher} of {count} points"
    rest = f" where both have it converged, by more than {percent(HARDLY)} of the larger"
    return f"{text}{rest}; in the other {count - lower - higher} the two hardly differ."
