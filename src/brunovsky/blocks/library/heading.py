"""Directions that belong to the robot's heading, derived from its equations of motion."""

from __future__ import annotations

from functools import lru_cache

import sympy as sp

from brunovsky.blocks.library.robot import robot_system
from brunovsky.blocks.variables import symbol, symbols


@lru_cache
def _along() -> sp.ImmutableDenseMatrix:
    """Velocity in the plane for each unit of forward velocity, at the heading ``theta``."""
    system = robot_system()
    slopes = dict(zip(system.states, system.dynamics, strict=True))
    return sp.ImmutableDenseMatrix([slopes[one] for one in symbols("x", "y")]).diff(symbol("eta[1]"))


def direction(angle: sp.Expr) -> sp.Matrix:
    """Unit vector along which the robot drives at a heading, (-sin, cos), shape (2, 1)."""
    return sp.Matrix(_along().subs(symbol("theta"), angle))


def turned(vector: sp.Matrix) -> sp.Matrix:
    """Vector of the plane, turned by a right angle to the left, shape (2, 1)."""
    return sp.Matrix([-vector[1], vector[0]])
