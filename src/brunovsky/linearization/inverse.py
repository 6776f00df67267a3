"""Inverse of a coordinate map, by elimination.

The maps of feedback linearisation are triangular more often than not: positions head the chains, velocities come in
as a modulus and a direction, what is left is linear. Five moves do what a general solver would look for much longer:
a state that is alone is read off; M sin(a) and M cos(a) give M and a; products of unknowns that divide each other are
divided; linear combinations of equations leave one product of unknowns; a function of one unknown is inverted. Each
move leaves less to solve, so that the search ends.
"""

import itertools
from collections.abc import Mapping, Sequence
from functools import lru_cache

import sympy as sp

from brunovsky.linearization.rank import generic_rank
from brunovsky.linearization.simplify import tidy

_LARGEST = 4  # equations that are combined at once
_LONGEST = 100  # operations of a solution that is tidied
_SMALL = sp.Rational(1, 1000)
_INVERSES = {sp.sin: sp.asin, sp.cos: sp.acos, sp.tan: sp.atan, sp.exp: sp.log}
_POSITIVE = {sp.sin: sp.cos, sp.cos: sp.sin, sp.tan: sp.cos}  # on the branch that these inverses give

Terms = dict[sp.Expr, sp.Expr]  # products of unknowns with what stands in front of them; 1: the rest
Found = tuple[dict[sp.Symbol, sp.Expr], list[sp.Expr], list[sp.Expr]]  # states, what is left to solve, what is > 0


def invert(
    coordinate_map: Mapping[sp.Symbol, sp.Expr], states: Sequence[sp.Symbol]
) -> tuple[dict[sp.Symbol, sp.Expr], tuple[sp.Expr, ...]] | None:
    """Solve z = Phi(x) for x.

    Parameters
    ----------
    coordinate_map : mapping of sympy.Symbol to sympy.Expr
        The coordinates z as functions of the states.
    states : sequence of sympy.Symbol
        The states x, as many.

    Returns
    -------
    inverse : dict of sympy.Symbol to sympy.Expr
        The states as functions of the coordinates; angles modulo 2 pi.
    branch : tuple of sympy.Expr
        Functions of the states that the inverse takes as positive.
        None instead of both where no solution was found.
    """
    unknown = set(states)
    equations = [function - coordinate for coordinate, function in coordinate_map.items()]
    solved: dict[sp.Symbol, sp.Expr] = {}
    branch: list[sp.Expr] = []
    while unknown:
        for move in (_alone, _polar, _quotient, _combination, _function):
            if (found := move(equations, unknown)) is not None:
                break
        else:
            return None
        symbols, equations, positive = found
        branch += positive
        solved |= symbols
        unknown -= set(symbols)
        equations = [equation for equation in equations if equation.free_symbols & unknown]
    inverse: dict[sp.Symbol, sp.Expr] = {}
    for symbol, value in solved.items():  # each in terms of the coordinates and of those before it
        inverse[symbol] = _short(value.xreplace(inverse))
    return {symbol: inverse[symbol] for symbol in states}, tuple(dict.fromkeys(branch))


def _short(value: sp.Expr) -> sp.Expr:
    return tidy(value) if sp.count_ops(value) <= _LONGEST else value


def _alone(equations: list[sp.Expr], unknown: set[sp.Symbol]) -> Found | None:
    for equation, product, value in _singles(equations, unknown):
        if product in unknown:
            return {product: value}, _without(equations, equation), []
    return None


def _polar(equations: list[sp.Expr], unknown: set[sp.Symbol]) -> Found | None:
    """M sin(a) = p and M cos(a) = q are a = atan2(p, q) and M = sqrt(p^2 + q^2) where M > 0."""
    for (one, first, p), (two, second, q) in itertools.permutations(_singles(equations, unknown), 2):
        for sine in first.atoms(sp.sin):
            modulus = first / sine
            if modulus.has(sine) or second != modulus * sp.cos(sine.args[0]):
                continue
            if _is_negative(modulus):
                modulus, p, q = -modulus, -p, -q
            rest = [*_without(equations, one, two), sine.args[0] - sp.atan2(p, q)]
            if modulus == 1:
                return {}, rest, []
            return {}, [*rest, modulus - sp.sqrt(_short(p**2 + q**2))], [modulus]
    return None


def _is_negative(modulus: sp.Expr) -> bool:
    """Whether it is negative for small positive arguments: such a modulus would be an unusual branch."""
    return bool(modulus.subs(dict.fromkeys(modulus.free_symbols, _SMALL)).evalf() < 0)


def _quotient(equations: list[sp.Expr], unknown: set[sp.Symbol]) -> Found | None:
    for (one, first, p), (_, second, q) in itertools.permutations(_singles(equations, unknown), 2):
        if not second.free_symbols & unknown <= first.free_symbols:
            continue
        quotient = sp.cancel(first / second)
        if not sp.fraction(quotient)[1].free_symbols & unknown and quotient.free_symbols & unknown:
            return {}, [*_without(equations, one), quotient - p / q], []
    return None


