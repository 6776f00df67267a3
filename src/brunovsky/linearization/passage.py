"""What the derivatives of y^(r) = F + G u along a trajectory say of its passage through a point, order by order."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import sympy as sp

from brunovsky.linearization.elimination import eliminate, solve_for_a_state, tidy_polynomial
from brunovsky.linearization.naming import rate
from brunovsky.linearization.rank import generic_rank, is_zero
from brunovsky.linearization.simplify import tidy, vanishing_factors

if TYPE_CHECKING:
    from brunovsky.linearization.linearize import Linearization


def derivatives_at(
    linearization: Linearization, fixed: Mapping[sp.Symbol, sp.Expr]
) -> Iterator[tuple[list[sp.Expr], tuple[sp.Symbol, ...], tuple[sp.Symbol, ...]]]:
    """Yield E = v - F - G u and its derivatives along the trajectory, at the point, with those of u and of v.

    States, inputs and all their derivatives are symbols in what is differentiated; the values of the states'
    derivatives at the point, x' = f + g u and so on, are inserted afterwards, where many of them vanish.
    """
    system, v = linearization.extended_system, linearization.outer_inputs
    states, u = tuple(system.states), tuple(system.inputs)
    taken = {str(one) for one in (*states, *u, *system.parameters, *v, *linearization.normal_form.map)}
    field = system.drift + system.input_matrix * sp.Matrix(u)
    highest = linearization.drift_term + linearization.decoupling_matrix * sp.Matrix(u)
    values = dict(fixed)
    later: dict[sp.Symbol, sp.Symbol] = {}
    for order in itertools.count(1):
        reference = tuple(rate(one, taken, order - 1) for one in v) if order > 1 else v
        yield list(sp.Matrix(reference) - highest.xreplace(values)), u, reference
        moved = tuple(rate(one, taken, order) for one in system.states)
        values |= {one: value.xreplace(values) for one, value in zip(moved, field, strict=True)}
        later |= dict(zip(states, moved, strict=True))
        states = moved
        u_later = tuple(rate(one, taken, order) for one in system.inputs)
        later |= dict(zip(u, u_later, strict=True))
        u = u_later
        highest, field = (_total_derivative(one, later) for one in (highest, field))


def _total_derivative(vector: sp.Matrix, later: Mapping[sp.Symbol, sp.Symbol]) -> sp.Matrix:
    """Derivative with respect to time, from symbols and those of their derivatives."""
    return vector.applyfunc(
        lambda entry: sp.Add(
            *(sp.diff(entry, one) * later[one] for one in sorted(entry.free_symbols & set(later), key=str))
        )
    )


@dataclass
class Passage:
    """What the derivatives so far say of the passage.

    `known` are inputs and their derivatives in those that are not known; `pending` expressions must vanish and contain
    unknown inputs nonlinearly; `relations` are the conditions and states, each solved for one symbol.
    """

    free: list[sp.Symbol]
    chains: Mapping[sp.Symbol, sp.Expr]
    conditions: list[sp.Eq]
    states: dict[sp.Symbol, sp.Expr]
    known: dict[sp.Symbol, sp.Expr] = field(default_factory=dict)
    pending: list[sp.Expr] = field(default_factory=list)
    nonzero: list[sp.Expr] = field(default_factory=list)
    relations: dict[sp.Symbol, sp.Expr] = field(default_factory=dict)
    symbols: list[sp.Symbol] = field(default_factory=list)
    _from_conditions: dict[sp.Symbol, sp.Expr] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for condition in self.conditions:
            if condition not in (sp.true, sp.false):
                self._relate(condition.lhs - condition.rhs, list(self.chains))
        for symbol, value in self.states.items():
            self._add_relation(symbol, value)

    def add(self, rows: Sequence[sp.Expr], jets: Sequence[Sequence[sp.Symbol]], reference: Sequence[sp.Symbol]) -> None:
        """Take in one derivative of E; `jets` are u and its derivatives up to the same order."""
        self.symbols += [*jets[-1], *reference]
        open_rows = [*self.pending, *(row.xreplace(self.known) for row in rows)]
        self.pending = []
        for block in reversed(jets):
            open_rows = self._solve_block(open_rows, [symbol for symbol in block if symbol not in self.known])
        for row in open_rows:
            self._settle(row, reference)

    def is_determined(self, jets: Sequence[Sequence[sp.Symbol]]) -> bool:
        """Whether u is known or stands in equations with finitely many solutions."""
        unknown = [symbol for symbol in jets[0] if symbol not in self.known]
        rows = [row for row in self.pending if not row.has(*itertools.chain(*jets[1:]))] if jets[1:] else self.pending
        if not unknown:
            return True
        if len(rows) < len(unknown) or len(rows) < len(self.pending):
            return False
        slopes = sp.Matrix(rows).jacobian(unknown)
        if generic_rank(slopes.xreplace(self.relations)) < len(unknown):
            return False
        if slopes.is_square:
            self.nonzero += vanishing_factors(slopes.det(method="berkowitz"))
        return True

    def _solve_block(self, rows: list[sp.Expr], unknowns: Sequence[sp.Symbol]) -> list[sp.Expr]:
        """Solve for derivatives of one order; return the expressions that contain none of them."""
        while unknowns:
            linear = [row for row in rows if row.has(*unknowns) and not _slopes(row, unknowns).has(*unknowns)]
            if not linear:
                break
            found = eliminate(linear, unknowns, self.relations, self.symbols)
            rows = [row for row in rows if row not in linear] + list(found.left)
            if not found.values:
                continue
            self.known = {one: value.xreplace(found.values) for one, value in self.known.items()} | dict(found.values)
            self.nonzero += found.nonzero
            rows = [tidy_polynomial(row.xreplace(found.values), self.symbols) for row in rows]
            unknowns = [one for one in unknowns if one not in found.values]
        self.pending += [row for row in rows if unknowns and row.has(*unknowns)]
        return [row for row in rows if not (unknowns and row.has(*unknowns))]

    def _settle(self, row: sp.Expr, reference: Sequence[sp.Symbol]) -> None:
        """A state from an expression without inputs, else a condition, if it is not a consequence of others."""
        row = tidy(row.xreplace(self._from_conditions))
        if is_zero(row.xreplace(self.relations)):
            return
        solved = solve_for_a_state(row, [s for s in self.free if row.has(s) and self._is_open(s)], self.free)
        if solved is None:
            self.conditions.append(sp.Eq(row, 0))
            self._relate(row, reference)
            return
        symbol, value, factors = solved
        self._from_conditions = {one: tidy(v.xreplace({symbol: value})) for one, v in self._from_conditions.items()}
        self._from_conditions[symbol] = value
        self.states |= self._from_conditions
        self.nonzero += factors
        self._add_relation(symbol, value)

    def _is_open(self, state: sp.Symbol) -> bool:
        """Whether chains, conditions and states found so far leave a state undetermined."""
        if state in self.states:
            return False
        said = [
            *self.chains.values(),
            *(one.lhs - one.rhs for one in self.conditions if one not in (sp.true, sp.false)),
        ]
        said += [symbol - value for symbol, value in self.states.items()]
        gradients = sp.Matrix(said).jacobian(self.free)
        unit = sp.Matrix([[int(one == state) for one in self.free]])
        return generic_rank(gradients.col_join(unit)) > generic_rank(gradients)

    def _relate(self, row: sp.Expr, reference: Sequence[sp.Symbol]) -> None:
        for symbol in reversed(reference):
            slope = tidy(sp.diff(row, symbol))
            if slope != 0 and not slope.has(symbol):
                self._add_relation(symbol, (symbol - row / slope).subs(symbol, 0))
                return

    def _add_relation(self, symbol: sp.Symbol, value: sp.Expr) -> None:
        value = value.xreplace(self.relations)
        self.relations = {one: v.xreplace({symbol: value}) for one, v in self.relations.items()} | {symbol: value}


def _slopes(row: sp.Expr, unknowns: Sequence[sp.Symbol]) -> sp.Matrix:
    return sp.Matrix([row]).jacobian(list(unknowns)).applyfunc(tidy)
