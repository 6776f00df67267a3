"""What protocols evaluate: one run of one law, as metrics or as a failure with its reason."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from brunovsky._frozen import FrozenMapping
from brunovsky.comparison.definitions import Definition, definition
from brunovsky.comparison.facts import CONVERGED, given, joined
from brunovsky.comparison.symbols import key_value, symbol
from brunovsky.errors import BrunovskyError, ParameterError


@dataclass(frozen=True)
class Failure:
    """Why a run has no metrics.

    Attributes
    ----------
    reason : str
        In a sentence.
    singular : bool
        Whether it ended at the singularity of the law.
    words : str
        What happened, for sentences; empty where the reason says it.
    """

    reason: str
    singular: bool = False
    words: str = ""

    @property
    def told(self) -> str:
        """What happened, in words."""
        return self.words or self.reason.rstrip(".")


Evaluate = Callable[[str, Mapping[str, float], int], Mapping[str, float | None] | Failure | None]
"""Runs a law with parameters in a case, and returns its metrics by name; a failure, or None, for a run that failed.

The case numbers what is random but common to all laws, such as the noise (see ``noise_seed``)."""


@dataclass(frozen=True)
class Trial:
    """One evaluation.

    Attributes
    ----------
    law : str
        Name of the law.
    parameters : mapping of str to float
        What was set.
    case : int
        Number of the case.
    metrics : mapping of str to float or None
        Empty for a run that failed; None where a metric is undefined.
    failure : Failure or None
        Why the run failed.
    """

    law: str
    parameters: Mapping[str, float]
    case: int
    metrics: Mapping[str, float | None]
    failure: Failure | None

    def value(self, name: str) -> float | None:
        """A metric; None where it is undefined or the run failed."""
        return self.metrics.get(name)

    def row(self, parameters: Sequence[str], metrics: Sequence[str]) -> dict[str, Any]:
        """Cells of a table, by column: law, case, parameters, metrics with units, and why the run failed."""
        return (
            {"law": self.law, "case": self.case}
            | {name: self.parameters.get(name) for name in parameters}
            | {header(name): self.value(name) for name in metrics}
            | {"failure": self.failure.reason if self.failure else ""}
        )


def attempt(evaluate: Evaluate, law: str, parameters: Mapping[str, float], case: int) -> Trial:
    """Evaluate once; an error of the package is a failed run, and a number that is not finite is undefined."""
    try:
        found = evaluate(law, parameters, case)
    except BrunovskyError as error:
        found = Failure(str(error))
    frozen = FrozenMapping(dict(parameters))
    if found is None:
        found = Failure("the run failed without giving a reason")
    if isinstance(found, Failure):
        return Trial(law, frozen, case, FrozenMapping({}), found)
    clean = {name: _finite(value) for name, value in found.items()}
    return Trial(law, frozen, case, FrozenMapping(clean), None)


def step_sensitive_metrics(
    full: Iterable[Mapping[str, float | None]],
    half: Iterable[Mapping[str, float | None]],
    *,
    tolerance: float = CONVERGED,
) -> frozenset[str]:
    """Names of the metrics that depend on the step in any of several runs, by which no law may be ranked.

    Parameters
    ----------
    full, half : iterable of mappings
        Metrics of runs, and of the same runs at half the step.
    tolerance : float
        Relative change up to which a metric counts as converged.
    """
    found = set()
    for one, other in zip(full, half, strict=True):
        for name, value in one.items():
            finer = other.get(name)
            if value is None and finer is None:
                continue
            if value is None or finer is None or abs(finer - value) > tolerance * abs(value):
                found.add(name)
    return frozenset(found)


def phrase(name: str) -> str:
    """A metric within a sentence."""
    known = definition(name)
    return known.phrase if known else name


def unit(name: str) -> str:
    """Unit of a metric, empty where it has none or is not defined here."""
    known = definition(name)
    return known.unit if known and known.unit != "1" else ""


def with_unit(name: str) -> str:
    """Title of an axis."""
    return f"{phrase(name)}, {unit(name)}" if unit(name) else phrase(name)


def header(name: str) -> str:
    """Header of a column."""
    known: Definition | None = definition(name)
    return known.header if known else name


def check_laws(where: str, laws: Collection[str], fewest: int = 1) -> None:
    """Refuse a protocol with too few laws."""
    if len(laws) < fewest:
        raise ParameterError(f"{where}: {len(laws)} law(s) given; give at least {fewest}")


def check_range(where: str, name: str, low: float, high: float) -> None:
    """Refuse a range that has no logarithm."""
    if not 0.0 < low < high < math.inf:
        raise ParameterError(f"{where}: the range of {name} is {low!r} to {high!r}; give 0 < low < high")


def failures_told(trials: Sequence[Trial], knob: str = "") -> list[str]:
    """A sentence on the failed runs of each law: what happened first, or what at which values of a knob."""
    told = []
    for law in dict.fromkeys(one.law for one in trials):
        own = [one for one in trials if one.law == law]
        failed = [(one, one.failure) for one in own if one.failure]
        if failed:
            which = "all" if len(failed) == len(own) else str(len(failed))
            text = f"; the first: {failed[0][1].told}"
            if knob:
                text = "".join(_at(knob, failed, words) for words in dict.fromkeys(one.told for _, one in failed))
            told.append(f"Under “{law}” {which} of {len(own)} runs failed{text}.")
    return told


def _at(knob: str, failed: Sequence[tuple[Trial, Failure]], words: str) -> str:
    """At which values of a knob a thing happened."""
    values = [one.parameters[knob] for one, failure in failed if failure.told == words]
    return f"; at {symbol(knob)} = {joined([*map(given, values[:-1]), key_value(values[-1], knob)])}: {words}"


def _finite(value: float | None) -> float | None:
    return float(value) if value is not None and math.isfinite(value) else None
