"""Regular start from a singular point: what a trajectory needs to pass it smoothly, derived from y^(r) = F + G u."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sympy as sp

from brunovsky._frozen import FrozenMapping
from brunovsky.errors import LinearizationError
from brunovsky.linearization.naming import rate
from brunovsky.linearization.numeric import point_of
from brunovsky.linearization.rank import generic_rank
from brunovsky.linearization.simplify import factored, tidy

if TYPE_CHECKING:
    from brunovsky.linearization.linearize import Linearization


@dataclass(frozen=True)
class RegularStart:
    """Conditions under which outputs pass a singular point of the law smoothly, and the inputs with which they do.

    All hold at the one instant of the point. The symbols of the reference are the chain coordinates Zi_k (its
    derivatives below r_i), v (its r_i-th) and `rates` (one more).

    Parameters
    ----------
    point : mapping of sympy.Symbol to sympy.Expr
        What is fixed; other states are free.
    chains : mapping of sympy.Symbol to sympy.Expr
        The derivatives below r_i at the point, in the free states: the reference has to begin with them.
    conditions : tuple of sympy.Eq
        What the reference has to satisfy for that and for y^(r) = F + G u to be solvable.
    states : mapping of sympy.Symbol to sympy.Expr
        Free states that the reference determines.
    inputs : mapping of sympy.Symbol to sympy.Expr
        The inputs of the extended system: where G is regular from y^(r), else from its derivative, the limit of the
        law along the trajectory.
    equations : tuple of sympy.Eq
        Equations that are left for inputs that are not in `inputs`, where they are not linear.
    nonzero : tuple of sympy.Expr
        What must not vanish.
    rates : tuple of sympy.Symbol
        The derivatives of v.
    """

    point: Mapping[sp.Symbol, sp.Expr]
    chains: Mapping[sp.Symbol, sp.Expr]
    conditions: tuple[sp.Eq, ...]
    states: Mapping[sp.Symbol, sp.Expr]
    inputs: Mapping[sp.Symbol, sp.Expr]
    equations: tuple[sp.Eq, ...]
    nonzero: tuple[sp.Expr, ...]
    rates: tuple[sp.Symbol, ...]


def regular_start(linearization: Linearization, point: Mapping[sp.Symbol | str, Any]) -> RegularStart:
    """Derive when a trajectory passes a singular point of the law smoothly.

    Where G is singular with left null vectors L, y^(r) = F + G u has a solution only if L (y^(r) - F) = 0. What that
    leaves open of u follows from the derivative along the trajectory, L (y^(r) - F - G u)' = 0, in which the
    derivatives of u have the coefficient L G = 0.

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
        If the law is regular at the point, not finite there, or the first derivative does not determine the inputs.
    ParameterError
        If the point names something else than a state or a parameter.

    References
    ----------
    The elimination is that of differential-algebraic equations of higher index: E. Hairer and G. Wanner, *Solving
    Ordinary Differential Equations II*, 2nd ed., 1996, section VII.1, doi:10.1007/978-3-642-05221-7.
    """
    extended = linearization.extended_system
    fixed = point_of(extended, point)
    drift, gains = linearization.drift_term.subs(fixed), linearization.decoupling_matrix.subs(fixed)
    _check(linearization, drift, gains, fixed)
    chains = {
        name: tidy(function.subs(fixed))
        for names, functions in zip(linearization.normal_form.chains, linearization.chains, strict=True)
        for name, function in zip(names, functions, strict=True)
    }
    states, conditions = _compensator(linearization, chains, fixed)
    left = _left_null(gains.applyfunc(tidy))
    v = sp.Matrix(linearization.outer_inputs)
    nonzero: list[sp.Expr] = []
    for condition in (left * (v - drift)).applyfunc(tidy):
        solved = _solve_for_a_state(condition, [s for s in extended.states if s not in {*fixed, *states}])
        if solved is None:
            conditions.append(sp.Eq(condition, 0))
        else:
            symbol, value, factors = solved
            states[symbol] = value
            nonzero += factors
    if sp.false in conditions:
        raise LinearizationError(f"at {_shown(fixed)} y^(r) = F + G u has no solution: nothing passes it smoothly")
    taken = {
        str(one) for one in (*extended.states, *extended.inputs, *extended.parameters, *linearization.outer_inputs)
    }
    rates = tuple(rate(one, taken) for one in linearization.outer_inputs)
    inputs, equations, factors = _inputs(linearization, fixed, left, rates)
    return RegularStart(
        point=FrozenMapping(fixed),
        chains=FrozenMapping(chains),
        conditions=tuple(one for one in conditions if one != sp.true),
        states=FrozenMapping(states),
        inputs=FrozenMapping(inputs),
        equations=equations,
        nonzero=tuple(dict.fromkeys([*nonzero, *factors])),
        rates=rates,
    )


def _check(
    linearization: Linearization, drift: sp.Matrix, gains: sp.Matrix, fixed: Mapping[sp.Symbol, sp.Expr]
) -> None:
    place = f"at {_shown(fixed)}"
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
    conditions += [sp.Eq(condition, 0) for condition in (_left_null(slopes) * right).applyfunc(tidy)]
    return {symbol: tidy(value) for symbol, value in zip(own, solution, strict=True)}, conditions


def _shown(fixed: Mapping[sp.Symbol, sp.Expr]) -> str:
    return ", ".join(f"{symbol} = {value}" for symbol, value in fixed.items())


def _left_null(matrix: sp.Matrix) -> sp.Matrix:
    vectors = matrix.T.nullspace(simplify=tidy)
    scaled = [v * sp.lcm_list([sp.fraction(sp.together(entry))[1] for entry in v]) for v in vectors]
    return sp.Matrix([list(vector.applyfunc(tidy)) for vector in scaled])


def _solve_for_a_state(
    condition: sp.Expr, candidates: Sequence[sp.Symbol]
) -> tuple[sp.Symbol, sp.Expr, list[sp.Expr]] | None:
    for symbol in candidates:
        slope = tidy(sp.diff(condition, symbol))
        if slope != 0 and not slope.has(symbol):
            value = tidy(-condition.subs(symbol, 0) / slope)
            return symbol, value, _may_vanish(slope)
    return None


def _may_vanish(expression: sp.Expr) -> list[sp.Expr]:
    factors = sp.factor_list(sp.fraction(factored(expression))[0])[1]
    return [factor for factor, _ in factors if not factor.is_nonzero]


def _inputs(
    linearization: Linearization, fixed: Mapping[sp.Symbol, sp.Expr], left: sp.Matrix, rates: Sequence[sp.Symbol]
) -> tuple[dict[sp.Symbol, sp.Expr], tuple[sp.Eq, ...], list[sp.Expr]]:
    """Inputs from y^(r) where G lets them be found, the others from its derivative along the trajectory."""
    system = linearization.extended_system
    u, v = sp.Matrix(system.inputs), sp.Matrix(linearization.outer_inputs)
    gains = linearization.decoupling_matrix.subs(fixed).applyfunc(tidy)
    drift = linearization.drift_term.subs(fixed)
    pivots: list[int] = []
    for column in reversed(range(gains.cols)):
        if generic_rank(gains[:, [*pivots, column]]) > len(pivots):
            pivots.insert(0, column)
    others = [column for column in range(gains.cols) if column not in pivots]
    inputs: dict[sp.Symbol, sp.Expr] = {}
    if pivots:
        chosen = gains[:, pivots]
        normal = (chosen.T * chosen).applyfunc(tidy)
        right = chosen.T * (v - drift - gains[:, others] * u.extract(others, [0]))
        found = normal.adjugate() * right / normal.det(method="berkowitz")
        inputs = {u[column]: tidy(value) for column, value in zip(pivots, found, strict=True)}
    highest = linearization.drift_term + linearization.decoupling_matrix * u
    moving = system.drift + system.input_matrix * u
    derivative = (highest.jacobian(sp.Matrix(system.states)) * moving).subs(fixed)
    remaining = (left * (sp.Matrix(rates) - derivative)).xreplace(inputs).applyfunc(tidy)
    unknown = [u[column] for column in others]
    slopes = remaining.jacobian(unknown).applyfunc(tidy)
    if slopes.has(*unknown):
        return inputs, tuple(sp.Eq(equation, 0) for equation in remaining), []
    determinant = factored(slopes.det(method="berkowitz"))
    if determinant == 0:
        raise LinearizationError(
            f"at {_shown(fixed)} the first derivative of y^(r) "
            f"does not determine {', '.join(map(str, unknown))}; leave more states free"
        )
    solved = slopes.adjugate() * -remaining.subs(dict.fromkeys(unknown, 0)) / determinant
    free = {symbol: tidy(value) for symbol, value in zip(unknown, solved, strict=True)}
    inputs = {symbol: tidy(value.xreplace(free)) for symbol, value in inputs.items()} | free
    return {symbol: inputs[symbol] for symbol in u}, (), _may_vanish(determinant)
