"""The chain rule against SymPy's derivatives."""

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

from brunovsky.native.chain_rule import ChainRule

X, Y, Z = sp.symbols("x y z", real=True)
ON = sp.Symbol("on")
POINT = {X: sp.Rational(3, 10), Y: sp.Rational(9, 10), Z: sp.Rational(17, 10)}
LEAVES = st.sampled_from([X, Y, Z, sp.Integer(2), sp.Rational(1, 3), sp.Float(0.7), sp.pi])


def combined(parts: st.SearchStrategy[sp.Expr]) -> st.SearchStrategy[sp.Expr]:
    """Sums, products, powers, functions and branches of expressions."""
    one = st.sampled_from([sp.sin, sp.cos, sp.exp, sp.atan, sp.tanh, lambda a: a**2, lambda a: 1 / (a**2 + 1)])
    two = st.sampled_from(
        [sp.Add, sp.Mul, sp.atan2, lambda a, b: (a**2 + 1) ** b, lambda a, b: sp.Piecewise((a, ON), (b, True))]
    )
    return st.builds(lambda f, a: f(a), one, parts) | st.builds(lambda f, a, b: f(a, b), two, parts, parts)


@settings(max_examples=60)
@given(st.recursive(LEAVES, combined, max_leaves=6), st.sampled_from([X, Y, Z]), st.booleans())
def test_partial_derivatives_are_those_of_sympy(expression, symbol, on):
    found, expected = (
        one.subs(ON, sp.sympify(on)).subs(POINT).evalf(30)
        for one in (ChainRule({symbol: sp.S.One})(expression), sp.diff(expression, symbol))
    )
    if not expected.has(sp.nan, sp.zoo, sp.oo):
        assert abs(found - expected) <= 1e-9 * (1 + abs(expected))


def test_rates_of_several_symbols_add_up():
    rule = ChainRule({X: Y, Y: -X})
    assert rule(X**2 + Y**2) == 0
    assert rule(Z * sp.sin(X)) == Z * Y * sp.cos(X)
    assert rule(sp.pi) == 0


@pytest.mark.parametrize("power", [2, 3, sp.Rational(3, 2)])
def test_the_derivative_of_a_power_is_finite_where_the_base_vanishes(power):
    assert ChainRule({X: Y})(X**power).subs(X, 0) == 0


def test_a_symbol_whose_rate_comes_later_moves():
    rates = {X: Y}
    rule = ChainRule(rates)
    assert rule(X**2) == 2 * X * Y
    rates[Y] = Z
    assert rule(2 * X * Y) == 2 * Y**2 + 2 * X * Z
