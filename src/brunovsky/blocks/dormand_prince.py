"""The embedded Runge-Kutta pair of Dormand and Prince, 5(4): one step, its error, its interior, the size of the next.

Source: E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I, 2nd ed., Springer 1993,
table II.5.2 (the pair), eqs. II.4.11 and II.4.13 (error and step size), II.4 "starting step size", and section II.6
(interpolation of order 4). ISBN 978-3-540-56670-0.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

NODES = (0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0)
MATRIX = (
    (),
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
)
"""Its last row are the weights of order 5, so that the last slope is the first one of the next step."""

ERROR = (71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40)
"""Weights of order 5 less those of order 4."""

INTERIOR = (
    -12715105075 / 11282082432,
    0.0,
    87487479700 / 32700410799,
    -10690763975 / 1880347072,
    701980252875 / 199316789632,
    -1453857185 / 822651844,
    69997945 / 29380423,
)
"""Weights of the highest term of the interpolation."""

ABSOLUTE = 0.01  # absolute tolerance of a state as part of the relative one, in units of its nominal value
SAFETY, SMALLEST_FACTOR, LARGEST_FACTOR = 0.9, 0.2, 5.0

Array = np.ndarray[Any, np.dtype[np.float64]]
Slope = Callable[[float, Array], Array]


@dataclass(frozen=True)
class Step:
    """A step that was tried: where each slope was taken, and the slopes, shape (7, n)."""

    size: float
    points: tuple[tuple[float, Array], ...]
    slopes: Array

    @property
    def end(self) -> Array:
        """States at the end, of order 5."""
        return self.points[-1][1]

    def at(self, fraction: float) -> Array:
        """States within the step, by interpolation of order 4."""
        start, rise, other = self.points[0][1], self.end - self.points[0][1], 1.0 - fraction
        bend = self.size * self.slopes[0] - rise
        back = rise - self.size * self.slopes[6] - bend
        high = self.size * _weighted(INTERIOR, self.slopes)
        states: Array = start + fraction * (rise + other * (bend + fraction * (back + other * high)))
        return states

    def error(self, tolerance: float, nominal: Array) -> float:
        """Estimated error, 1 at the tolerance; NaN or infinity where the step is not finite."""
        if not np.isfinite(self.end).all():
            return float("nan")
        with np.errstate(all="ignore"):
            weights = _scale(tolerance, nominal, self.points[0][1], self.end)
            return _norm(self.size * _weighted(ERROR, self.slopes) / weights)


def attempt(slope: Slope, time: float, start: Array, first: Array, size: float) -> Step:
    """Step of this size; ``first`` is the slope at its start."""
    points, slopes = [(time, start)], [first]
    with np.errstate(all="ignore"):
        for node, row in zip(NODES[1:], MATRIX[1:], strict=True):
            points.append((time + node * size, start + size * _weighted(row, slopes)))
            slopes.append(slope(*points[-1]))
    return Step(size, tuple(points), np.array(slopes))


def first_size(
    slope: Slope, time: float, start: Array, first: Array, longest: float, tolerance: float, nominal: Array
) -> float:
    """Size to begin with, from the first two derivatives of the states."""
    with np.errstate(all="ignore"):
        weights = _scale(tolerance, nominal, start, start)
        states, slopes = _norm(start / weights), _norm(first / weights)
        trial = 1e-6 if states < 1e-5 or slopes < 1e-5 else 0.01 * states / slopes
        trial = min(trial, longest)
        bend = _norm((slope(time + trial, start + trial * first) - first) / weights) / trial
    largest = max(slopes, bend)
    size = max(1e-6, 1e-3 * trial) if largest <= 1e-15 else (0.01 / largest) ** 0.2
    return min(100 * trial, size, longest) if np.isfinite(largest) and size > 0 else trial


def factor(error: float) -> float:
    """How much longer the next step may be, below 1 after an error above 1."""
    if not np.isfinite(error):
        return SMALLEST_FACTOR
    return min(LARGEST_FACTOR, max(SMALLEST_FACTOR, SAFETY * error**-0.2 if error else LARGEST_FACTOR))


def _weighted(weights: tuple[float, ...], slopes: Any) -> Any:
    total = weights[0] * slopes[0]
    for weight, one in zip(weights[1:], slopes[1:], strict=True):
        total = total + weight * one
    return total


def _scale(tolerance: float, nominal: Array, one: Array, other: Array) -> Array:
    scale: Array = ABSOLUTE * tolerance * nominal + tolerance * np.maximum(abs(one), abs(other))
    return scale


def _norm(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else 0.0
