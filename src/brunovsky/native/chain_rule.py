"""Derivatives of expressions by the chain rule, in one pass over each, unlike a sum over partial derivatives."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

import sympy as sp


class ChainRule:
    """Derivative of expressions whose symbols move at given rates; each subexpression is differentiated once.

    Relations in the conditions of branches are constants, as between events.

    Parameters
    ----------
    rates : mapping of Symbol to Expr
        Derivatives of the symbols; those that are not in it are constant. Symbols may be added later, if no expression
        asked for so far has them.
    """

    def __init__(self, rates: Mapping[sp.Symbol, sp.Expr]) -> None:
        self._rates = rates
        self._known: dict[sp.Expr, sp.Expr] = {}

    def __call__(self, expression: sp.Expr) -> sp.Expr:
        """Derivative of an expression."""
        if expression.is_Atom:
            return self._rates.get(expression, sp.S.Zero)
        if expression not in self._known:
            self._known[expression] = self._differentiated(expression)
        return self._known[expression]

    def _differentiated(self, expression: sp.Expr) -> sp.Expr:
        args = expression.args
        if isinstance(expression, sp.Piecewise):
            return sp.Piecewise(*((self(value), condition) for value, condition in args))
        rates = [self(one) for one in args]
        if isinstance(expression, sp.Add):
            return sp.Add(*rates)
        moving = [(index, rate) for index, rate in enumerate(rates) if rate != 0]
        if isinstance(expression, sp.Mul):
            return sp.Add(*(sp.Mul(*args[:index], rate, *args[index + 1 :]) for index, rate in moving))
        if isinstance(expression, sp.Pow) and rates[1] == 0:  # finite where the base is 0
            return args[1] * args[0] ** (args[1] - 1) * rates[0]
        return sp.Add(*(_partial(expression, index) * rate for index, rate in moving))


def _partial(expression: sp.Expr, index: int) -> sp.Expr:
    """Derivative of a function by one of its arguments."""
    places, derivative = _derivative(expression.func, len(expression.args), index)
    return derivative.xreplace(dict(zip(places, expression.args, strict=True)))


@lru_cache(maxsize=256)
def _derivative(function: type[sp.Expr], count: int, index: int) -> tuple[tuple[sp.Dummy, ...], sp.Expr]:
    """Symbols that stand for the arguments of a function, and its derivative by one of them."""
    places = tuple(sp.Dummy() for _ in range(count))
    return places, sp.diff(function(*places), places[index])
