"""Plants in SI units, steep functions, names and domains: what is small is not zero, what is not real is refused."""

import dataclasses

import pytest
import sympy as sp

from brunovsky.errors import LinearizationError, ModelError
from brunovsky.linearization import (
    AffineSystem,
    disturbance_map,
    gallery,
    generic_rank,
    linearize,
    static_linearizability,
)

X1, X2, X3, U, D = sp.symbols("x1 x2 x3 u d", real=True)
Z = sp.Symbol("z")


def second_order(drift: sp.Expr, gain: sp.Expr = sp.S.One) -> AffineSystem:
    return AffineSystem((X1, X2), (U,), [drift, 0], [0, gain], (X1,))


def test_a_reactor_in_si_units_has_relative_degree_two() -> None:
    """Arrhenius: exp(-8750/T) is 1e-3800 at T = 1 and no zero."""
    c, temperature, cooling = sp.symbols("c T q", real=True)
    rate = sp.Float(7.2e10) * sp.exp(-8750 / temperature)
    drift = [(1 - c) - rate * c, (350 - temperature) + 209.2 * rate * c - 2.09 * temperature]
    reactor = AffineSystem((c, temperature), (cooling,), drift, [0, 2.09], (c,))
    assert linearize(reactor).relative_degree == (2,)
    assert static_linearizability(reactor).answer


@pytest.mark.parametrize(
    "function", [sp.exp(-8750 / X2), sp.exp(-(X2**2) / 0.002), sp.Float("1e-42") * sp.exp(X2), sp.exp(X2 / 0.02585)]
)
def test_functions_far_from_one_are_not_taken_for_zero(function: sp.Expr) -> None:
    assert generic_rank(sp.Matrix([function])) == 1
    assert linearize(second_order(function)).relative_degree == (2,)


def test_cancellation_is_still_seen() -> None:
    same = sp.exp(-8750 / X2) * sp.exp(8750 / X2 + X1) - sp.exp(X1)
    assert generic_rank(sp.Matrix([sp.Add(*same.args, evaluate=False)])) == 0
    assert generic_rank(sp.Matrix([[sp.exp(-900 * X1), 1], [sp.exp(-900 * X1) * X2, X2]])) == 1


def test_many_periods_and_steep_exponentials_do_not_explode() -> None:
    assert linearize(second_order(X2 + sp.sin(314 * X2))).determinant == 314 * sp.cos(314 * X2) + 1
    diode = AffineSystem((X1, X2), (U,), [sp.exp(X2 / 0.02585) - X1, -X2], [0, 1], (X1,))
    assert linearize(diode).determinant.has(sp.exp)


def test_a_small_determinant_is_no_singular_one() -> None:
    system = second_order(X2, X1 / sp.Integer(10) ** 13)
    assert linearize(system, operating_point={"x1": 1, "x2": 0}).determinant == X1 / sp.Integer(10) ** 13
    with pytest.raises(LinearizationError, match="move the operating point off x1 = 0"):
        linearize(system, operating_point={"x1": 0})
    rounded = second_order(X2, sp.cos(X1) / sp.Integer(10) ** 9)
    with pytest.raises(LinearizationError, match="singular there"):
        linearize(rounded, operating_point={"x1": 1.5707963267948966})
    assert linearize(rounded, operating_point={"x1": 1.5707}).relative_degree == (2,)


def test_floats_are_the_rationals_they_print_as() -> None:
    system = AffineSystem((X1,), (U,), [0.04938271563999999 * X1 + 0.142857142], [1 / 3], (X1,))
    assert system.drift[0] == sp.Rational("0.04938271563999999") * X1 + sp.Rational("0.142857142")
    assert system.input_matrix[0] == sp.Rational("0.3333333333333333")


def test_static_linearizability_does_not_depend_on_the_order_of_inputs() -> None:
    a, b = sp.symbols("a b", real=True)
    for inputs, gains in (((a, b), [[0, 0], [X1, 1]]), ((b, a), [[0, 0], [1, X1]])):
        system = AffineSystem((X1, X2), inputs, [X2, 0], gains, (X1, X2))
        assert static_linearizability(system, operating_point={"x1": 0, "x2": 0}).answer


