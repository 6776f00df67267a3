"""Distance to the singular locus, and regular starts on it."""

import pytest
import sympy as sp
from gallery_plants import linearized
from linearization_plants import ETA1, ETA2, THETA, U1, U2, V1, V2, W1, nominal_robot

from brunovsky.errors import LinearizationError, ModelError, ParameterError
from brunovsky.linearization import distance_to_singularity, linearize, regular_start

HEADING = sp.Matrix([-sp.sin(THETA), sp.cos(THETA)])
ACROSS = sp.Matrix([-sp.cos(THETA), -sp.sin(THETA)])
V = sp.Matrix([V1, V2])


def test_distance_of_the_robot_is_its_speed() -> None:
    result = linearized("nominal_robot")
    assert result.distance_to_singularity({"eta1": -0.3}) == pytest.approx(0.3)
    assert result.distance_to_singularity({ETA1: 0}) == 0
    for speed, smallest in ((-0.3, 0.3), (0.0, 0.0), (5.0, 1.0)):
        point = {"eta1": speed, "theta": 1.2}
        assert distance_to_singularity(result, point, "singular_value") == pytest.approx(smallest, abs=1e-12)


def test_distance_of_other_plants() -> None:
    trailer = linearized("trailer")
    assert trailer.distance_to_singularity({"v": 2, "phi": 0.1, "theta": 0.1 + sp.pi / 3}) == pytest.approx(1.0)
    jack_knife = {"v": 2, "phi": 0, "theta": sp.pi / 2 - sp.Rational(1, 10**6), "L": 1}
    assert 0 < trailer.distance_to_singularity(jack_knife, "singular_value") < 2e-6
    assert linearized("pvtol_centre").distance_to_singularity({}) == float("inf")


def test_arguments_of_the_distance_are_checked() -> None:
    result = linearized("nominal_robot")
    with pytest.raises(ParameterError, match="no value for eta1"):
        result.distance_to_singularity({"theta": 0})
    with pytest.raises(ModelError, match="measure is 'far'"):
        result.distance_to_singularity({"eta1": 1}, "far")  # type: ignore[arg-type]


def test_regular_start_of_the_robot_at_rest() -> None:
    start = linearized("nominal_robot").regular_start({"eta1": 0})
    chains = list(start.chains)
    acceleration = sp.Matrix([chains[2], chains[5]])
    first, second, across = start.conditions
    assert (first, second) == (sp.Eq(chains[1], 0), sp.Eq(chains[4], 0))
    assert sp.simplify(across.lhs**2 - ACROSS.dot(acceleration) ** 2) == 0  # z'' parallel to h
    assert sp.simplify(start.states[U1] - HEADING.dot(acceleration)) == 0
    assert sp.simplify(start.states[ETA2] - ACROSS.dot(V) / (2 * U1)) == 0
    assert start.nonzero == (U1,)
    # with j_perp the component of v across the heading, which itself turns with eta2
    rate = ACROSS.dot(sp.Matrix(start.rates)) + ETA2 * ACROSS.diff(THETA).dot(V)
    assert sp.simplify(start.inputs[W1] - HEADING.dot(V)) == 0
    assert sp.simplify(start.inputs[U2] - (rate - 2 * start.inputs[W1] * ETA2) / (3 * U1)) == 0
    assert start.equations == ()


def test_true_rest_needs_a_jerk_along_the_heading() -> None:
    start = regular_start(linearized("nominal_robot"), {"eta1": 0, "eta2": 0})
    assert len(start.conditions) == 4
    assert sp.simplify(start.conditions[-1].lhs ** 2 - ACROSS.dot(V) ** 2) == 0
    assert set(start.states) == {U1}
    assert sp.simplify(start.inputs[U2] - ACROSS.dot(sp.Matrix(start.rates)) / (3 * U1)) == 0


def test_the_inputs_of_a_regular_start_are_the_limit_of_the_law() -> None:
    result = linearized("nominal_robot")
    start = result.regular_start({"eta1": 0})
    t = sp.Symbol("t")
    # a trajectory through rest: z = p(t) with p'(0) = 0; its states follow from the inverse map
    z = (sp.Rational(1, 2) * t**2 * 3 + t**3 / 5 + t**4 / 7, 2 * t**2 + t**3 / 3 - t**4 / 11)
    derivatives = [[sp.diff(one, t, k) for k in range(5)] for one in z]
    chains = {
        name: part
        for names, parts in zip(result.normal_form.chains, derivatives, strict=True)
        for name, part in zip(names, parts, strict=False)
    }
    later = {name: part.subs(t, sp.Rational(1, 10**5)) for name, part in chains.items()}
    states = {state: value.subs(later) for state, value in result.normal_form.inverse.items()}
    outer = {v: parts[3].subs(t, sp.Rational(1, 10**5)) for v, parts in zip((V1, V2), derivatives, strict=True)}
    by_law = {symbol: float(law.subs(outer).subs(states)) for symbol, law in result.law.items()}
    at_rest = {name: part.subs(t, 0) for name, part in chains.items()}
    values = {V1: derivatives[0][3].subs(t, 0), V2: derivatives[1][3].subs(t, 0), THETA: sp.atan2(-3, 4)}
    values |= dict(zip(start.rates, (parts[4].subs(t, 0) for parts in derivatives), strict=True))
    values[U1] = start.states[U1].subs(values | at_rest)
    values[ETA2] = start.states[ETA2].subs(values)
    assert all(condition.subs(at_rest).subs(values) == sp.true for condition in start.conditions)
    assert float(values[ETA2]) == pytest.approx(float(states[ETA2]), rel=1e-3)
    for symbol, law in by_law.items():
        assert float(start.inputs[symbol].subs(values)) == pytest.approx(law, rel=1e-3)


def test_regular_starts_of_other_plants() -> None:
    beam = linearized("ball_and_beam")
    level = beam.regular_start({"omega": 0})  # b g cos(alpha) u = 2 b r u^2 - y'''' at omega = 0: not linear
    assert level.inputs == {} and len(level.equations) == 1
    centre = beam.regular_start({"omega": 0, "r": 0})
    (u,) = beam.extended_system.inputs
    (rate,) = centre.rates
    b, alpha = sp.Symbol("b", positive=True), sp.Symbol("alpha", real=True)
    assert sp.simplify(centre.inputs[u] + rate / (sp.Rational(981, 100) * b * sp.cos(alpha))) == 0
    falling = linearized("pvtol_flat").regular_start({"u1": 0})
    assert [str(symbol) for symbol in falling.nonzero] == ["w1"]


@pytest.mark.parametrize(
    ("point", "message"),
    [
        ({"eta1": 1}, r"at eta1 = 1 the law is regular; .* where eta1 = 0"),
    ],
)
def test_points_without_a_regular_start_are_refused(point: dict[str, float], message: str) -> None:
    with pytest.raises(LinearizationError, match=message):
        linearize(nominal_robot()).regular_start(point)
