"""Path from one resting pose to another: a quintic Hermite curve with zero curvature at both ends."""

from __future__ import annotations

from dataclasses import dataclass

import sympy as sp

from brunovsky.blocks.library.heading import direction
from brunovsky.blocks.library.references.pieces import quintic

PARAMETER = sp.Symbol("s", real=True)
"""Path parameter, 0 at the start and 1 at the end."""


def wrapped(angle: sp.Expr) -> sp.Expr:
    """The same angle within half a turn of 0, without a switching function."""
    return sp.atan2(sp.sin(angle), sp.cos(angle))


def hermite(displacement: sp.Matrix, first: sp.Matrix, last: sp.Matrix, s: sp.Expr = PARAMETER) -> sp.Matrix:
    """Quintic curve from the origin with given tangents and no second derivative at its ends.

    Parameters
    ----------
    displacement : Matrix, shape (2, 1)
        Where it ends, m.
    first, last : Matrix, shape (2, 1)
        Derivative by the path parameter at the start and at the end, m.
    s : Expr
        Path parameter from 0 to 1.

    Returns
    -------
    Matrix, shape (2, 1)
        Position, m. Six conditions, six coefficients: the curve is the only one of its degree.
    """
    nothing = sp.zeros(2, 1)
    boundary = sp.Matrix.hstack(nothing, first, nothing, displacement, last, nothing)
    powers = sp.Matrix([[s**k for k in range(6)]])
    return (powers * quintic((0, 1, 2)) * boundary.T).T


@dataclass(frozen=True)
class Pose:
    """Where a robot rests: position (m) and heading (rad)."""

    x: sp.Expr
    y: sp.Expr
    heading: sp.Expr

    @property
    def position(self) -> sp.Matrix:
        """Shape (2, 1), m."""
        return sp.Matrix([self.x, self.y])

    def reach(self, other: Pose, length: sp.Expr) -> sp.Expr:
        """Distance to another pose, m, where a turn counts as ``length`` times its angle; zero for equal poses only."""
        gap = other.position - self.position
        return sp.sqrt(gap.dot(gap) + (length * wrapped(other.heading - self.heading)) ** 2)

    def path_to(self, other: Pose, tangent: sp.Expr) -> sp.Matrix:
        """Position along the path to another pose; ``tangent`` (m), negative backward, is its slope at the ends."""
        curve = hermite(
            other.position - self.position, tangent * direction(self.heading), tangent * direction(other.heading)
        )
        return self.position + curve


def curvature(path: sp.Matrix) -> sp.Expr:
    """Curvature of a path in its parameter, 1/m, positive to the left."""
    d1, d2 = path.diff(PARAMETER), path.diff(PARAMETER, 2)
    return (d1[0] * d2[1] - d1[1] * d2[0]) / d1.dot(d1) ** sp.Rational(3, 2)


def path_speed(path: sp.Matrix) -> sp.Expr:
    """Length per path parameter, m."""
    tangent = path.diff(PARAMETER)
    return sp.sqrt(tangent.dot(tangent))