def test_measured_chains_see_every_derivative_of_a_disturbance() -> None:
    system = AffineSystem((X1, X2, X3), (U,), [X2, X3, 0], [0, 0, 1], (X1,), disturbances={D: [1, 0, 0]})
    found = disturbance_map(linearize(system))
    dot, ddot = (sp.Symbol(name, real=True) for name in ("d_dot", "d_ddot"))
    assert found.measured == (ddot,) and dict(found.rates) == {D: dot, dot: ddot}
    assert found.switching_gain_bounds([[1, 1, 1]], {D: 2, ddot: 3}, measured=True) == (3,)
    with pytest.raises(ModelError, match="its derivative d_ddot enters too"):
        found.switching_gain_bounds([[1, 1, 1]], {D: 2}, measured=True)


def test_wind_on_the_quadrotor_is_not_matched() -> None:
    wind = sp.Symbol("w_x", real=True)
    plant = dataclasses.replace(gallery.quadrotor(), disturbances={wind: [0] * 6 + [1] + [0] * 5})
    found = disturbance_map(linearize(plant))
    assert found.orders(wind) == ((2,), (), (), ()) and not found.is_matched(wind)
    assert found.measured == (sp.Symbol("w_x_ddot", real=True), 0, 0, 0)


def test_zero_dynamics_are_refused_where_the_law_does_not_exist() -> None:
    zero = linearize(AffineSystem((X1, X2), (U,), [0, -X2], [X1, 1], (X1,))).zero_dynamics
    assert zero is not None and zero.eigenvalues({"x1": 1, "x2": 0}) == pytest.approx([-1])
    with pytest.raises(LinearizationError, match="the law does not exist, as x1 = 0 there"):
        zero.is_minimum_phase({"x1": 0, "x2": 0})


@pytest.mark.parametrize("gain", [2 + sp.cos(X1), 3 - sp.sin(X1) * sp.cos(X2), sp.Integer(2) ** X1, 1 + X1**2])
def test_factors_that_cannot_vanish_are_not_in_the_locus(gain: sp.Expr) -> None:
    assert linearize(second_order(X2, gain)).singular_locus == sp.false


@pytest.mark.parametrize(
    ("function", "message"),
    [
        (sp.sqrt(-1 - X1**2), "is not real"),
        (sp.arg(Z), "not an elementary function"),
        (sp.KroneckerDelta(X1, 0), "not an elementary function"),
        (sp.gamma(X1), "not an elementary function"),
        (sp.sqrt(Z**2), "Abs"),
        (sp.AccumBounds(0, 1) * X1, "AccumBounds"),
    ],
)
def test_what_is_not_smooth_or_real_is_refused_at_construction(function: sp.Expr, message: str) -> None:
    with pytest.raises(ModelError, match=message):
        AffineSystem((X1, X2, Z), (U,), [function, 0, 0], [0, 1, 0], (X1,))


@pytest.mark.parametrize("function", [sp.log(X1), sp.sqrt(X1)])
def test_operating_points_outside_the_real_domain_are_refused(function: sp.Expr) -> None:
    with pytest.raises(LinearizationError, match="is not real there"):
        linearize(second_order(X2, function), operating_point={"x1": -1})


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"operating_point": [0]}, "give a mapping"),
        ({"max_extensions": "3"}, "give 0, 1, 2"),
        ({"max_extensions": 2.5}, "2.5"),
    ],
)
def test_arguments_of_the_wrong_kind_are_named(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(ModelError, match=message):
        linearize(second_order(X2), **arguments)  # type: ignore[arg-type]


def test_inputs_that_stand_alone_are_not_renamed() -> None:
    """Three inputs: u3 alone in a row keeps its name, the combination of the others becomes an input."""
    a, b, c, d, e, f = sp.symbols("a b c d e f", real=True)
    u1, u2, u3 = sp.symbols("u1 u2 u3", real=True)
    gains = [[1, d, 0], [0, 0, -1], [e, e * d, 1], [0, 1, 0], [0, 1, 0], [0, 0, 1]]
    system = AffineSystem((a, b, c, d, e, f), (u1, u2, u3), [0, 0, 0, -d, f, 0], gains, (a, b, c))
    step = linearize(system).extension.steps[0]
    assert step.transformation is not None
    assert u3 in step.delayed and list(step.transformation.combinations.values()) == [u1 + d * u2]
