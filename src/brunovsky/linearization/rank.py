"""Generic rank of a matrix of functions: its rank almost everywhere, decided exactly.

Simplification cannot be trusted to find every zero, numbers can. Rational functions of the symbols and of the sines
and cosines of single symbols are evaluated in rational arithmetic, with (sin, cos) replaced by rational points of the
unit circle; this is exact, and wrong only if a random point hits a zero set of measure zero at every try. Anything
else (exp, sqrt, sin of a product, …) is evaluated to 60 digits. A point thus proves a rank from below; where it matters
and is cheap, `confirms_rank` proves it from above.
"""

import random
from collections.abc import Iterable

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from brunovsky.errors import LinearizationError

_POINTS = 3
_DIGITS = 60
_TOLERANCE = sp.Float("1e-35", _DIGITS)
_CHEAP = 2000


def generic_rank(matrix: sp.Matrix) -> int:
    """Rank of a matrix of functions at almost every point.

    Parameters
    ----------
    matrix : sympy.Matrix
        Entries are analytic functions of their symbols, with rational numbers as coefficients.

    Returns
    -------
    int
        The largest rank met at three pseudo-random points (always the same ones); points respect the assumptions
        positive, negative and integer of the symbols.

    Raises
    ------
    LinearizationError
        If the matrix is finite at none of the points.
    """
    polynomial = matrix.applyfunc(in_sines_and_cosines)
    generator = random.Random(1)
    ranks = []
    for _ in range(_POINTS):
        point = _random_point(matrix.free_symbols, generator)
        exact = polynomial.xreplace(_on_the_circle(polynomial, generator) | point)
        if exact.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
            continue
        if all(entry.is_Rational for entry in exact):
            ranks.append(int(exact.rank()))
        elif (approximate := _numeric_rank(matrix, point)) is not None:
            ranks.append(approximate)
    if not ranks:
        raise LinearizationError(f"{matrix} is not finite at {_POINTS} random points; check its denominators")
    return max(ranks)


def confirms_rank(matrix: sp.Matrix, rank: int) -> bool:
    """Whether symbolic elimination proves that the generic rank of a matrix is no more than a number.

    The sine and cosine of an angle a are rational functions of tan(a/2), other functions are taken as independent
    variables, which cannot lower the rank; the elimination in the field of fractions is exact.

    Parameters
    ----------
    matrix : sympy.Matrix
        As for `generic_rank`.
    rank : int
        The rank that random points gave.

    Returns
    -------
    bool
        False also where it was not tried, because the matrix is large.
    """
    if rank == min(matrix.shape):
        return True
    polynomial = matrix.applyfunc(in_sines_and_cosines)
    if sum(int(sp.count_ops(entry)) for entry in polynomial) > _CHEAP:
        return False
    halves: dict[sp.Expr, sp.Expr] = {}
    for angle in {term.args[0] for term in polynomial.atoms(sp.sin, sp.cos)}:
        half = sp.Dummy()
        halves |= {sp.sin(angle): 2 * half / (1 + half**2), sp.cos(angle): (1 - half**2) / (1 + half**2)}
    return int(DomainMatrix.from_Matrix(polynomial.xreplace(halves)).to_field().rank()) <= rank


def is_zero(expression: sp.Expr) -> bool:
    """Whether a function vanishes identically (see `generic_rank` for how that is decided)."""
    expression = sp.sympify(expression)
    return bool(expression == 0 or (not expression.is_Number and generic_rank(sp.Matrix([expression])) == 0))


def in_sines_and_cosines(expression: sp.Expr) -> sp.Expr:
    """Rewrite tan, cot, sec, csc and sums and multiples of angles with sines and cosines of single angles."""
    for function, quotient in (
        (sp.tan, lambda a: sp.sin(a) / sp.cos(a)),
        (sp.cot, lambda a: sp.cos(a) / sp.sin(a)),
        (sp.sec, lambda a: 1 / sp.cos(a)),
        (sp.csc, lambda a: 1 / sp.sin(a)),
    ):
        expression = expression.replace(function, quotient)
    return sp.expand_trig(expression)


def _random_point(symbols: Iterable[sp.Symbol], generator: random.Random) -> dict[sp.Symbol, sp.Rational]:
    point = {}
    for symbol in sorted(symbols, key=str):
        numerator, denominator = generator.randint(501, 999), generator.randint(501, 999)  # of the order of 1
        value = sp.Integer(generator.randint(2, 9)) if symbol.is_integer else sp.Rational(numerator, denominator)
        point[symbol] = -value if symbol.is_negative else value
    return point


def _on_the_circle(matrix: sp.Matrix, generator: random.Random) -> dict[sp.Expr, sp.Rational]:
    """Rational values of sin(a) and cos(a) for every symbol a; a itself is independent of both."""
    values = {}
    for angle in sorted({term.args[0] for term in matrix.atoms(sp.sin, sp.cos)}, key=str):
        if angle.is_Symbol:
            t = sp.Rational(generator.randint(2, 99), 100)
            values[sp.sin(angle)], values[sp.cos(angle)] = 2 * t / (1 + t**2), (1 - t**2) / (1 + t**2)
    return values


def _numeric_rank(matrix: sp.Matrix, point: dict[sp.Symbol, sp.Rational]) -> int | None:
    values = matrix.applyfunc(lambda entry: entry.evalf(_DIGITS, subs=point))
    if not all(value.is_number and value.is_finite for value in values):
        return None
    return int(values.rank(iszerofunc=lambda value: abs(value) < _TOLERANCE, simplify=False))
