"""Switching as named relations: the only form in which a block may switch.

``sign``, ``Abs``, ``Min``, ``Max``, ``Piecewise`` and inequalities in an expression become Piecewise expressions on
relation symbols. Frozen between events, they leave each branch smooth, so that every derivative taken of such an
expression is that of the frozen branch.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from functools import lru_cache, reduce
from graphlib import CycleError, TopologicalSorter

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.core.relational import Equality, Relational, Unequality
from sympy.logic.boolalg import Boolean, BooleanAtom, BooleanFunction

from brunovsky.blocks.variables import Relation
from brunovsky.errors import ModelError

_REFUSED = (
    AppliedUndef,
    sp.Heaviside,
    sp.DiracDelta,
    sp.floor,
    sp.ceiling,
    sp.Mod,
    sp.frac,
    sp.arg,
    sp.re,
    sp.im,
    sp.Derivative,
)

_NOT_NUMBERS = (sp.nan, sp.zoo, sp.I)


@lru_cache(maxsize=65536)
def symbols_in(expression: sp.Basic) -> frozenset[sp.Symbol]:
    """Symbols of an expression of a block; shared parts are gone through once, unlike by SymPy's ``free_symbols``."""
    if isinstance(expression, sp.Symbol):
        return frozenset({expression})
    return frozenset().union(*map(symbols_in, expression.args))


def root_symbols(expression: sp.Basic, relations: Iterable[Relation]) -> frozenset[sp.Symbol]:
    """Symbols an expression is made of, relations replaced by what they are evaluated from."""
    behind = {one.symbol: one.expression for one in relations}
    found: set[sp.Symbol] = set()
    pending = set(symbols_in(expression))
    while pending:
        one = pending.pop()
        if one not in found and one in behind:
            pending |= symbols_in(behind[one])
        found.add(one)
    return frozenset(found - set(behind))


def reached_relations(expressions: Iterable[sp.Basic], relations: Sequence[Relation]) -> frozenset[sp.Symbol]:
    """Symbols of the relations that expressions read, themselves or through other relations."""
    behind = {one.symbol: symbols_in(one.expression) for one in relations}
    found: set[sp.Symbol] = set()
    pending = set().union(*map(symbols_in, expressions)) & behind.keys()
    while pending:
        one = pending.pop()
        found.add(one)
        pending |= behind[one] & behind.keys() - found
    return frozenset(found)


def ordered_relations(relations: Sequence[Relation], where: str) -> list[Relation]:
    """Relations in an order in which each is evaluated after those it depends on.

    Raises
    ------
    ModelError
        If they depend on each other; the message names the cycle.
    """
    known = {one.symbol: one for one in relations}
    graph = {one.symbol: [other for other in known if other in symbols_in(one.expression)] for one in relations}
    try:
        return [known[one] for one in TopologicalSorter(graph).static_order()]
    except CycleError as error:
        cycle = " <- ".join(str(one) for one in error.args[1])
        raise ModelError(f"{where}: relations depend on each other: {cycle}; make one of them a mode") from None


class RelationTable:
    """Collects the relations of a block while its expressions are lowered.

    Parameters
    ----------
    declared : collection of Relation
        Relations the author named; found ones are appended, equal ones found again.
    modes : collection of sympy.Symbol
        Integer symbols, the only ones that ``Eq`` and ``Ne`` may compare.
    """

    def __init__(self, declared: Collection[Relation], modes: Collection[sp.Symbol]) -> None:
        self._symbols: dict[sp.Expr, sp.Symbol] = {}
        self._modes = frozenset(modes)
        self._lowered: dict[sp.Basic, sp.Basic] = {}
        self.relations: list[Relation] = []
        for relation in declared:
            expression = self.lower(relation.expression, f"relation '{relation.name}'")
            self._symbols.setdefault(expression, relation.symbol)
            self.relations.append(Relation(relation.name, expression, relation.indicator))

    def positive(self, expression: sp.Expr) -> Boolean:
        """Relation symbol that is true where ``expression > 0``."""
        if expression.is_number:
            return sp.true if expression > 0 else sp.false
        if expression not in self._symbols:
            taken = {relation.name for relation in self.relations}
            name = next(f"relation_{k}" for k in range(1, len(taken) + 2) if f"relation_{k}" not in taken)
            self.relations.append(Relation(name, expression))
            self._symbols[expression] = sp.Symbol(name)
        return self._symbols[expression]

    def lower(self, expression: sp.Basic, where: str) -> sp.Basic:
        """Same expression with its switching functions replaced by relations.

        Raises
        ------
        ModelError
            For a switching function that has no such form; the message names it and ``where``.
        """
        if expression not in self._lowered:
            self._lowered[expression] = self._lower(expression, where)
        return self._lowered[expression]

    def _lower(self, expression: sp.Basic, where: str) -> sp.Basic:
        if isinstance(expression, _REFUSED) or expression in _NOT_NUMBERS:
            raise ModelError(f"{where}: {expression} cannot be used in a block; write it with Piecewise or as a mode")
        if isinstance(expression, sp.Symbol | sp.Number | BooleanAtom | sp.NumberSymbol):
            return expression
        if isinstance(expression, sp.Piecewise):
            pairs = [(self.lower(value, where), self.lower(condition, where)) for value, condition in expression.args]
            if pairs[-1][1] != sp.true:
                raise ModelError(f"{where}: {expression} is undefined where no condition holds; end it with (…, True)")
            return sp.Piecewise(*pairs)
        args = [self.lower(argument, where) for argument in expression.args]
        if isinstance(expression, sp.sign):
            return sp.Piecewise((1, self.positive(args[0])), (-1, self.positive(-args[0])), (0, True))
        if isinstance(expression, sp.Abs):
            return sp.Piecewise((args[0], self.positive(args[0])), (-args[0], True))
        if isinstance(expression, sp.Max):
            return reduce(lambda a, b: sp.Piecewise((a, self.positive(a - b)), (b, True)), args)
        if isinstance(expression, sp.Min):
            return reduce(lambda a, b: sp.Piecewise((b, self.positive(a - b)), (a, True)), args)
        if isinstance(expression, Equality | Unequality):
            return self._mode_comparison(expression, where)
        if isinstance(expression, Relational):
            difference = args[0] - args[1]
            if isinstance(expression, sp.StrictGreaterThan):
                return self.positive(difference)
            if isinstance(expression, sp.StrictLessThan):
                return self.positive(-difference)
            if isinstance(expression, sp.GreaterThan):
                return sp.Not(self.positive(-difference))
            return sp.Not(self.positive(difference))
        if not isinstance(expression, sp.Expr | BooleanFunction):
            raise ModelError(f"{where}: {expression} is neither a number nor true or false")
        return expression.func(*args) if args else expression

    def _mode_comparison(self, expression: Relational, where: str) -> Boolean:
        if expression.free_symbols and expression.free_symbols <= self._modes:
            return expression
        raise ModelError(
            f"{where}: {expression} compares real values for equality; only modes may be, use < or > instead"
        )
