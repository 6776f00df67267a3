"""The fifth protocol: how much gain, delay, lag or sampling each law stands, measured, beside what is predicted."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from brunovsky.comparison.facts import joined, percent
from brunovsky.comparison.growth import ROUNDING
from brunovsky.comparison.measured_margins import (
    MOVES,
    MeasuredMargin,
    bisect_margin,
    checked_at_half_step,
    first_loss,
)
from brunovsky.comparison.output import plain
from brunovsky.comparison.protocols.explanation import MARGINS, Explanation, margins_explained
from brunovsky.comparison.protocols.margin_rows import CUTS, QUANTITIES, MarginRow, Quantity, value_told

FIRST_TRIED = 9  # values between the ends, of which the first that is not stable is bisected towards the one before
CLOSE = 0.05  # relative difference up to which measured and predicted are said to agree

UNUSABLE = "not stable as it is"

Stable = Callable[[str, str, str, float], bool]
"""Whether a law (name) is stable with a change (quantity) of some size at a cut; the size that changes nothing is 1 for
a gain and 0 for all else."""


@dataclass(frozen=True)
class MeasuredLoopMargins:
    """Margins of all laws of a protocol.

    Attributes
    ----------
    found : tuple of MarginRow
        Law by law.
    bound : float
        Error that may remain (m).
    tolerance : float
        Relative width of the brackets.
    explanation : Explanation
        The protocol in words.
    """

    found: tuple[MarginRow, ...]
    bound: float
    tolerance: float
    explanation: Explanation = MARGINS

    @property
    def laws(self) -> tuple[str, ...]:
        """Names of the laws."""
        return tuple(dict.fromkeys(one.law for one in self.found))

    def rows(self) -> list[dict[str, Any]]:
        """One row for each margin that is limited."""
        return [one.as_row() for one in self.found if one.limited]

    def as_dict(self) -> dict[str, Any]:
        """The same as plain data, for JSON."""
        found: dict[str, Any] = plain(self)
        return found | {"findings": self.findings()}

    def findings(self) -> list[str]:
        """Sentences that follow from the numbers; the last one sums up."""
        told = [one for law in self.laws for one in self._of_law(law)]
        apart = [(one, one.difference) for one in self.found if one.difference is not None]
        if not apart:
            return [*told, "No margin that is predicted was measured."]
        less = [(one, by) for one, by in apart if _worse(one, by) and abs(by) > CLOSE]
        close = sum(abs(by) <= CLOSE for _, by in apart)
        more = len(apart) - close - len(less)
        stepped = sum(bool(one.bound) for one in self.found)
        text = (
            f"Of {len(apart)} margins of the linear part that are predicted and were measured on the nonlinear loop, "
            f"{close} agree within {percent(CLOSE)}, {len(less)} are smaller and {more} larger"
        )
        if less:
            worst = min(less, key=lambda pair: _share(*pair))[0]
            text += f"; the one that falls shortest is {_told(worst)} under “{worst.law}”"
        if stepped:
            text += f"; {stepped} more {'is' if stepped == 1 else 'are'} limited by the step of the simulation"
        holes = sum(one.regained for one in self.found)
        if holes:
            text += f"; {holes} more {'is' if holes == 1 else 'are'} no margin, as the loop fails below and stands more"
        return [*told, f"{text}."]

    def _of_law(self, law: str) -> list[str]:
        rows = [one for one in self.found if one.law == law]
        if all(one.measured.reason == UNUSABLE for one in rows):
            return [f"“{law}” does not do this scenario as it is, so that it has no margins."]
        compared = [(one, one.difference) for one in rows if one.difference is not None]
        less = [one for one, apart in compared if abs(apart) > CLOSE and _worse(one, apart)]
        more = [one for one, apart in compared if abs(apart) > CLOSE and not _worse(one, apart)]
        close = len(compared) - len(less) - len(more)
        told = []
        if compared:
            told.append(
                f"Under “{law}” {close} of {len(compared)} margins are as predicted for its linear part, within "
                f"{percent(CLOSE)}."
            )
        layered = [one for one in rows if one.within_layer not in (None, 0.0, float("inf")) and one.of_law]
        if layered:
            inside = sum(abs((one.of_law or 0.0) / (one.within_layer or 1.0) - 1.0) <= CLOSE for one in layered)
            told.append(f"As predicted for the loop within its boundary layer are {inside} of {len(layered)}.")
        for some, word in ((less, "less"), (more, "more")):
            if some:
                told.append(
                    f"“{law}” stands {word} than its linear part is predicted to: {joined(list(map(_told, some)))}."
                )
        beyond = [one for one in rows if one.predicted in (0.0, float("inf")) and one.of_law is not None]
        if beyond:
            which = joined([f"{_name(one)} of {value_told(one.measured.value, one.quantity)}" for one in beyond])
            told.append(f"“{law}” has a limit where its linear part has none: {which}.")
        stepped = [one for one in rows if one.bound]
        if stepped:
            which = joined([f"{_name(one)}, {one.bound} {_value(one)}" for one in stepped])
            told.append(
                f"Under “{law}” the limit found is that of the integration, not of the law: {which}; at half the step "
                f"stability is lost more than {percent(MOVES)} away."
            )
        holes = [one for one in rows if one.regained]
        if holes:
            which = joined([f"{_name(one)}, {_regained(one)}" for one in holes])
            told.append(f"“{law}” loses the scenario, and stands it again beyond, which is no margin: {which}.")
        none = [one for one in rows if one.measured.value is None and one.predicted and one.predicted != float("inf")]
        if none:
            which = joined([f"{_name(one)} ({one.measured.reason})" for one in none])
            told.append(f"Under “{law}” a limit is predicted but was not found: {which}.")
        return told


def margins_of(
    stable: Stable,
    laws: Sequence[str],
    cuts: Sequence[str],
    changes: Sequence[str],
    predictions: Mapping[tuple[str, str, str], tuple[float | None, float | None]],
    *,
    gains: tuple[float, float],
    times: tuple[float, float],
    bound: float,
    tolerance: float,
    still: float = ROUNDING,
    finer: Stable | None = None,
) -> MeasuredLoopMargins:
    """Measure every margin of every law by bisection.

    Parameters
    ----------
    stable : Stable
        Makes one run, and judges it.
    laws, cuts, changes : sequence of str
        What is measured.
    predictions : mapping of (law, cut, name of a quantity) to two floats or None
        Of the linear part, and within the boundary layer.
    gains, times : tuple of float
        Ends of what is tried: factors about 1; s.
    bound, tolerance : float
        See :class:`MeasuredLoopMargins`.
    still : float
        Error that may grow under a law that chatters (m).
    finer : Stable, optional
        Makes the same run at half of the step; tells the margins of the laws from those of the step.
    """
    rows = []
    for law in laws:
        usable = stable(law, cuts[0], "gain", 1.0)
        for cut in cuts:
            for one in (one for one in QUANTITIES if one.change in changes):
                found = MeasuredMargin(None, None, 1, UNUSABLE)
                if usable:
                    changed = partial(stable, law, cut, one.change)
                    found = _measured(changed, one, gains, times, tolerance)
                    if finer is not None:
                        found = checked_at_half_step(partial(finer, law, cut, one.change), found)
                rows.append(MarginRow(law, cut, one, found, *predictions.get((law, cut, one.name), (None, None))))
    return MeasuredLoopMargins(tuple(rows), bound, tolerance, margins_explained(bound, still))


def _measured(
    stable: Callable[[float], bool],
    one: Quantity,
    gains: tuple[float, float],
    times: tuple[float, float],
    tolerance: float,
) -> MeasuredMargin:
    if one.change == "gain":
        low, high = 1.0, gains[0] if one.falling else gains[1]
    else:
        low, high = times
    tried = np.geomspace(low, high, FIRST_TRIED).tolist()
    count = 0
    for before, after in pairwise(tried):
        if count == 0 and one.change != "gain" and not stable(before):
            return MeasuredMargin(None, None, 1, f"below {value_told(before, one)}")
        count += 1
        if not stable(after):
            found = bisect_margin(stable, min(before, after), max(before, after), tolerance)
            return first_loss(stable, replace(found, runs=found.runs + count), low, tolerance)
    return MeasuredMargin(None, None, count, f"none to {value_told(high, one)}")


def _worse(one: MarginRow, apart: float) -> bool:
    return apart > 0.0 if one.quantity.falling else apart < 0.0


def _share(one: MarginRow, apart: float) -> float:
    """What is left of a predicted margin."""
    return 1.0 / (1.0 + apart) if one.quantity.falling else 1.0 + apart


def _name(one: MarginRow) -> str:
    return f"{one.quantity.title} {CUTS[one.cut]}"


def _told(one: MarginRow) -> str:
    measured, predicted = (value_told(value, one.quantity) for value in (one.measured.value, one.predicted))
    return f"{_name(one)}, {measured} measured for {predicted}"


def _regained(one: MarginRow) -> str:
    """The first loss and what is beyond, in words; where the step moves the loss it says so."""
    lost, again = (
        value_told(value, one.quantity) for value in (one.measured.unstable_from, one.measured.stands_again_to)
    )
    moved = "" if one.measured.at_half_step in ("", "as found") else " (at half the step the loss is elsewhere)"
    return f"already lost at {lost}{moved}, stands again {'down' if one.quantity.falling else 'up'} to {again}"


def _value(one: MarginRow) -> str:
    return value_told(one.measured.value, one.quantity)


__all__ = ["MeasuredLoopMargins", "margins_of"]
