"""The tools underneath: Lie derivatives and brackets, generic rank, short forms."""

import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st
from sympy import cos, exp, sin, sqrt, tan

from brunovsky.errors import LinearizationError, ModelError
from brunovsky.linearization import generic_rank, lie_bracket, lie_derivative
from brunovsky.linearization.rank import confirms_rank, is_zero
from brunovsky.linearization.simplify import factored, tidy

X, Y, Z = sp.symbols("x y z", real=True)
STATES = (X, Y, Z)


def test_lie_derivative_by_hand() -> None:
    field = (Y, -sin(X), 0)
    assert lie_derivative(X * Z, field, STATES) == Y * Z
    assert sp.expand(lie_derivative(X * Z, field, STATES, 2)) == -Z * sin(X)
    assert lie_derivative(X * Z, field, STATES, 0) == X * Z


def test_lie_bracket_by_hand() -> None:
    rotate, move = (0, 0, 1), (cos(Z), sin(Z), 0)
    assert lie_bracket(move, rotate, STATES) == sp.Matrix([sin(Z), -cos(Z), 0])
    assert lie_bracket(rotate, move, STATES, 2) == sp.Matrix([-cos(Z), -sin(Z), 0])
    assert lie_bracket(rotate, move, STATES, 0) == sp.Matrix(move)


polynomials = st.lists(st.integers(-3, 3), min_size=5, max_size=5).map(
    lambda c: c[0] + c[1] * X + c[2] * Y * Z + c[3] * X**2 + c[4] * sin(Y)
)
fields = st.lists(polynomials, min_size=3, max_size=3)


@settings(max_examples=25)
@given(h=polynomials, f=fields, g=fields)
def test_the_derivative_along_a_bracket_is_the_commutator(h: sp.Expr, f: list[sp.Expr], g: list[sp.Expr]) -> None:
    along = lie_derivative(h, lie_bracket(f, g, STATES), STATES)
    commutator = lie_derivative(lie_derivative(h, g, STATES), f, STATES) - lie_derivative(
        lie_derivative(h, f, STATES), g, STATES
    )
    assert sp.expand(along - commutator) == 0


def test_fields_and_orders_are_checked() -> None:
    with pytest.raises(ModelError, match="the vector field has 2 entries for 3 states"):
        lie_derivative(X, (X, Y), STATES)
    with pytest.raises(ModelError, match="the field g has 1 entries for 3 states"):
        lie_bracket((X, Y, Z), (X,), STATES)
    with pytest.raises(ModelError, match="order is -1"):
        lie_derivative(X, STATES, STATES, -1)


@pytest.mark.parametrize(
    ("matrix", "rank"),
    [
        ([[sin(X), cos(X)], [-cos(X), sin(X)]], 2),
        ([[sin(X), cos(X)], [sin(X) * tan(X), sin(X)]], 1),
        ([[X, X * Y], [1, Y]], 1),
        ([[sin(2 * X), 2 * sin(X) * cos(X)], [1, 1]], 1),
        ([[sin(X + Y), sin(X) * cos(Y) + cos(X) * sin(Y)], [1, 1]], 1),
        ([[X, sin(X)], [sin(X), X]], 2),
        ([[exp(X), exp(X + Y)], [1, exp(Y)]], 1),
        ([[exp(X), exp(2 * X)], [1, exp(3 * X)]], 2),
        ([[sqrt(X**2 + 1), X**2 + 1, 1], [1, sqrt(X**2 + 1), 0]], 2),
        ([[sin(X / 2) * cos(X / 2), sin(X)], [1, 2]], 1),
        ([[0, 0]], 0),
    ],
)
def test_generic_rank(matrix: list[list[sp.Expr]], rank: int) -> None:
    assert generic_rank(sp.Matrix(matrix)) == rank


def test_points_respect_the_assumptions_of_symbols() -> None:
    negative = sp.Symbol("n", negative=True)
    whole = sp.Symbol("k", integer=True)
    assert is_zero(sp.log(-negative) + sp.log(-1 / negative))
    assert is_zero(sqrt(negative**2) + negative)
    assert is_zero(sin(sp.pi * whole) * X)
    assert not is_zero(sp.log(-negative))


@pytest.mark.parametrize("zero", [sin(X) ** 2 + cos(X) ** 2 - 1, exp(X) * exp(Y) - exp(X + Y)])
def test_an_expression_that_is_nowhere_finite_is_refused(zero: sp.Expr) -> None:
    with pytest.raises(LinearizationError, match="is not finite at 3 random points"):
        generic_rank(sp.Matrix([1 / zero]))


@pytest.mark.parametrize(
    ("expression", "short"),
    [
        (X * sin(Z) ** 2 + X * cos(Z) ** 2, X),
        ((1 - cos(Z) ** 2) / sin(Z), sin(Z)),
        ((X**2 - Y**2) / (X - Y), X + Y),
        (sin(X + Y) * cos(X) - cos(X + Y) * sin(X), sin(Y)),
        (-X * cos(Z) ** 4 - X * cos(Z) ** 2 * sin(Z) ** 2, -X * cos(Z) ** 2),
        (exp(X) * exp(-X) * Y, Y),
        (tan(X) * cos(X), sin(X)),
    ],
)
def test_short_forms(expression: sp.Expr, short: sp.Expr) -> None:
    assert tidy(expression) == short


def test_factors_show_where_a_determinant_vanishes() -> None:
    assert factored(X**2 * Y - X * Y * Z) == X * Y * (X - Z)
    assert factored(sin(Z) ** 2 * X - X) == -X * cos(Z) ** 2


trigonometric = st.lists(
    st.tuples(st.integers(-3, 3), st.integers(0, 3), st.integers(0, 3), st.integers(0, 2)), max_size=5
)


@settings(max_examples=40)
@given(top=trigonometric, bottom=trigonometric)
def test_tidying_keeps_the_value(top: list[tuple[int, ...]], bottom: list[tuple[int, ...]]) -> None:
    numerator, denominator = (
        sp.Add(*(c * sin(Z) ** i * cos(Z) ** j * X**k for c, i, j, k in terms)) for terms in (top, bottom)
    )
    expression = numerator / (denominator + 20 * X**3 + 1)
    point = {X: 0.7, Z: 1.1}
    assert float(tidy(expression).subs(point)) == pytest.approx(float(expression.subs(point)), rel=1e-9, abs=1e-12)
    assert sp.count_ops(tidy(expression)) <= sp.count_ops(sp.cancel(expression)) + 2


def test_a_singular_rank_is_confirmed_by_elimination() -> None:
    a, b, c = sp.symbols("a b c", real=True)
    turn = sp.Matrix([[sp.cos(a), sp.sin(a)], [sp.cos(a) * b, sp.sin(a) * b]])
    assert generic_rank(turn) == 1 and confirms_rank(turn, 1) and not confirms_rank(turn, 0)
    double = sp.Matrix([[sp.sin(2 * a), sp.cos(a)], [2 * sp.sin(a), 1]])  # sin 2a = 2 sin a cos a
    assert generic_rank(double) == 1 and confirms_rank(double, 1)
    transcendent = sp.Matrix([[sp.exp(c), b * sp.exp(c)], [sp.sqrt(b**2 + 1), b * sp.sqrt(b**2 + 1)]])
    assert generic_rank(transcendent) == 1 and confirms_rank(transcendent, 1)
    assert confirms_rank(sp.eye(2), 2)
    large = sp.Matrix(2, 2, lambda i, j: sum(a**k * b**i * sp.sin(c) ** j for k in range(400)))
    assert not confirms_rank(large, 1)
