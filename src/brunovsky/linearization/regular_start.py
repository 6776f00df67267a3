"""Regular start from a singular point: what a trajectory needs to pass it smoothly, derived from y^(r) = F + G u."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import sympy as sp

from brunovsky._frozen import FrozenMapping
from brunovsky.errors import LinearizationError
from brunovsky.linearization import explain as _explain
from brunovsky.linearization.elimination import eliminate, left_null, may_vanish, solve_for_a_state
from brunovsky.linearization.naming import rate
from brunovsky.linearization.numeric import point_of
from brunovsky.linearization.rank import generic_rank, is_zero
from brunovsky.linearization.simplify import factored, tidy

if TYPE_CHECKING:
    from brunovsky.linearization.linearize import Linearization


@dataclass(frozen=True)
class RegularStart:
    """Conditions under which outputs pass a singular point of the law smoothly, and the inputs with which they do.

    All hold at the one instant of the point, and are necessary. The symbols of the reference are the chain coordinates
    Zi_k (its derivatives below r_i), v (its r_i-th) and `derivatives` (the following ones).

    Parameters
    ----------
    point : mapping of sympy.Symbol to sympy.Expr
        What is fixed; other states are free.
    chains : mapping of sympy.Symbol to sympy.Expr
        The derivatives below r_i at the point, in the free states: the reference has to begin with them.
    conditions : tuple of sympy.Eq
        What the reference has to satisfy for that and for y^(r) = F + G u to be solvable. One that contains a free
        state that is neither in `chains` nor in another condition determines it, with several branches.
    states : mapping of sympy.Symbol to sympy.Expr
        Free states that the reference determines, in it and in other free states; an angle of which the tangent is
        determined is an arc tangent, modulo pi.
    inputs : mapping of sympy.Symbol to sympy.Expr
        The inputs of the extended system in the states and the reference: where G is regular from y^(r), else from
        its derivatives, the limit of the law along the trajectory.
    equations : tuple of sympy.Eq
        Equations that are left for inputs that are not in `inputs`, where they are not linear; each of their branches
        is a passage.
    nonzero : tuple of sympy.Expr
        What must not vanish.
    derivatives : tuple of tuples of sympy.Symbol
        Per order the derivatives of v that matter: v', v'', ...; as many as y^(r) = F + G u was differentiated.
    """

    point: Mapping[sp.Symbol, sp.Expr]
    chains: Mapping[sp.Symbol, sp.Expr]
    conditions: tuple[sp.Eq, ...]
    states: Mapping[sp.Symbol, sp.Expr]
    inputs: Mapping[sp.Symbol, sp.Expr]
    equations: tuple[sp.Eq, ...]
    nonzero: tuple[sp.Expr, ...]
    derivatives: tuple[tuple[sp.Symbol, ...], ...]

    @property
    def rates(self) -> tuple[sp.Symbol, ...]:
        """The first derivatives of v."""
        return self.derivatives[0]

    def explain(self) -> str:
        """Return what the passage needs as plain text."""
        return _explain.as_text(_explain.passage(self))

    def latex(self) -> str:
        """Return the same as a LaTeX fragment (paragraphs and displayed equations; needs amsmath)."""
        return _explain.as_latex(_explain.passage(self))

    def _repr_markdown_(self) -> str:
        return _explain.as_markdown(_explain.passage(self))


def regular_start(linearization: Linearization, point: Mapping[sp.Symbol | str, Any]) -> RegularStart:
    """Derive when a trajectory passes a singular point of the law smoothly.

    Along a trajectory E = y^(r) - F - G u vanishes identically, so all its derivatives vanish at the point. In the k-th
    the k-th derivative of u has the coefficient G: where G is singular with left null vectors L, L E^(k) = 0 is an
    equation for what the derivatives below have left open. These are eliminated from the highest derivative of u
    down, order by order, until u itself is determined; equations that contain no input are conditions on the reference
    or determine free states. As many derivatives are tried as the extended system has states: a linear system can be
    inverted with so many or not at all, and what is of higher order at a singular point is refused.

    Parameters
    ----------
    linearization : Linearization
        The law.
    point : mapping of sympy.Symbol or str to number
        States of the extended system that are fixed, on the singular locus; the others are free. The robot at rest
        is ``{"eta1": 0}``, at true rest ``{"eta1": 0, "eta2": 0}``.

    Returns
    -------
    RegularStart
        Conditions and inputs.

    Raises
    ------
    LinearizationError
        If the law is regular at the point, not finite there, or the derivatives do not determine the inputs.
    ParameterError
        If the point names something else than a state or a parameter.

    References
    ----------
    R. M. Hirschorn, "Invertibility of multivariable nonlinear control systems", IEEE Trans. Autom. Control 24(6),
    855-865, 1979; L. M. Silverman, "Inversion of multivariable linear systems", IEEE Trans. Autom. Control 14(3),
    270-276, 1969 (the bound). The elimination is that of differential-algebraic equations of higher index: E. Hairer
    and G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed., 1996, section VII.1,
    doi:10.1007/978-3-642-05221-7.
    """
    extended = linearization.extended_system
    fixed = point_of(extended, point)
    _check(linearization, fixed)
    chains = {
        name: tidy(function.subs(fixed))
        for names, functions in zip(linearization.normal_form.chains, linearization.chains, strict=True)
        for name, function in zip(names, functions, strict=True)
    }
    states, conditions = _compensator(linearization, chains, fixed)
    free = [symbol for symbol in extended.states if symbol not in fixed]
    passage = _Passage(free, chains, conditions, states)
    inputs: list[tuple[sp.Symbol, ...]] = []
    reference: list[tuple[sp.Symbol, ...]] = []
    for rows, u, v in itertools.islice(_derivatives(linearization, fixed), len(extended.states) + 1):
        inputs.append(u)
        reference.append(v)
        passage.add(rows, inputs, v)
        if passage.is_determined(inputs):
            break
    else:
        unknown = ", ".join(str(symbol) for symbol in inputs[0] if symbol not in passage.known)
        raise LinearizationError(
            f"at {_explain.listed(fixed)} the derivatives of y^(r) up to the {len(extended.states)}th do not determine "
            f"{unknown}: nothing is known of a smooth passage; leave more states free"
        )
    return RegularStart(
        point=FrozenMapping(fixed),
        chains=FrozenMapping(chains),
        conditions=tuple(one for one in passage.conditions if one != sp.true),
        states=FrozenMapping(passage.states),
        inputs=FrozenMapping({u: tidy(passage.known[u]) for u in inputs[0] if u in passage.known}),
        equations=tuple(sp.Eq(row, 0) for row in passage.pending),
        nonzero=tuple(dict.fromkeys(passage.nonzero)),
        derivatives=tuple(reference[1:]),
    )


def _check(linearization: Linearization, fixed: Mapping[sp.Symbol, sp.Expr]) -> None:
    drift, gains = linearization.drift_term.subs(fixed), linearization.decoupling_matrix.subs(fixed)
    place = f"at {_explain.listed(fixed)}"
    field = linearization.extended_system.dynamics.subs(fixed)
    if any(part.has(sp.nan, sp.zoo, sp.oo, -sp.oo) for part in (drift, gains, field)):
        raise LinearizationError(f"{place} the extended system is not finite, so no trajectory passes it smoothly")
    if generic_rank(gains) == gains.rows:
        raise LinearizationError(
            f"{place} the law is regular; a regular start is a question where {linearization.singular_locus}"
        )


def _compensator(
    linearization: Linearization, chains: Mapping[sp.Symbol, sp.Expr], fixed: Mapping[sp.Symbol, sp.Expr]
) -> tuple[dict[sp.Symbol, sp.Expr], list[sp.Eq]]:
    """States of the compensator from the chains, in which they are linear, and what the chains must satisfy for it."""
    own = [symbol for symbol in linearization.extension.states if symbol not in fixed]
    conditions = [
        sp.Eq(name, value) for name, value in chains.items() if not value.has(*linearization.system.states, *own)
    ]
    involved = {name: value for name, value in chains.items() if own and value.has(*own)}
    slopes = sp.Matrix(list(involved.values())).jacobian(own) if involved else sp.zeros(0, 0)
    if not involved or slopes.has(*own) or generic_rank(slopes) < len(own):
        return {}, conditions
    right = sp.Matrix([name - value.subs(dict.fromkeys(own, 0)) for name, value in involved.items()])
    normal = (slopes.T * slopes).applyfunc(tidy)
    solution = normal.adjugate() * slopes.T * right / normal.det(method="berkowitz")
    conditions += [sp.Eq(condition, 0) for condition in (left_null(slopes) * right).applyfunc(tidy)]
    return {symbol: tidy(value) for symbol, value in zip(own, solution, strict=True)}, conditions


def _derivatives(
    linearization: Linearization, fixed: Mapping[sp.Symbol, sp.Expr]
) -> Iterator[tuple[list[sp.Expr], tuple[sp.Symbol, ...], tuple[sp.Symbol, ...]]]:
    """Yield E = v - F - G u and its derivatives along the trajectory, at the point, with those of u and of v."""
    system = linearization.extended_system
    states, u, v = sp.Matrix(system.states), tuple(system.inputs), linearization.outer_inputs
    taken = {str(one) for one in (*system.states, *system.inputs, *system.parameters, *v, *linearization.normal_form.map)}
    moving = system.drift + system.input_matrix * sp.Matrix(u)
    highest = linearization.drift_term + linearization.decoupling_matrix * sp.Matrix(u)
    jets = [u]
    for order in itertools.count(1):
        reference = v if order == 1 else tuple(rate(one, taken, order - 1) for one in v)
        yield list(sp.Matrix(reference) - highest.subs(fixed)), jets[-1], reference
        jets.append(tuple(rate(one, taken, order) for one in u))
        highest = highest.jacobian(states) * moving + sum(
            (highest.jacobian(one) * sp.Matrix(later) for one, later in itertools.pairwise(jets)),
            sp.zeros(*highest.shape),
        )


@dataclass
class _Passage:
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
    _from_conditions: dict[sp.Symbol, sp.Expr] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for condition in self.conditions:
            if condition not in (sp.true, sp.false):
                self._relate(condition.lhs - condition.rhs, list(self.chains))
        for symbol, value in self.states.items():
            self._add_relation(symbol, value)

    def add(self, rows: Sequence[sp.Expr], jets: Sequence[Sequence[sp.Symbol]], reference: Sequence[sp.Symbol]) -> None:
        """Take in one derivative of E; `jets` are u and its derivatives up to the same order."""
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
            self.nonzero += may_vanish(slopes.det(method="berkowitz"))
        return True

    def _solve_block(self, rows: list[sp.Expr], unknowns: Sequence[sp.Symbol]) -> list[sp.Expr]:
        """Solve for derivatives of one order; return the expressions that contain none of them."""
        while unknowns:
            linear = [row for row in rows if row.has(*unknowns) and not _slopes(row, unknowns).has(*unknowns)]
            if not linear:
                break
            found = eliminate(linear, unknowns, self.relations)
            rows = [row for row in rows if row not in linear] + list(found.left)
            if not found.values:
                continue
            self.known = {one: value.xreplace(found.values) for one, value in self.known.items()} | dict(found.values)
            self.nonzero += found.nonzero
            rows = [tidy(row.xreplace(found.values)) for row in rows]
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
        said = [*self.chains.values(), *(one.lhs - one.rhs for one in self.conditions if one not in (sp.true, sp.false))]
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
