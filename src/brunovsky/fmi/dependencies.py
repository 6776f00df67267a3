"""How an unknown of an FMU depends on its knowns: which enter at all, and each with what kind of factor.

A factor is the derivative of the frozen branch. It is ``constant``, ``fixed``, ``tunable`` or ``discrete`` if nothing
else than numbers, fixed parameters, tunable parameters or what only events change is in it, and if the known decides
no relation beside; ``dependent`` otherwise.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache

import sympy as sp

from brunovsky.blocks import Block, Sample, State, Variable
from brunovsky.blocks.relations import symbols_in
from brunovsky.native.jacobian import SparseMatrix, columns, differentiated, jacobian

Factors = dict[sp.Symbol, sp.Expr]
Kinds = dict[sp.Symbol, str]


def _rows(
    expressions: Sequence[sp.Basic], matrix: SparseMatrix, symbols: Sequence[sp.Symbol]
) -> dict[sp.Basic, Factors]:
    """Derivatives of expressions, which are the rows of a matrix, by the symbols of its columns."""
    return {
        expression: {symbols[column]: entry for column, entry in row.items()}
        for expression, row in zip(expressions, matrix.by_row(len(expressions)), strict=True)
    }


@lru_cache(maxsize=64)
def _known_factors(block: Block) -> Mapping[sp.Basic, Factors]:
    derivatives, symbols = jacobian(block), columns(block)
    started: tuple[State | Sample, ...] = (*block.states, *block.samples)
    equations = [*(one.derivative for one in block.states), *(one.expression for one in block.outputs)]
    return (
        _rows(block.indicators, differentiated(block.indicators, symbols), symbols)
        | _rows([one.start for one in started], derivatives.starts, [one.symbol for one in block.parameters])
        | _rows(equations, derivatives.equations, symbols)
        | _rows([one.update for one in block.samples], derivatives.updates, symbols)
    )


def _factors(known: Mapping[sp.Basic, Factors], expression: sp.Basic, symbols: Collection[sp.Symbol]) -> Factors:
    """Derivatives of an expression, looked up if it is an equation of the block."""
    if expression in known:
        return known[expression]
    if not isinstance(expression, sp.Expr):
        return {}
    return {one: sp.diff(expression, one) for one in symbols_in(expression) & set(symbols)}


class RunningDependencies:
    """Dependencies after initialisation: states, samples and modes are what they are.

    The knowns are time, inputs, states and parameters.

    Parameters
    ----------
    block : Block
        Whose expressions are asked for.
    """

    def __init__(self, block: Block) -> None:
        self._knowns = frozenset(columns(block)) - {one.symbol for one in block.samples}
        self._behind = {one.symbol: block.depends_on(one.symbol) for one in block.relations}
        fixed = {one.symbol for one in block.parameters if not one.tunable}
        tunable = fixed | {one.symbol for one in block.parameters}
        held: tuple[Variable, ...] = (*block.samples, *block.modes)
        discrete = tunable | {one.symbol for one in held} | self._behind.keys()
        self._levels = {"constant": set(), "fixed": fixed, "tunable": tunable, "discrete": discrete}
        self._factors = _known_factors(block)

    def __call__(self, expression: sp.Basic) -> Kinds:
        """Kind of each known that an expression depends on."""
        factors = _factors(self._factors, expression, self._knowns)
        relations = symbols_in(expression) & self._behind.keys()
        deciding = {one: {r for r in relations if one in self._behind[r]} for one in self._knowns}
        return {
            one: self._kind(expression, one, factors.get(one, sp.S.Zero), deciding[one])
            for one in self._knowns
            if one in factors or deciding[one]
        }

    def _kind(self, expression: sp.Basic, known: sp.Symbol, factor: sp.Expr, deciding: Collection[sp.Symbol]) -> str:
        inside = symbols_in(factor)
        kind = next((name for name, symbols in self._levels.items() if inside <= symbols), "dependent")
        if not deciding or kind == "dependent":
            return kind
        # linear in each branch; the branches must not differ where the known is 0
        rest = expression.xreplace({known: sp.S.Zero})
        return "dependent" if factor == 0 or symbols_in(rest) & set(deciding) else kind


class InitialDependencies:
    """Dependencies in initialisation mode, where states, samples and modes come of the others at the first instant.

    What a transition may assign is taken as depending on everything behind its guard and value. Kinds are ``constant``
    and ``dependent`` alone, as the standard asks.

    Parameters
    ----------
    block : Block
        Whose expressions are asked for.
    """

    def __init__(self, block: Block) -> None:
        self._block = block
        self._factors = _known_factors(block)
        assigned = {target for one in block.transitions for target in one.assign}
        started: tuple[State | Sample, ...] = (*block.states, *block.samples)
        self._opaque = {one.symbol for one in block.relations} | (assigned - {one.symbol for one in started})
        self._numbers: Factors = {one.symbol: sp.Integer(one.start) for one in block.modes}
        self._numbers |= {one.symbol: one.start for one in block.states if one.start.is_number}
        self._numbers = {key: value for key, value in self._numbers.items() if key not in assigned}
        self._roots: dict[sp.Symbol, frozenset[sp.Symbol]] = {one.symbol: frozenset() for one in block.modes}
        self._roots |= {one.symbol: symbols_in(one.start) for one in started}
        self._kinds: dict[sp.Symbol, Kinds] = {}
        self._kinds |= {one.symbol: self(one.start) for one in started}
        for rank in sorted({one.rank for one in block.samples}):
            due = [one for one in block.samples if one.rank == rank]
            kinds, roots = (
                {one.symbol: self(one.update) for one in due},
                {one.symbol: self._behind(one.update) for one in due},
            )
            self._kinds, self._roots = self._kinds | kinds, self._roots | roots
        self._close()
        self._kinds |= {one: dict.fromkeys(self._roots[one], "dependent") for one in assigned - self._opaque}

    def __call__(self, expression: sp.Basic) -> Kinds:
        """Kind of each known that an expression depends on."""
        smooth = isinstance(expression, sp.Expr)
        opaque = symbols_in(expression) & self._opaque if smooth else symbols_in(expression)
        found: Kinds = {}
        for symbol, factor in _factors(self._factors, expression, columns(self._block)).items():
            number = factor.xreplace(self._numbers)
            for known, kind in self._kinds.get(symbol, {symbol: "constant"}).items():
                if number != 0:
                    linear = number.is_number and kind == found.get(known, kind) == "constant"
                    found[known] = "constant" if linear else "dependent"
        return found | {one: "dependent" for symbol in opaque for one in self._behind(symbol)}

    def _behind(self, expression: sp.Basic) -> frozenset[sp.Symbol]:
        """Time, inputs and parameters that an expression is made of, relations and what has been started resolved."""
        found = self._block.depends_on(expression)
        return frozenset().union(*(self._roots.get(one, frozenset({one})) for one in found))

    def _close(self) -> None:
        """Add what transitions can bring in, until nothing changes: they may fire one after the other."""
        before = None
        while self._roots != before:
            before = dict(self._roots)
            for one in self._block.transitions:
                for target, value in one.assign.items():
                    self._roots[target] |= self._behind(one.guard) | self._behind(value)
