"""The one simplification of this folder: short forms in lowest terms, fast and deterministic."""

from functools import lru_cache

import sympy as sp

from brunovsky.linearization.rank import in_sines_and_cosines

_ZERO = 1e-12


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
    cancelled = sp.cancel(expression)
    candidates = [_pythagoras(cancelled)]
    expanded = in_sines_and_cosines(expression)
    if expanded != expression:
        candidates.append(_pythagoras(sp.cancel(expanded)))
    # doit: factor_terms leaves unevaluated products that would not survive a substitution or pickling
    return min((sp.factor_terms(candidate, sign=True).doit() for candidate in candidates), key=_length)


def factored(expression: sp.Expr) -> sp.Expr:
    """Tidied expression with numerator and denominator as products of irreducible factors."""
    return min((sp.factor(tidy(expression)), tidy(sp.factor(expression))), key=_length)


def vanishes(value: sp.Expr) -> bool:
    """Whether an expression into which numbers were inserted is zero, exactly or to rounding."""
    value = tidy(value)
    return any(bool(factor.is_number and abs(factor.evalf()) < _ZERO) for factor in sp.Mul.make_args(value))


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
