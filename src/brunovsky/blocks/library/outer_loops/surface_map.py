"""How v moves the surface of a chain over one period of a zero-order hold: the Euler form and the exact map.

With v held over h the error e = Z - Zd obeys e+ = Phi e + Gamma (v - y_d^(r)), with the known integrals h^k/k! in Phi
and Gamma as long as y_d^(r) is held too, so that C e+ is affine in v. ``"exact"`` keeps all of it, ``"euler"`` the
first power of h. Written for numbers and for symbols alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from math import comb, factorial
from typing import Any, Literal

import sympy as sp

from brunovsky.blocks.library.chains import Chains
from brunovsky.blocks.library.gains import Gains
from brunovsky.blocks.variables import Check, Input, Parameter

SurfaceMap = Literal["euler", "exact"]
PERIOD = Parameter("sampling_period", "s", "sampling period; v is held between samples", 0.01, 1e-6)


def mean_rates(c: Sequence[Any], h: Any, surface_map: SurfaceMap) -> list[Any]:
    """Row m and gain b of the mean of S' over a period, (S+ - S)/h = m e + b (v - y_d^(r)).

    Parameters
    ----------
    c : sequence of float or sympy.Expr, shape (r,)
        Surface.
    h : float or sympy.Expr
        Period, s.
    surface_map : {"euler", "exact"}
        Whether only the first power of h is kept.

    Returns
    -------
    list, shape (r + 1,)
        m_1, ..., m_r, b.
    """
    r = len(c)
    if surface_map == "euler":
        return [0 * c[0], *c]
    return [
        sum((c[j - 1] * h ** (k - j - 1) / factorial(k - j) for j in range(1, k)), 0 * c[0]) for k in range(1, r + 2)
    ]


def mean_rate(
    chains: Chains, i: int, c: Sequence[sp.Symbol], surface_map: SurfaceMap, *, preview: bool
) -> tuple[sp.Expr, sp.Expr]:
    """Part of (S+ - S)/h that does not depend on v_i, and the gain of v_i in it."""
    *rates, gain = mean_rates(c, PERIOD.symbol, surface_map)
    elements = range(1, chains.orders[i - 1] + 1)
    if not preview:
        errors = list(chains.error(i))
        return sum(m * e for m, e in zip(rates, errors, strict=True)) - gain * chains.feedforward(i), gain
    now, ahead = references(chains, i), [one.symbol for one in references_ahead(chains, i)]
    states = [one + now[k - 1] for k, one in zip(elements, chains.error(i), strict=True)]
    moved = sum(one * (after - before) for one, after, before in zip(c, ahead, now, strict=True))
    return sum(m * z for m, z in zip(rates, states, strict=True)) - moved / PERIOD.symbol, gain


def references(chains: Chains, i: int) -> list[sp.Symbol]:
    """Symbols ``Zid[k]`` of a chain."""
    return [one.symbol for one in chains.references if one.name.startswith(f"Z{i}d[")]


def references_ahead(chains: Chains, i: int) -> tuple[Input, ...]:
    """Inputs ``Zid_next[k]``, the reference of a chain at the next sample."""
    return tuple(
        Input(one.name.replace("d[", "d_next["), one.unit, f"{one.description}, one sampling period ahead")
        for one in chains.references
        if one.name.startswith(f"Z{i}d[")
    )


def sampled_stability(
    c: Sequence[sp.Expr], q: sp.Expr, h: sp.Expr, surface_map: SurfaceMap
) -> sp.logic.boolalg.Boolean:
    """Condition under which the error decays, sampled, under v = y_d^(r) - (q S + m e)/b.

    From v to e_k the sampled chain has h^n B_n(z)/(n! (z - 1)^n), n = r - k + 1, where B_n are the Euler-Frobenius
    polynomials 1, z + 1, z^2 + 4 z + 1, ...; with z = (1 + w)/(1 - w) the poles are inside the unit circle where the
    characteristic polynomial in w is Hurwitz (Liénard and Chipart's form: coefficients and every other minor).

    References
    ----------
    K. J. Åström, P. Hagander and J. Sternby, "Zeros of sampled systems", Automatica 20(1), 31-38, 1984.
    """
    *rates, gain = mean_rates(c, h, surface_map)
    r, w = len(c), sp.Symbol("w")
    parts = [(gain, (2 * w) ** r)]
    for k, (coefficient, rate) in enumerate(zip(c, rates, strict=True), 1):
        n = r - k + 1
        numerator = sum(_eulerian(n, j) * (1 + w) ** j * (1 - w) ** (n - 1 - j) for j in range(n))
        parts.append(((q * coefficient + rate) * h**n / factorial(n), numerator * (1 - w) * (2 * w) ** (r - n)))
    polynomials = [(weight, sp.Poly(sp.expand(one), w).all_coeffs()[::-1]) for weight, one in parts]
    values = [gain * sum(weight * one[p] for weight, one in polynomials if p < len(one)) for p in range(r + 1)]
    symbols, minors = _hurwitz_minors(r)
    substitution = dict(zip(symbols, values, strict=True))
    return sp.And(*(one.xreplace(substitution) > 0 for one in (*symbols, *minors)))


@cache
def _hurwitz_minors(degree: int) -> tuple[tuple[sp.Symbol, ...], tuple[sp.Expr, ...]]:
    """Coefficients of a polynomial, constant first, and the minors of order degree - 1, degree - 3, ... above 1."""
    a = tuple(sp.Dummy(real=True) for _ in range(degree + 1))
    index = [[degree - 1 - 2 * j + i for j in range(degree)] for i in range(degree)]
    matrix = sp.Matrix([[a[k] if 0 <= k <= degree else 0 for k in row] for row in index])
    orders = range(degree - 1, 1, -2)
    return a, tuple(sp.expand(matrix[:k, :k].det(method="berkowitz")) for k in orders)


def _eulerian(n: int, k: int) -> int:
    return sum((-1) ** j * comb(n + 1, j) * (k + 1 - j) ** n for j in range(k + 1))


def period_checks(
    c: Gains, surface_map: SurfaceMap, *, q: Gains | None = None, when: Literal["start", "failure"] = "start"
) -> tuple[Check, ...]:
    """The sampled linear part is stable: with S+ = 0 where ``q`` is not given, else with S+ = (1 - h q) S.

    q = 0, which leaves S alone, is taken as the limit from above.
    """
    h = PERIOD.symbol
    least = sp.Float(1e-6) / h
    remedy = "take a shorter one" + ("" if surface_map == "exact" else ", or surface_map='exact'")
    what = "on the surface" if q is None else "off the surface, where the linear part with Q acts,"
    argument = "" if q is None else ", reaching_rate=Q"
    rows = [(row, None) for row in c.rows] if q is None else list(zip(c.rows, (one for (one,) in q.rows), strict=True))
    return tuple(
        Check(
            "sampling period" if when == "start" else "sampling",
            sampled_stability(
                [one.symbol for one in row], 1 / h if rate is None else rate.symbol + least, h, surface_map
            ),
            f"{PERIOD.name} is too long: {what} the sampled error of the surface "
            f"{', '.join(one.name for one in row)} grows; {remedy} "
            f"(brunovsky.analysis.largest_sampling_period(surface{argument}, surface_map='{surface_map}'))",
            when=when,
        )
        for row, rate in dict.fromkeys(rows)
    )
