"""Elimination of unknowns from equations whose coefficients are functions: what a point of singularity leaves open."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import sympy as sp

from brunovsky.linearization.rank import generic_rank, in_sines_and_cosines
from brunovsky.linearization.simplify import factored, tidy, vanishing_factors


@dataclass(frozen=True)
class Elimination:
    """Unknowns solved for, in the others; the expressions without any that must vanish; factors of the divisors."""

    values: Mapping[sp.Symbol, sp.Expr]
    left: tuple[sp.Expr, ...]
    nonzero: tuple[sp.Expr, ...]


def eliminate(
    rows: Sequence[sp.Expr],
    unknowns: Sequence[sp.Symbol],
    relations: Mapping[sp.Symbol, sp.Expr],
    polynomial_in: Sequence[sp.Symbol] = (),
) -> Elimination:
    """Solve expressions that are linear in the unknowns, and must vanish, for as many of them as their rank allows.

    The last unknowns that can be solved for are. The rank is decided where the relations hold. Which other symbols the
    rows are polynomials in may be said, to save time.
    """
    matrix = sp.Matrix(rows).jacobian(list(unknowns)).applyfunc(tidy)
    related = matrix.xreplace(relations)
    if generic_rank(related) < generic_rank(matrix):
        matrix = related.applyfunc(tidy)
    pivots: list[int] = []
    for column in reversed(range(matrix.cols)):
        if generic_rank(matrix[:, [*pivots, column]].xreplace(relations)) > len(pivots):
            pivots.insert(0, column)
    others = {unknowns[column]: 0 for column in range(matrix.cols) if column not in pivots}
    right = -sp.Matrix(rows).subs({unknowns[column]: 0 for column in pivots})
    combined = -left_null(matrix) * right.subs(others) if len(pivots) < len(rows) else []
    left = tuple(tidy_polynomial(entry, polynomial_in) for entry in combined)
    if not pivots:
        return Elimination({}, left, ())
    chosen, right, divisor = _square(matrix[:, pivots], right)
    solution = chosen.adjugate() * right / divisor
    values = {unknowns[column]: value for column, value in zip(pivots, solution, strict=True)}
    return Elimination(values, left, tuple(vanishing_factors(divisor)))


def _square(matrix: sp.Matrix, right: sp.Matrix) -> tuple[sp.Matrix, sp.Matrix, sp.Expr]:
    """Equations A x = b of full column rank as square ones: rows if their minor cannot vanish, else A'A x = A'b."""
    for chosen in combinations(range(matrix.rows), matrix.cols):
        rows = matrix[list(chosen), :]
        divisor = factored(rows.det(method="berkowitz"))
        if matrix.rows == matrix.cols or (divisor != 0 and not vanishing_factors(divisor)):
            return rows, right[list(chosen), :], divisor
    normal = (matrix.T * matrix).applyfunc(tidy)
    return normal, matrix.T * right, factored(normal.det(method="berkowitz"))


def left_null(matrix: sp.Matrix) -> sp.Matrix:
    """Rows that span the left null space, without denominators."""
    vectors = matrix.T.nullspace(simplify=tidy)
    scaled = [v * sp.lcm_list([sp.fraction(sp.together(entry))[1] for entry in v]) for v in vectors]
    return sp.Matrix(len(vectors), matrix.rows, [tidy(entry) for vector in scaled for entry in vector])


def solve_for_a_state(
    condition: sp.Expr, candidates: Sequence[sp.Symbol], states: Sequence[sp.Symbol]
) -> tuple[sp.Symbol, sp.Expr, list[sp.Expr]] | None:
    """State, value and what must not vanish, where a state is linear in a condition or an angle's tangent is.

    Other conditions have several branches, or none that is known, and are not solved; nor are directions in the plane,
    a sin(angle) + b cos(angle) = 0 with a and b of the reference alone, which say it without a quotient.
    """
    for symbol in candidates:
        if solved := _linear(condition, symbol):
            return symbol, *solved
    for symbol in candidates:
        if solutions := list(_by_tangent(condition, symbol, states)):
            _, value, factors = min(solutions, key=lambda one: one[0])
            return symbol, value, factors
    return None


def _by_tangent(
    condition: sp.Expr, symbol: sp.Symbol, states: Sequence[sp.Symbol]
) -> Iterator[tuple[int, sp.Expr, list[sp.Expr]]]:
    """Values of an angle of which, or of the difference of which to another state, the tangent is linear."""
    tangent = sp.Dummy("tangent", real=True)
    for other in (sp.S.Zero, *(state for state in states if state != symbol and condition.has(state))):
        shifted = in_sines_and_cosines(tidy(condition.subs(symbol, symbol + other)))
        numerator = sp.expand(sp.fraction(sp.together(shifted))[0])
        ratio = sp.factor(numerator.subs(sp.sin(symbol), tangent * sp.cos(symbol)))
        rest = sp.Mul(*(one for one in sp.Mul.make_args(ratio) if one.as_base_exp()[0] != sp.cos(symbol)))
        if rest.has(tangent) and not rest.has(symbol) and (solved := _linear(rest, tangent)):
            slope = tidy(sp.diff(rest, tangent))
            if slope.is_number or slope.has(*states):
                yield int(sp.count_ops(slope)), other + sp.atan(solved[0]), solved[1]


def _linear(condition: sp.Expr, symbol: sp.Symbol) -> tuple[sp.Expr, list[sp.Expr]] | None:
    slope = tidy(sp.diff(condition, symbol))
    if slope == 0 or slope.has(symbol):
        return None
    return tidy(-condition.subs(symbol, 0) / slope), vanishing_factors(slope)


def tidy_polynomial(expression: sp.Expr, symbols: Sequence[sp.Symbol]) -> sp.Expr:
    """Tidy the coefficients of a polynomial in some symbols, which is faster than all of it; all of what is none."""
    present = [symbol for symbol in symbols if expression.has(symbol)]
    if not present or not expression.is_polynomial(*present):
        return tidy(expression)
    terms = sp.collect(sp.expand(expression), present, evaluate=False)
    return sp.Add(*(tidy(coefficient) * monomial for monomial, coefficient in terms.items()))
