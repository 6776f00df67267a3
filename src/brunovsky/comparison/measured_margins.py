"""Margins of a nonlinear loop, measured: bisection on simulations with another loop gain or delay."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from typing import Any, Literal

import numpy as np

from brunovsky.comparison.growth import ROUNDING, grows
from brunovsky.errors import ParameterError

Array = np.ndarray[Any, np.dtype[np.float64]]
Simulate = Callable[[float, float], tuple[Array, Array] | None]
"""Simulates with the loop gain times the first number and a delay of the second (s); returns instants (s) and position
errors (m), or None for a run that failed."""

AtHalfStep = Literal["", "as found", "lost later", "lost earlier"]

CONTRACTS = 0.9  # error of the last quarter over that of the quarter before, up to which a run still converges
GROWS = 1.1  # and from which a run within its bound is growing
SCANNED = 60  # numbers between the start and a margin at which an earlier loss is looked for
SPREAD = 10.0  # ratio of the two beyond which these are spaced in the logarithm
MOVES = 0.05  # relative change at half of the step up to which a margin is said to be that of the loop


@dataclass(frozen=True)
class MeasuredMargin:
    """Where a loop stops being stable along one number.

    Attributes
    ----------
    value : float or None
        Last number that was found stable next to the loss of stability; None if there is no such place.
    unstable_from : float or None
        First number that was found not to be stable, within the tolerance of `value`.
    runs : int
        Simulations that were made.
    reason : str
        Why there is no value; empty if there is.
    at_half_step : str
        What both ends of the bracket do in runs with half of the step: ``"as found"``, or stability is ``"lost later"``
        or ``"lost earlier"`` there, so that what was found is the step's; empty where this was not tried.
    stands_again_to : float or None
        Last number up to which the loop is stable again beyond a first loss, which `value` is then; None where no loss
        was found below.
    """

    value: float | None
    unstable_from: float | None
    runs: int
    reason: str = ""
    at_half_step: AtHalfStep = ""
    stands_again_to: float | None = None


@dataclass(frozen=True)
class MeasuredMargins:
    """Measured margins of a loop; see `measured_margins`.

    Attributes
    ----------
    gain_lower, gain_upper : MeasuredMargin
        Factors of the loop gain (1).
    delay : MeasuredMargin
        In s.
    """

    gain_lower: MeasuredMargin
    gain_upper: MeasuredMargin
    delay: MeasuredMargin

    def as_dict(self) -> dict[str, Any]:
        """The same by name, ready for JSON."""
        return asdict(self)


def bounded_at_the_end(time: Array, error: Array, bound: float, still: float = ROUNDING) -> bool:
    """Whether a complete run counts as stable.

    Let E3 and E4 be the largest errors in the third and the last quarter of the duration. The run is stable if the
    error still contracts, E4 <= 0.9 E3, or stays within the bound without growing: E4 <= bound and E4 <= 1.1 E3, and
    its root mean square does not rise over each of the last four eighths of the duration, by 5 % in all. An error below
    `still` does not count as growing. A run that is not finite is not stable.

    Parameters
    ----------
    time, error : ndarray, shape (n,)
        Instants (s) and position errors (m).
    bound : float
        Error that may remain (m): chatter and unmatched disturbances leave one for ever.
    still : float
        Error that may grow (m): that of rounding, or of chatter, which is not the same in each part. What grows slowly
        below it is not seen.
    """
    if time.size < 2 or not np.isfinite(error).all():
        return False
    half, quarter = (time[0] + share * (time[-1] - time[0]) for share in (0.5, 0.75))
    third, last = error[(time >= half) & (time < quarter)], error[time >= quarter]
    before, after = float(np.max(np.abs(third), initial=0.0)), float(np.max(np.abs(last), initial=0.0))
    if after <= CONTRACTS * before:
        return True
    return after <= bound and after <= max(GROWS * before, still) and not grows(time, error, still)


def bisect_margin(stable: Callable[[float], bool], low: float, high: float, rtol: float = 0.01) -> MeasuredMargin:
    """Find where a loop stops being stable between a number at which it is and one at which it is not.

    Bisects in the logarithm, or, where one end is zero, in the number itself. Only one loss of stability is found;
    with several, as in loops that are stable again beyond, it is one of them.

    Parameters
    ----------
    stable : function of float
        Whether the loop is stable for a number.
    low, high : float
        Ends, 0 <= low < high, either of them stable.
    rtol : float
        Relative width of the bracket at the end.

    Raises
    ------
    ParameterError
        If the ends are no such numbers, or `rtol` is not between 0 and 1.
    """
    if not (0.0 <= low < high < math.inf and 0.0 < rtol < 1.0):
        raise ParameterError(
            f"bisect_margin: low = {low!r}, high = {high!r}, rtol = {rtol!r}; pass 0 <= low < high and 0 < rtol < 1"
        )
    ends = stable(low), stable(high)
    if ends[0] == ends[1]:
        reason = "stable at both ends of the range" if ends[0] else "not stable at either end of the range"
        return MeasuredMargin(None, None, 2, f"{reason}, {low:g} to {high:g}")
    inside, outside = (low, high) if ends[0] else (high, low)
    runs = 2
    while abs(inside - outside) > rtol * max(inside, outside) and max(inside, outside) > 1e-12 * high:
        middle = math.sqrt(inside * outside) if low > 0.0 else 0.5 * (inside + outside)
        inside, outside = (middle, outside) if stable(middle) else (inside, middle)
        runs += 1
    return MeasuredMargin(inside, outside, runs)


def first_loss(
    stable: Callable[[float], bool], found: MeasuredMargin, start: float, rtol: float = 0.01
) -> MeasuredMargin:
    """A margin, or the first loss of stability before it, where there is one.

    Tried are 60 numbers between the start and the margin, evenly spaced, or in the logarithm where they
    are more than tenfold apart. A loop that is unstable at one of them is not stable up to the margin.

    Parameters
    ----------
    stable : function of float
        Whether the loop is stable for a number.
    found : MeasuredMargin
        From :func:`bisect_margin`; one without a value is returned as it is.
    start : float
        Number at which the loop is stable, from which the margin was sought.
    rtol : float
        Relative width of the bracket of the first loss.
    """
    end = found.value
    if end is None or end == start:
        return found
    spaced = np.geomspace if start > 0.0 and end / start > SPREAD else np.linspace
    before = start
    for count, one in enumerate(spaced(start, end, SCANNED + 2)[1:-1].tolist(), 1):
        if not stable(one):
            first = bisect_margin(stable, min(before, one), max(before, one), rtol)
            return replace(first, runs=found.runs + count + first.runs, stands_again_to=end)
        before = one
    return replace(found, runs=found.runs + SCANNED)


def checked_at_half_step(stable: Callable[[float], bool], found: MeasuredMargin) -> MeasuredMargin:
    """A margin with what becomes of it at half of the step.

    Both ends of its bracket are tried; where one changes its mind, so is the number 5 % beyond it. If that one is as it
    was the margin has moved, but by less than 5 %, and is as found.

    Parameters
    ----------
    stable : function of float
        Whether the loop is stable for a number, with half of the step.
    found : MeasuredMargin
        From :func:`bisect_margin`; one without a value is returned as it is.
    """
    if found.value is None or found.unstable_from is None:
        return found
    beyond = 1.0 + MOVES if found.unstable_from > found.value else 1.0 / (1.0 + MOVES)
    ends, runs = (stable(found.value), stable(found.unstable_from)), 2
    told: AtHalfStep = "as found"
    if ends != (True, False):
        runs += 1
        if not ends[0]:
            told = "as found" if stable(found.value / beyond) else "lost earlier"
        else:
            told = "lost later" if stable(found.unstable_from * beyond) else "as found"
    return replace(found, runs=found.runs + runs, at_half_step=told)


def measured_margins(
    simulate: Simulate,
    *,
    bound: float,
    lowest_gain: float = 0.01,
    highest_gain: float = 100.0,
    longest_delay: float = 0.2,
    rtol: float = 0.01,
) -> MeasuredMargins:
    """Measure gain and delay margins of a loop by bisection on whole simulations.

    What is found holds for the scenario that is simulated, its start and its duration: a nonlinear loop has no margin
    as such. Near a margin a run of finite length can't tell slow decay from slow growth; longer runs come nearer.

    Parameters
    ----------
    simulate : function of (gain, delay)
        See :data:`Simulate`.
    bound : float
        Error that may remain (m); see :func:`bounded_at_the_end`.
    lowest_gain, highest_gain : float
        Ends of the factors of the loop gain that are tried, about 1.
    longest_delay : float
        Longest delay that is tried, s.
    rtol : float
        Relative tolerance of each margin.
    """

    def stable(gain: float, delay: float) -> bool:
        found = simulate(gain, delay)
        return found is not None and bounded_at_the_end(*found, bound)

    if not stable(1.0, 0.0):
        none = MeasuredMargin(None, None, 1, "not stable as it is, with gain 1 and no delay")
        return MeasuredMargins(none, none, none)
    return MeasuredMargins(
        gain_lower=bisect_margin(lambda gain: stable(gain, 0.0), lowest_gain, 1.0, rtol),
        gain_upper=bisect_margin(lambda gain: stable(gain, 0.0), 1.0, highest_gain, rtol),
        delay=bisect_margin(lambda delay: stable(1.0, delay), 0.0, longest_delay, rtol),
    )
