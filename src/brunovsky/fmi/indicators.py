"""Event indicators as variables: each with a name, the unit of its expression and what happens at its zero."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from brunovsky.blocks import TIME, Block
from brunovsky.blocks.units import BASE_UNITS, unit_exponents
from brunovsky.blocks.variables import NAME
from brunovsky.fmi.interfaces import has_model_exchange

Exponents = tuple[sp.Rational, ...]
_LONGEST = 100
"""Characters of an expression that a description still quotes."""


@dataclass(frozen=True)
class Indicator:
    """A function whose zero crossings are events of a relation."""

    name: str
    unit: str
    description: str
    expression: sp.Expr


def indicators(block: Block) -> tuple[Indicator, ...]:
    """Event indicators of a block, in the order of :attr:`brunovsky.blocks.Block.indicators`.

    Each is called ``indicator_NAME`` by the relation it belongs to (``part.indicator_NAME`` for one of a diagram's
    part). Where the unit of its expression cannot be found out it is ``"1"``. Without model exchange, which alone reads
    them, there are none.
    """
    if not has_model_exchange(block):
        return ()
    taken = {one.name for one in block.variables} | {one.name for one in block.clocks} | {"time", "step_size", "solver"}
    units = {one.symbol: unit_exponents(one.unit) for one in block.variables} | {TIME: unit_exponents("s")}
    written = {unit_exponents(one.unit): one.unit for one in reversed(block.variables)}
    names = {one.symbol: sp.Symbol(one.name) for one in block.variables}
    found = []
    for number, expression in enumerate(block.indicators, 1):
        relation = next(
            one for one in block.relations if expression == (one.expression if one.indicator is None else one.indicator)
        )
        name = _free(_name(relation.name, number), taken)
        taken.add(name)
        exponents = _exponents(expression, units)
        unit = "1" if exponents is None else written.get(exponents) or _text(exponents)
        text = str(expression.xreplace(names))
        what = f"{text}: " if len(text) <= _LONGEST else ""
        found.append(Indicator(name, unit, f"{what}at its zero relation {relation.name} changes", expression))
    return tuple(found)


def _name(relation: str, number: int) -> str:
    part, dot, own = relation.rpartition(".")
    name = f"{part}{dot}indicator_{own}"
    return name if NAME.fullmatch(name) else f"indicator_{number}"


def _free(name: str, taken: set[str]) -> str:
    return name if name not in taken else _free(re.sub(r"(\[[\d,]+\])?$", r"_\1", name, count=1), taken)


def _exponents(expression: sp.Basic, units: Mapping[sp.Symbol, tuple[int, ...]]) -> tuple[int, ...] | None:
    """Exponents of the unit of an expression, in the order of BASE_UNITS; none if it has no unit by itself.

    Inside expressions rad is 1, so that terms that differ in rad alone may be added; the sum then has none.
    """
    found = _dimension(expression, units)
    if found is None or any(not one.is_Integer for one in found):
        return None
    return tuple(int(one) for one in found)


def _dimension(expression: sp.Basic, units: Mapping[sp.Symbol, tuple[int, ...]]) -> Exponents | None:
    """The same in rational exponents; numbers fit any sum, so that those of a sum's numbers are passed over."""
    if isinstance(expression, sp.Symbol):
        known = units.get(expression)
        return None if known is None else tuple(map(sp.Integer, known))
    if isinstance(expression, sp.Mul):
        factors = [_dimension(one, units) for one in expression.args]
        return None if None in factors else tuple(map(sum, zip(*factors, strict=True)))
    if isinstance(expression, sp.Pow) and expression.exp.is_Rational:
        base = _dimension(expression.base, units)
        return None if base is None else tuple(one * expression.exp for one in base)
    if isinstance(expression, sp.Add):
        return _common([_dimension(one, units) for one in expression.args if not one.is_number])
    if isinstance(expression, sp.Piecewise):
        return _common([_dimension(value, units) for value, _ in expression.args if not value.is_number])
    return tuple(sp.Integer(0) for _ in BASE_UNITS) if isinstance(expression, sp.Expr) else None


def _common(terms: list[Exponents | None]) -> Exponents | None:
    if not terms or None in terms:
        return None
    if len(set(terms)) == 1:
        return terms[0]
    plain = {(*one[:-1], sp.Integer(0)) for one in terms if one is not None}
    return plain.pop() if len(plain) == 1 else None


def _text(exponents: tuple[int, ...]) -> str:
    """A unit with these exponents: ``"kg.m2/s3"``."""

    def power(name: str, exponent: int) -> str:
        return name if exponent == 1 else f"{name}{exponent}"

    pairs = list(zip(BASE_UNITS, exponents, strict=True))
    over = ".".join(power(name, exponent) for name, exponent in pairs if exponent > 0)
    return (over or "1") + "".join(f"/{power(name, -exponent)}" for name, exponent in pairs if exponent < 0)
