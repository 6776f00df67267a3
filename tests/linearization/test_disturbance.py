"""Where disturbances and parameter errors enter the chains: for the robot, equations typed by hand."""

from collections.abc import Iterable

import pytest
import sympy as sp
from gallery_plants import linearized
from linearization_plants import D1, D2, ETA1, ETA2, RHO1, RHO2, THETA, U1, U2, W1, robot

from brunovsky.errors import LinearizationError, ModelError
from brunovsky.linearization import AffineSystem, DisturbanceMap, disturbance_map, linearize
from brunovsky.linearization.gallery import unicycle

HEADING = sp.Matrix([-sp.sin(THETA), sp.cos(THETA)])
ACROSS = sp.Matrix([-sp.cos(THETA), -sp.sin(THETA)])
C1, C2, C3, A1, A2 = sp.symbols("c1 c2 c3 A1 A2", positive=True)


@pytest.fixture(scope="module")
def robot_map() -> DisturbanceMap:
    return disturbance_map(linearized("nominal_robot"), robot())


def same(found: Iterable[sp.Expr], expected: Iterable[sp.Expr]) -> bool:
    return sp.simplify(sp.Matrix(list(found)) - sp.Matrix(list(expected))).is_zero_matrix


def test_with_chains_from_the_model(robot_map: DisturbanceMap) -> None:
    acceleration = D1 + (RHO1 - 1) * U1
    jerk = ETA1 * D2 + (RHO2 - 1) * ETA1 * U2 + ETA2 * acceleration
    for i in range(2):
        assert same(robot_map.model[i], (0, acceleration * HEADING[i], jerk * ACROSS[i]))


def test_with_measured_accelerations_all_is_matched(robot_map: DisturbanceMap) -> None:
    rate = robot_map.rates[D1]
    along = rate + (RHO1 - 1) * W1
    across = ETA1 * D2 + (RHO2 - 1) * ETA1 * U2 + 2 * ETA2 * (D1 + (RHO1 - 1) * U1)
    assert same(robot_map.measured, along * HEADING + across * ACROSS)
    assert set(robot_map.rates) == {D1}


def test_what_is_matched(robot_map: DisturbanceMap) -> None:
    assert robot_map.sources == (D1, D2, RHO1, RHO2)
    assert robot_map.orders(D1) == robot_map.orders(RHO1) == ((2, 3), (2, 3))
    assert robot_map.orders(D2) == robot_map.orders(RHO2) == ((3,), (3,))
    assert [robot_map.is_matched(source) for source in robot_map.sources] == [False, True, False, True]
    assert robot_map.gain_errors == (RHO2,)


def test_what_the_switching_gain_must_exceed(robot_map: DisturbanceMap) -> None:
    surface = [(C1, C2, C3)] * 2
    here = robot_map.switching_gain_bounds(surface, {D2: A2})
    assert same(here, (A2 * C3 * sp.Abs(ETA1 * sp.cos(THETA)), A2 * C3 * sp.Abs(ETA1 * sp.sin(THETA))))
    worst = robot_map.switching_gain_bounds(surface, {D1: A1, D2: A2}, worst_angles=[THETA])
    expected = A1 * sp.sqrt(C2**2 + C3**2 * ETA2**2) + A2 * C3 * sp.Abs(ETA1)
    assert same(worst, (expected, expected))
    steady = {ETA1: 2, ETA2: sp.Rational(1, 2), C2: 10, C3: 1, A1: 1, A2: 0}
    assert worst[0].subs(steady) <= 10 + sp.Rational(1, 2)  # c2 abs(d1) + c3 abs(d1 eta2)
    measured = robot_map.switching_gain_bounds(
        surface, {D1: A1, robot_map.rates[D1]: A2}, measured=True, worst_angles=[THETA]
    )
    assert same(measured, (2 * A1 * C3 * sp.Abs(ETA2) + A2 * C3,) * 2)
    assert robot_map.switching_gain_bounds(surface, {}) == (0, 0)


def test_the_map_is_the_chain_rule() -> None:
    """z_k' along the true plant, by substitution of numbers, for a plant with transformed inputs."""
    result = linearized("trailer")
    disturbance = sp.Symbol("slip", real=True)
    system = result.system
    heading = system.states[2]
    slipping = AffineSystem(
        system.states,
        system.inputs,
        system.drift,
        system.input_matrix,
        system.outputs,
        system.parameters,
        {disturbance: [-sp.sin(heading), sp.cos(heading), 0, 0]},
    )
    found = disturbance_map(result, slipping)
    assert found.orders(disturbance) == ((1,), (1,))
    for chain, added in zip(result.chains, found.model, strict=True):
        gradient = sp.Matrix([chain[0]]).jacobian(sp.Matrix(system.states))
        assert same(added[:1], [gradient.dot(slipping.disturbances[disturbance]) * disturbance])


def test_disturbances_of_the_nominal_plant_itself() -> None:
    nominal = robot().with_parameters({"rho1": 1, "rho2": 1})
    assert disturbance_map(linearize(nominal)).sources == (D1, D2)


def test_arguments_are_checked(robot_map: DisturbanceMap) -> None:
    with pytest.raises(ModelError, match=r"the plant has states \(x, y, theta\)"):
        disturbance_map(linearized("nominal_robot"), unicycle())
    with pytest.raises(ModelError, match="1 rows for 2 chains"):
        robot_map.switching_gain_bounds([(C1, C2, C3)], {})
    with pytest.raises(ModelError, match="2 weights for a chain of length 3"):
        robot_map.switching_gain_bounds([(C1, C2)] * 2, {})
    a, b, u, p = sp.symbols("a b u p", real=True)
    true = AffineSystem((a, b), (u,), [b, sp.sin(p * a)], [0, 1], (a,), (p,))
    found = disturbance_map(linearize(AffineSystem((a, b), (u,), [b, 0], [0, 1], (a,))), true)
    with pytest.raises(LinearizationError, match=r"p enters with the gain a\*cos\(a\*p\), not linearly"):
        found.switching_gain_bounds([(1, 1)], {p: 1})
    with pytest.raises(LinearizationError, match=r"not of the form a sin\(theta\)"):
        square = disturbance_map(linearize(robot_like()))
        square.switching_gain_bounds([(1, 1)], {D1: 1}, worst_angles=[THETA])


def robot_like() -> AffineSystem:
    a, u = sp.symbols("a u", real=True)
    return AffineSystem((a, THETA), (u,), [THETA, 0], [0, 1], (a,), (), {D1: [0, sp.sin(THETA) ** 2]})


def test_the_map_is_written_on_the_board() -> None:
    linearization = linearize(nominal_robot())
    text = disturbance_map(linearization, robot()).explain()
    assert "d1 enters in derivative 2/3 of output 1, 2/3 of output 2: not matched." in text
    assert "rho2 enters in derivative 3 of output 1, 3 of output 2: matched; no constant gain bounds it." in text
    assert "  dZ1_2/dt - Z1_3 = (-d1 - rho1*u1 + u1)*sin(theta)" in text
    assert r"\dot{d_{1}} \cos{\left(\theta \right)}" in disturbance_map(linearization, robot()).latex()
    assert "Disturbances\n------------" in linearize(robot().with_parameters({"rho1": 1, "rho2": 1})).explain()
