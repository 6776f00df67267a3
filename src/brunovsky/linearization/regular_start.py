"""Regular start from a singular point: what a trajectory needs to pass it smoothly, derived from y^(r) = F + G u."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp

from brunovsky._frozen import FrozenMapping
from brunovsky.errors import LinearizationError
from brunovsky.linearization.board import Equation, Explained, Formula, Heading, Line, Sentence, definitions, formula
from brunovsky.linearization.elimination import left_null
from brunovsky.linearization.numeric import point_of
from brunovsky.linearization.passage import Passage, derivatives_at
from brunovsky.linearization.rank import generic_rank
from brunovsky.linearization.simplify import tidy

if TYPE_CHECKING:
    from brunovsky.linearization.linearize import Linearization


@dataclass(frozen=True)
class RegularStart(Explained):
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

    def lines(self) -> Iterator[Line]:
        """Yield the lines that `explain`, `latex` and notebooks show."""
        conditions = [one for one in self.conditions if self.chains.get(one.lhs) != one.rhs]
        yield Heading(f"Regular start at {_listed(self.point)}")
        highest = Formula("y^(r) = F + G u", "y^{(r)} = F + G u")
        yield Sentence("Derivatives of {} along the trajectory that were needed: {}.", (highest, len(self.derivatives)))
        yield Sentence("The reference begins with")
        yield from definitions(self.chains)
        if conditions:
            yield Sentence("It satisfies")
            yield from (Equation(formula(one.lhs), formula(one.rhs)) for one in conditions)
        if self.states:
            yield Sentence("It determines the states")
            yield from definitions(self.states)
        yield Sentence("The inputs are" if self.inputs else "The inputs are solutions of")
        yield from definitions(self.inputs)
        if self.inputs and self.equations:
            yield Sentence("and the others solutions of")
        yield from (Equation(formula(one.lhs), formula(one.rhs)) for one in self.equations)
        if self.nonzero:
            yield Sentence("None of these may vanish: {}.", (self.nonzero,))


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
    passage = Passage(free, chains, conditions, states)
    inputs: list[tuple[sp.Symbol, ...]] = []
    reference: list[tuple[sp.Symbol, ...]] = []
    for rows, u, v in itertools.islice(derivatives_at(linearization, fixed), len(extended.states) + 1):
        inputs.append(u)
        reference.append(v)
        passage.add(rows, inputs, v)
        if passage.is_determined(inputs):
            break
    else:
        unknown = ", ".join(str(symbol) for symbol in inputs[0] if symbol not in passage.known)
        raise LinearizationError(
            f"at {_listed(fixed)} the derivatives of y^(r) up to order {len(extended.states)} do not determine "
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
    place = f"at {_listed(fixed)}"
    field = linearization.extended_system.dynamics.subs(fixed)
    if any(part.has(sp.nan, sp.zoo, sp.oo, -sp.oo) for part in (drift, gains, field)):
        raise LinearizationError(f"{place} the extended system is not finite, so no trajectory passes it smoothly")
    if generic_rank(gains) == gains.rows:
        locus = linearization.singular_locus
        remedy = "it has no singularity" if locus == sp.false else f"start where {locus.lhs} = 0"
        raise LinearizationError(f"{place} the law is regular; {remedy}")


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


def _listed(point: Mapping[sp.Symbol, sp.Expr]) -> str:
    """Values of a point as text."""
    return ", ".join(f"{symbol} = {value}" for symbol, value in point.items())
