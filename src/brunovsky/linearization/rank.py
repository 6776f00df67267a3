"""Generic rank of a matrix of functions: its rank almost everywhere, decided exactly.

Simplification cannot be trusted to find every zero, numbers can. Rational functions of the symbols and of the sines
and cosines of single symbols are evaluated in rational arithmetic, with (sin, cos) replaced by rational points of the
unit circle; this is exact, and wrong only if a random point hits a zero set of measure zero at every try. Anything
else (exp, sqrt, sin of a product, …) is evaluated to 60 digits, at points of several magnitudes; zero is then what is
lost in rounding, whatever its size, so that exp(-8750/T) is none. A point thus proves a rank from below; where it
matters and is cheap, `confirms_rank` proves it from above.
"""

import random
from collections.abc import Iterable

import sympy as sp
from sympy.polys.matrices import DomainMatrix

from brunovsky.errors import LinearizationError

_SCALES = (1, 1, 1)
_MORE_SCALES = (sp.Rational(1, 32), 32, 1000)  # where exp and the like may be all but constant at the others
_DIGITS = 60
_TOLERANCE = sp.Float("1e-35", _DIGITS)  # relative, of equilibrated matrices
_HIGHEST_MULTIPLE = 8  # of an angle that is expanded: sin(8 a) has degree 8 in sin(a), cos(a)
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
    ranks: list[int] = []
    scales = list(_SCALES)
    for scale in scales:
        point = _random_point(matrix.free_symbols, generator, scale)
        exact = polynomial.xreplace(_on_the_circle(polynomial, generator) | point)
        if exact.has(sp.nan, sp.zoo, sp.oo, -sp.oo):
            continue
        if all(entry.is_Rational for entry in exact):
            ranks.append(int(exact.rank()))
            continue
        if (approximate := _numeric_rank(matrix, point)) is not None:
            ranks.append(approximate)
        if len(scales) == len(_SCALES) and max(ranks, default=0) < min(matrix.shape):
            scales += _MORE_SCALES
    if not ranks:
        raise LinearizationError(f"{matrix} is not finite at {len(scales)} random points; check its denominators")
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
    """Rewrite tan, cot, sec, csc and sums and small multiples of angles with sines and cosines of single angles."""
    for function, quotient in (
        (sp.tan, lambda a: sp.sin(a) / sp.cos(a)),
        (sp.cot, lambda a: sp.cos(a) / sp.sin(a)),
        (sp.sec, lambda a: 1 / sp.cos(a)),
        (sp.csc, lambda a: 1 / sp.sin(a)),
    ):
        expression = expression.replace(function, quotient)
    kept = {term: sp.Dummy() for term in expression.atoms(sp.sin, sp.cos) if _is_steep(term.args[0])}
    return sp.expand_trig(expression.xreplace(kept)).xreplace({dummy: term for term, dummy in kept.items()})


def _is_steep(angle: sp.Expr) -> bool:
    multiples = (term.as_coeff_Mul()[0] for term in sp.Add.make_args(angle))
    return any(abs(one) > _HIGHEST_MULTIPLE for one in multiples if one.is_Integer)


def _random_point(
    symbols: Iterable[sp.Symbol], generator: random.Random, scale: sp.Rational | int
) -> dict[sp.Symbol, sp.Rational]:
    point = {}
    for symbol in sorted(symbols, key=str):
        numerator, denominator = generator.randint(501, 999), generator.randint(501, 999)  # of the order of 1
        value = (
            sp.Integer(generator.randint(2, 9)) if symbol.is_integer else scale * sp.Rational(numerator, denominator)
        )
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
    known = values.applyfunc(lambda value: sp.S.Zero if _is_lost(value) else value)
    for _ in range(2):  # rows, then columns, scaled to entries of at most 1
        rows = [known.row(i) / (max(abs(entry) for entry in known.row(i)) or 1) for i in range(known.rows)]
        known = sp.Matrix.vstack(*rows).T
    return int(known.rank(iszerofunc=lambda value: abs(value) < _TOLERANCE, simplify=False))


def _is_lost(value: sp.Expr) -> bool:
    """Whether cancellation left no digit of a value that was asked for to 60 (evalf keeps account of that)."""
    return bool(value == 0 or all(part._prec <= 1 for part in value.atoms(sp.Float)))
