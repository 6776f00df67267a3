"""Lie derivatives of functions and Lie brackets of vector fields."""

from collections.abc import Sequence
from typing import Any

import sympy as sp

from brunovsky.errors import ModelError


def _column(field: Any, states: Sequence[sp.Symbol], what: str, order: int) -> sp.Matrix:
    column = sp.Matrix(list(field))
    if len(column) != len(states):
        raise ModelError(f"{what} has {len(column)} entries for {len(states)} states; give one entry per state")
    if order < 0:
        raise ModelError(f"the order is {order}; give 0, 1, 2, …")
    return column


def lie_derivative(function: sp.Expr, field: Any, states: Sequence[sp.Symbol], order: int = 1) -> sp.Expr:
    """Differentiate a function along a vector field: L_f^k h with L_f h = (dh/dx) f.

    Parameters
    ----------
    function : sympy.Expr
        The scalar h(x).
    field : sequence of sympy.Expr or sympy.Matrix
        The vector field f(x), one entry per state.
    states : sequence of sympy.Symbol
        The coordinates x, shape (n,).
    order : int
        How often, k >= 0; order 0 is the function itself.

    Returns
    -------
    sympy.Expr
        L_f^k h, not simplified. Its unit is that of h over s^k where f is the right-hand side of x' = f(x).

    Raises
    ------
    ModelError
        If the field has not one entry per state or the order is negative.

    References
    ----------
    A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, section 1.2, doi:10.1007/978-1-84628-615-5.
    """
    column = _column(field, states, "the vector field", order)
    result = sp.sympify(function)
    for _ in range(order):
        result = sp.Add(*(sp.diff(result, state) * entry for state, entry in zip(states, column, strict=True)))
    return result


def lie_bracket(f: Any, g: Any, states: Sequence[sp.Symbol], order: int = 1) -> sp.ImmutableDenseMatrix:
    """Bracket of two vector fields: ad_f^k g with ad_f g = [f, g] = (dg/dx) f - (df/dx) g.

    Parameters
    ----------
    f, g : sequence of sympy.Expr or sympy.Matrix
        The vector fields, one entry per state.
    states : sequence of sympy.Symbol
        The coordinates x, shape (n,).
    order : int
        How often, k >= 0; order 0 is g itself.

    Returns
    -------
    sympy.ImmutableDenseMatrix
        ad_f^k g, shape (n, 1), not simplified.

    Raises
    ------
    ModelError
        If a field has not one entry per state or the order is negative.

    References
    ----------
    A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, section 1.2, doi:10.1007/978-1-84628-615-5.
    """
    left, right = _column(f, states, "the field f", order), _column(g, states, "the field g", order)
    coordinates = sp.Matrix(list(states))
    for _ in range(order):
        right = right.jacobian(coordinates) * left - left.jacobian(coordinates) * right
    return sp.ImmutableDenseMatrix(right)
