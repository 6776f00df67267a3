"""What minimum-jerk references share: polynomials of fifth degree, their boundary, the switch from piece to piece."""

from __future__ import annotations

from collections.abc import Sequence
from math import perm
from typing import Literal

import sympy as sp

from brunovsky.blocks.variables import TIME, Relation
from brunovsky.errors import ModelError

Acceleration = Literal["given", "free"]
SHORTEST = 1e-3
"""Shortest duration of a piece, s."""
EARLY = 1e-9
"""A piece begins this much early, s: rounding of time must not cost it the step that begins at its knot."""


def check_acceleration(block: str, acceleration: str) -> None:
    """Refuse a boundary that does not exist.

    Raises
    ------
    ModelError
        The message has the names.
    """
    if acceleration not in ("given", "free"):
        raise ModelError(f"{block}: there is no acceleration {acceleration!r}; use 'given' or 'free'")


def switches(knots: Sequence[sp.Expr]) -> tuple[Relation, ...]:
    """Relations ``before_knot_k``, true until the k-th of the knots (s)."""
    return tuple(Relation(f"before_knot_{k}", knot - EARLY - TIME) for k, knot in enumerate(knots, 1))


def in_turn(pieces: Sequence[sp.Expr], before: Sequence[Relation]) -> sp.Expr:
    """Pieces one after the other, each until its relation is false; the last one, which has none, for ever."""
    conditions = [one.symbol for one in before]
    return sp.Piecewise(*zip(pieces, [*conditions, sp.true], strict=True))


def derivative_row(order: int, place: int) -> list[int]:
    """Row that takes the coefficients of a polynomial of fifth degree in s to a derivative at ``place``, shape (6,)."""
    return [perm(power, order) * place ** max(power - order, 0) for power in range(6)]


def quintic(orders: Sequence[int]) -> sp.Matrix:
    """From three derivatives at s = 0 and at s = 1 to the coefficients of the polynomial in s, shape (6, 6), exact."""
    return sp.Matrix([derivative_row(order, place) for place in (0, 1) for order in orders]).inv()
