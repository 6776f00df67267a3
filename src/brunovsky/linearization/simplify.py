"""The one simplification of this folder: short forms in lowest terms, fast and deterministic."""

from collections.abc import Mapping
from functools import lru_cache

import sympy as sp

from brunovsky.linearization.rank import in_sines_and_cosines

_ROUNDING = 1e-12
_STEEP = 64


@lru_cache(maxsize=4096)
def tidy(expression: sp.Expr) -> sp.Expr:
    """Shortest of a few forms of an expression, a quotient in lowest terms.

    The candidates are the cancelled quotient with angle sums kept or expanded, and with sin^2 + cos^2 = 1 used to
    eliminate either square, angle by angle. (`sympy.simplify` finds the same forms for small plants, slower.)

    Parameters
    ----------
    expression : sympy.Expr
        A rational function of symbols, sines, cosines and other functions of them.

    Returns
    -------
    sympy.Expr
        An equal expression.
    """
    expression, shown = without_steep_exponentials(expression)
    cancelled = sp.cancel(expression)
    candidates = [_pythagoras(cancelled)]
    expanded = in_sines_and_cosines(expression)
    if expanded != expression:
        candidates.append(_pythagoras(sp.cancel(expanded)))
    # doit: factor_terms leaves unevaluated products that would not survive a substitution or pickling
    return min((sp.factor_terms(candidate, sign=True).doit() for candidate in candidates), key=_length).xreplace(shown)


def factored(expression: sp.Expr) -> sp.Expr:
    """Tidied expression with numerator and denominator as products of irreducible factors."""
    hidden, shown = without_steep_exponentials(expression)
    return min((sp.factor(tidy(hidden)), tidy(sp.factor(hidden))), key=_length).xreplace(shown)


def factors(expression: sp.Expr) -> list[tuple[sp.Expr, int]]:
    """Irreducible factors of an expression with their powers, constants apart."""
    hidden, shown = without_steep_exponentials(expression)
    try:
        found = sp.factor_list(hidden)[1]
    except sp.PolynomialError:  # of 2**x
        found = [(hidden, 1)]
    return [(factor.xreplace(shown), int(power)) for factor, power in found]


def vanishing_factors(expression: sp.Expr) -> list[sp.Expr]:
    """Irreducible factors of the numerator that are not known to be nonzero for real values of their symbols."""
    return [factor for factor, _ in factors(sp.fraction(factored(expression))[0]) if _may_vanish(factor)]


def _may_vanish(factor: sp.Expr) -> bool:
    """Whether a function of real symbols can be zero, as far as assumptions and the range of sine and cosine say."""
    if factor.is_nonzero:
        return False
    constant, varying = sp.expand(factor).as_coeff_Add()
    terms = sp.Add.make_args(varying)
    if not constant.is_Rational or not all(map(_is_wave, terms)):
        return True
    return bool(abs(constant) <= sum(abs(term.as_coeff_Mul()[0]) for term in terms))


def _is_wave(term: sp.Expr) -> bool:
    """Whether a term is a number times powers of sines and cosines of real angles."""
    bases = [part.as_base_exp() for part in term.as_coeff_Mul()[1].as_ordered_factors()]
    return all(isinstance(b, sp.sin | sp.cos) and b.args[0].is_real and n.is_Integer and n > 0 for b, n in bases)


def without_steep_exponentials(expression: sp.Expr) -> tuple[sp.Expr, dict[sp.Symbol, sp.Expr]]:
    """Expression with symbols for exponentials of large multiples, and what they stand for.

    SymPy takes exp(38.68 x) as the 967th power of exp(x/25), which no polynomial routine survives.
    """
    names: dict[sp.Expr, sp.Expr] = {}
    shown: dict[sp.Symbol, sp.Expr] = {}
    bases: dict[sp.Expr, tuple[sp.Rational, sp.Symbol]] = {}
    for term in sorted(expression.atoms(sp.exp), key=str):
        multiple, rest = term.args[0].as_coeff_Mul()
        if not multiple.is_Rational or max(abs(multiple.p), multiple.q) <= _STEEP:
            continue
        base, symbol = bases.get(rest, (multiple, sp.Dummy(positive=True)))
        if not (multiple / base).is_Integer or abs(multiple / base) > _STEEP:
            symbol, base = sp.Dummy(positive=True), multiple
        else:
            bases[rest] = base, symbol
        names[term] = symbol ** (multiple / base)
        shown[symbol] = sp.exp(base * rest)
    return expression.xreplace(names), shown


def vanishes(expression: sp.Expr, point: Mapping[sp.Symbol, sp.Expr]) -> bool:
    """Whether an expression is zero at a point, exactly, or to the rounding of the point's values.

    Parameters
    ----------
    expression : sympy.Expr
        A function of symbols.
    point : mapping of sympy.Symbol to sympy.Expr
        Exact values of some or all of them.

    Returns
    -------
    bool
        A rational value is zero only if it is; any other, such as cos(1.5707963), if a relative change of 1e-12 of the
        values could make it so.
    """
    return any(_factor_vanishes(one, point) for one in sp.Mul.make_args(factored(expression)))


def _factor_vanishes(factor: sp.Expr, point: Mapping[sp.Symbol, sp.Expr]) -> bool:
    value = tidy(factor.subs(point))
    if not value.is_number or value.is_Rational:
        return bool(value == 0)
    moved = [s for s in factor.free_symbols if s in point]
    uncertainty = sum(abs((sp.diff(factor, s) * s).subs(point).evalf()) for s in moved)
    return bool(abs(value.evalf()) <= _ROUNDING * uncertainty)


def _length(expression: sp.Expr) -> tuple[int, int]:
    """Operations, then sums: a product is preferred to a sum of the same length."""
    return int(sp.count_ops(expression)), len(expression.atoms(sp.Add))


def _pythagoras(quotient: sp.Expr) -> sp.Expr:
    for angle in sorted({term.args[0] for term in quotient.atoms(sp.sin, sp.cos)}, key=str):
        sine, cosine = sp.sin(angle), sp.cos(angle)
        forms = [quotient]
        for eliminated, kept in ((sine, cosine), (cosine, sine)):
            reduced = _reduce(quotient, eliminated, kept)
            if reduced != quotient:
                forms.append(sp.cancel(reduced))
        quotient = min(forms, key=_length)
    return quotient


def _reduce(quotient: sp.Expr, eliminated: sp.Expr, kept: sp.Expr) -> sp.Expr:
    """Numerator and denominator with even powers of one function written in the other: at most linear in it."""
    numerator, denominator = (
        _even_powers_replaced(part, eliminated, 1 - kept**2) if part.has(eliminated) else part
        for part in sp.fraction(quotient)
    )
    return quotient if denominator == 0 else numerator / denominator


def _even_powers_replaced(part: sp.Expr, function: sp.Expr, square: sp.Expr) -> sp.Expr:
    polynomial = sp.Poly(part)
    if function not in polynomial.gens:  # it occurs only within another function
        return part
    position = polynomial.gens.index(function)
    by_power: dict[int, dict[tuple[int, ...], sp.Expr]] = {}
    for powers, coefficient in polynomial.terms():
        halves, odd = divmod(powers[position], 2)
        left = (*powers[:position], odd, *powers[position + 1 :])
        by_power.setdefault(halves, {})[left] = coefficient
    if not any(by_power):  # at most linear as it is
        return part
    rest = {halves: sp.Poly.from_dict(terms, *polynomial.gens).as_expr() for halves, terms in by_power.items()}
    return sp.expand(sp.Add(*(square**halves * factor for halves, factor in rest.items())))
