"""How fast a path may be driven: its length, cruising speed, acceleration and duration within the limits.

The speed rises from rest along the polynomial of minimum jerk whose first acceleration is free, 3/2 s - 1/2 s^3, cruises,
and falls along its mirror image. It begins and ends with an acceleration, so that the robot leaves and reaches rest
regularly: there z'' is parallel to the heading and not zero. Nothing here switches: maxima along the path are norms of
high order over Gauss points, which lie a little above them, and so the time is a smooth expression.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
import sympy as sp

from brunovsky.blocks.library.rest_to_rest.path import PARAMETER, hermite

NODES = 24
"""Gauss points on a path."""
ORDER = 8
"""Of the norms that stand for maxima; even."""
RESERVE = 0.75
"""Part of the limits of acceleration that plans use; the rest is for what disturbs and for the law that tracks."""
SPEED_RESERVE = 0.95
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

    @property
    def planned(self) -> Limits:
        """What a plan uses of them."""
        return Limits(SPEED_RESERVE * self.speed, RESERVE * self.acceleration, RESERVE * self.yaw_acceleration)


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


def turned(fraction: sp.Expr) -> sp.Expr:
    """Part of a turn in place after a fraction of its time: minimum jerk, accelerations at the ends free."""
    return sp.Rational(5, 2) * fraction**2 - sp.Rational(5, 2) * fraction**4 + fraction**5


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
    ends = ((along, left), (tangent, sp.S.Zero), (tangent * sp.cos(turn), tangent * sp.sin(turn)))
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    length = bends = sharpness = turns = sp.S.Zero
    for node, weight in zip(nodes, weights, strict=True):
        d1, d2, d3 = (_derivative(ends, order, (node + 1) / 2) for order in (1, 2, 3))
        speed2 = d1.dot(d1)
        cross = d1[0] * d2[1] - d1[1] * d2[0]
        slope = (d1[0] * d3[1] - d1[1] * d3[0] - 3 * cross * d1.dot(d2) / speed2) / speed2**2
        length += sp.Float(weight / 2) * sp.sqrt(speed2)
        bends += (cross**2 / speed2**3) ** (ORDER // 2)
        turns += (slope**2) ** (ORDER // 2)
        sharpness += ((SHARPNESS / NODES) ** 2 * d2.dot(d2) / speed2) ** (ORDER // 2)
    least = 2 * ORDER
    steepness = (
        limits.acceleration**-least + bends**2 / (TURN_SHARE * limits.yaw_acceleration) ** least
    ) ** sp.Rational(1, least)
    slowness = (
        limits.speed**-least
        + (sp.Rational(15, 8) * steepness / length) ** ORDER
        + turns / ((1 - TURN_SHARE) * limits.yaw_acceleration) ** ORDER
    ) ** sp.Rational(1, least)
    speed, acceleration = 1 / slowness, 1 / steepness
    return Timing(length, speed, acceleration, duration(length, speed, acceleration) * (1 + sharpness))


def _derivative(ends: Sequence[tuple[sp.Expr, sp.Expr]], order: int, at: float) -> sp.Matrix:
    """Derivative of :func:`hermite` by its parameter at a number; ``ends`` are its three vectors."""
    weights = [one.subs(PARAMETER, at) for one in _basis(order)]
    return sp.Matrix([sum(weight * one[k] for weight, one in zip(weights, ends, strict=True)) for k in (0, 1)])


@cache
def _basis(order: int) -> tuple[sp.Expr, ...]:
    """Derivatives of the parts of :func:`hermite` that multiply displacement, first and last tangent."""
    names = sp.symbols("displacement first last")
    curve = hermite(*(sp.Matrix([one, 0]) for one in names))[0]
    return tuple(curve.diff(one).diff(PARAMETER, order) for one in names)