def _combination(equations: list[sp.Expr], unknown: set[sp.Symbol]) -> Found | None:
    """Combine some equations so that each of as many of them as possible has one product of unknowns."""
    terms = [_terms(equation, frozenset(unknown)) for equation in equations]
    single = [len(found) == 2 for found in terms]  # 1 and a product
    for size in range(2, _LARGEST + 1):
        for chosen in itertools.combinations(range(len(equations)), size):
            if all(single[i] for i in chosen):
                continue
            isolated = _isolate([terms[i] for i in chosen])
            if len(isolated) <= sum(single[i] for i in chosen):
                continue
            replaced = _independent_rows(sp.Matrix.hstack(*(weights for weights, _ in isolated)))
            rest = _without(equations, *(equations[chosen[i]] for i in replaced))
            return {}, [*rest, *(equation for _, equation in isolated)], []
    return None


def _isolate(terms: list[Terms]) -> list[tuple[sp.Matrix, sp.Expr]]:
    """Weights of equations in which one product of unknowns is left, and what they give, once per product."""
    products = sorted({product for found in terms for product in found} - {sp.S.One}, key=sp.default_sort_key)
    matrix = sp.Matrix([[found.get(product, sp.S.Zero) for product in products] for found in terms])
    if generic_rank(matrix) < matrix.rows:
        return []
    isolated = []
    for column, product in enumerate(products):
        others = matrix.copy()
        others.col_del(column)
        spanning = others[:, list(_independent_rows(others.T))]
        if spanning.cols == matrix.rows - 1:
            weights = _without_denominators(_orthogonal(spanning))
            gain = tidy((weights.T * matrix.col(column))[0])
            rest = sum(weight * found.get(sp.S.One, 0) for weight, found in zip(weights, terms, strict=True))
            isolated.append((weights, product + _short(rest / gain)))
    return isolated


def _independent_rows(matrix: sp.Matrix) -> tuple[int, ...]:
    chosen: list[int] = []
    for row in range(matrix.rows):
        if generic_rank(matrix[[*chosen, row], :]) > len(chosen):
            chosen.append(row)
    return tuple(chosen)


def _orthogonal(matrix: sp.Matrix) -> sp.Matrix:
    """Vector orthogonal to the k - 1 independent columns of k entries: the cofactors."""
    rows = range(matrix.rows)
    minors = [matrix[[i for i in rows if i != row], :].det(method="berkowitz") for row in rows]
    return sp.Matrix([(-1) ** row * minor for row, minor in zip(rows, minors, strict=True)])


def _without_denominators(vector: sp.Matrix) -> sp.Matrix:
    common = sp.lcm_list([sp.fraction(sp.together(entry))[1] for entry in vector])
    return vector.applyfunc(lambda entry: tidy(entry * common))


def _function(equations: list[sp.Expr], unknown: set[sp.Symbol]) -> Found | None:
    """One function of unknowns, or a power."""
    for equation, product, value in _singles(equations, unknown):
        rest = _without(equations, equation)
        if product.func in _INVERSES:
            positive = [_POSITIVE[product.func](product.args[0])] if product.func in _POSITIVE else []
            return {}, [*rest, product.args[0] - _INVERSES[product.func](value)], positive
        if product.is_Pow and product.exp.is_Integer and product.exp > 1:
            return {}, [*rest, product.base - sp.root(value, product.exp)], [product.base]
    return None


def _without(equations: list[sp.Expr], *gone: sp.Expr) -> list[sp.Expr]:
    return [equation for equation in equations if not any(equation is one for one in gone)]


def _singles(equations: list[sp.Expr], unknown: set[sp.Symbol]) -> list[tuple[sp.Expr, sp.Expr, sp.Expr]]:
    """Equations with all that is unknown in them, without known factors, and its value."""
    return [(equation, *_single(equation, frozenset(unknown))) for equation in equations]


@lru_cache(maxsize=1024)
def _single(equation: sp.Expr, unknown: frozenset[sp.Symbol]) -> tuple[sp.Expr, sp.Expr]:
    rest, part = sp.expand(equation).as_independent(*unknown, as_Add=True)
    factor, product = sp.factor(part).as_independent(*unknown, as_Add=False)
    return product, -rest / factor


@lru_cache(maxsize=1024)
def _terms(equation: sp.Expr, unknown: frozenset[sp.Symbol]) -> Terms:
    """Coefficients of the products of unknowns in an expanded equation; what has none of them stands at 1."""
    rest, part = equation.as_independent(*unknown, as_Add=True)
    terms: Terms = {sp.S.One: rest}
    for term in sp.Add.make_args(sp.expand(part)):
        factor, product = term.as_independent(*unknown, as_Add=False)
        terms[product] = terms.get(product, sp.S.Zero) + factor
    return terms
