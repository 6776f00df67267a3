"""How fast a path may be driven: its length, cruising speed, acceleration and duration within the limits.

The speed rises from rest along the polynomial of minimum jerk whose first acceleration is free, 3/2 s - 1/2 s^3,
cruises, and falls along its mirror image. It begins and ends with an acceleration, so that the robot leaves and
reaches rest regularly: there z'' is parallel to the heading and not zero. Nothing here switches: maxima along the
path are norms of high order over Gauss points, which lie a little above them, and so the time is a smooth expression.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from brunovsky.blocks.library.references.pieces import quintic
from brunovsky.blocks.library.rest_to_rest.path import PARAMETER, hermite

Array = NDArray[np.float64]

NODES = 24
"""Gauss points on a path."""
ORDER = 8
"""Of the norms that stand for maxima; even."""
SPEED_SHARE = 0.95
"""Part of the limit of speed that plans use."""
TURN_SHARE = 0.2
"""Part of the yaw acceleration that a rising speed may take, u2 = k' V^2 + k V'; the remainder is for the cruise."""
SHARPNESS = 1.5
"""A path that turns by more than about 1/SHARPNESS rad from one Gauss point to the next costs much: it has a cusp."""


@dataclass(frozen=True)
class Limits:
    """What a manoeuvre must not exceed: speed (m/s), forward (m/s2) and yaw acceleration (rad/s2), as expressions."""

    speed: sp.Expr
    acceleration: sp.Expr
    yaw_acceleration: sp.Expr

    def planned(self, reserve: sp.Expr) -> Limits:
        """What a plan uses of them: of the accelerations all but the reserve, a part from 0 to 1."""
        return Limits(
            SPEED_SHARE * self.speed, (1 - reserve) * self.acceleration, (1 - reserve) * self.yaw_acceleration
        )


@dataclass(frozen=True)
class Timing:
    """How a path is driven: length (m), cruising speed (m/s), first acceleration (m/s2), and how much it costs (s)."""

    length: sp.Expr
    speed: sp.Expr
    acceleration: sp.Expr
    cost: sp.Expr


def rise_time(speed: sp.Expr, acceleration: sp.Expr) -> sp.Expr:
    """Time from rest to a speed with a given first acceleration, s."""
    return sp.Rational(3, 2) * speed / acceleration


def duration(length: sp.Expr, speed: sp.Expr, acceleration: sp.Expr) -> sp.Expr:
    """Time from rest to rest, s, where the cruise is not of negative length."""
    return length / speed + sp.Rational(3, 4) * rise_time(speed, acceleration)


def rise(fraction: sp.Expr) -> sp.Expr:
    """Part of the cruising speed after a fraction of the rise time: minimum jerk, the first acceleration free."""
    return sp.Rational(3, 2) * fraction - sp.Rational(1, 2) * fraction**3


def swept(fraction: sp.Expr) -> sp.Expr:
    """Part of a turn in place after a fraction of its time: minimum jerk, accelerations at the ends free.

    From rest to rest without jerk at the ends, which is what free accelerations ask for: 5/2 s^2 - 5/2 s^4 + s^5.
    """
    coefficients = quintic((0, 1, 3)) * sp.Matrix([0, 0, 0, 1, 0, 0])
    return sum((c * fraction**k for k, c in enumerate(coefficients)), sp.S.Zero)


def turning_time(angle: sp.Expr, acceleration: sp.Expr) -> sp.Expr:
    """Time of a turn in place of this size (not negative) within a yaw acceleration, s: it begins with 5 angle/T^2."""
    return sp.sqrt(5 * angle / acceleration)


def path_timing(along: sp.Expr, left: sp.Expr, turn: sp.Expr, tangent: sp.Expr, limits: Limits) -> Timing:
    """Timing of the quintic path between two poses.

    Parameters
    ----------
    along, left, turn : Expr
        The second pose as the first one sees it: m, m, rad.
    tangent : Expr
        Derivative of the path at its ends, m.
    limits : Limits
        What it may use.

    Returns
    -------
    Timing
        ``cost`` is the duration, but far more for a path with a cusp, whose peaks the points cannot see.
    """
    products = _Products.of(along, left, turn, tangent)
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    length = sharpness = turns = sp.S.Zero
    bends = []
    for node, weight in zip(nodes, weights, strict=True):
        first, second, third = (_basis(order, (node + 1) / 2) for order in (1, 2, 3))
        speed2 = products.dot(first, first)
        cross = products.cross(first, second)
        slope = (products.cross(first, third) - 3 * cross * products.dot(first, second) / speed2) / speed2**2
        length += sp.Float(weight / 2) * sp.sqrt(speed2)
        bends.append((cross**2 / speed2**3) ** (ORDER // 2))
        turns += slope**ORDER
        sharpness += ((SHARPNESS / NODES) ** 2 * products.dot(second, second) / speed2) ** (ORDER // 2)
    least, most_yaw = 2 * ORDER, TURN_SHARE * limits.yaw_acceleration
    bent = [
        sp.Add(*bends[::2]),
        sp.Add(*bends[1::2]),
    ]  # in a power of two terms SymPy asks for seconds if one is infinite
    steepness = sp.Add(
        limits.acceleration**-least, *(one * sp.Add(*bends) / most_yaw**least for one in bent)
    ) ** sp.Rational(1, least)
    slowness = (
        limits.speed**-least
        + (sp.Rational(15, 8) * steepness / length) ** ORDER
        + turns / ((1 - TURN_SHARE) * limits.yaw_acceleration) ** ORDER
    ) ** sp.Rational(1, least)
    speed, acceleration = 1 / slowness, 1 / steepness
    return Timing(length, speed, acceleration, duration(length, speed, acceleration) * (1 + sharpness))


@dataclass(frozen=True)
class _Products:
    """Scalar and cross products of the displacement and the two tangents, of which all others along a path are made."""

    dots: tuple[tuple[sp.Expr, ...], ...]
    crosses: tuple[tuple[sp.Expr, ...], ...]

    @classmethod
    def of(cls, along: sp.Expr, left: sp.Expr, turn: sp.Expr, tangent: sp.Expr) -> _Products:
        vectors = (
            sp.Matrix([along, left]),
            sp.Matrix([tangent, 0]),
            tangent * sp.Matrix([sp.cos(turn), sp.sin(turn)]),
        )
        return cls(
            tuple(tuple(sp.trigsimp(sp.expand(a.dot(b))) for b in vectors) for a in vectors),
            tuple(tuple(sp.expand(a[0] * b[1] - a[1] * b[0]) for b in vectors) for a in vectors),
        )

    def dot(self, first: Array, second: Array) -> sp.Expr:
        """Scalar product of two vectors given by their weights."""
        return self._sum(self.dots, np.outer(first, second))

    def cross(self, first: Array, second: Array) -> sp.Expr:
        """Cross product of two vectors given by their weights."""
        return self._sum(self.crosses, np.outer(first, second))

    @staticmethod
    def _sum(products: tuple[tuple[sp.Expr, ...], ...], weights: Array) -> sp.Expr:
        return sp.Add(*(sp.Float(weights[i, j]) * products[i][j] for i in range(3) for j in range(3)))


def _basis(order: int, at: float) -> Array:
    """Derivatives of the parts of :func:`hermite` that multiply displacement, first and last tangent, shape (3,)."""
    return np.array([float(one.subs(PARAMETER, at)) for one in _basis_expressions(order)])


@cache
def _basis_expressions(order: int) -> tuple[sp.Expr, ...]:
    names = sp.symbols("displacement first last")
    curve = hermite(*(sp.Matrix([one, 0]) for one in names))[0]
    return tuple(curve.diff(one).diff(PARAMETER, order) for one in names)
