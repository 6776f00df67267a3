"""The shipped blocks against MODEL's equations, typed here by hand."""

import itertools

import numpy as np
import pytest
import sympy as sp

import brunovsky as br
from brunovsky.blocks import symbols

theta, eta1, eta2, u1, v1, v2 = symbols("theta", "eta[1]", "eta[2]", "u[1]", "v[1]", "v[2]")


def expression(block: br.Block, name: str) -> sp.Expr:
    return next(one.expression for one in block.outputs if one.name == name)


def test_linearized_robot_is_the_paper_s() -> None:
    block = br.blocks.linearized_robot()
    regular = {one.symbol: sp.true for one in block.relations}
    u2 = -(v1 * sp.cos(theta) + v2 * sp.sin(theta) + 2 * eta2 * u1) / eta1
    assert sp.simplify(expression(block, "u[2]").xreplace(regular) - u2) == 0
    w1 = -v1 * sp.sin(theta) + v2 * sp.cos(theta) + eta1 * eta2**2
    (state,) = (one for one in block.states if one.name == "u[1]")
    assert sp.simplify(state.derivative - w1) == 0
    chain = [symbols("x")[0], -eta1 * sp.sin(theta), -eta1 * eta2 * sp.cos(theta) - u1 * sp.sin(theta)]
    assert [sp.simplify(expression(block, f"Z1[{k}]") - z) for k, z in enumerate(chain, 1)] == [0, 0, 0]


def test_guard_is_continuous_and_zero_at_rest() -> None:
    block = br.blocks.linearized_robot()
    (limit,) = symbols("eta_min")
    guarded = expression(block, "u[2]").xreplace({one.symbol: sp.false for one in block.relations})
    plain = expression(block, "u[2]").xreplace({one.symbol: sp.true for one in block.relations})
    assert sp.simplify((guarded - plain).subs(eta1, limit)) == 0
    assert sp.simplify((guarded - plain).subs(eta1, -limit)) == 0
    assert guarded.subs(eta1, 0) == 0
    assert not sp.fraction(sp.together(next(s.derivative for s in block.states if s.name == "u[1]")))[1].free_symbols


@pytest.mark.parametrize(
    ("speed", "singular"), [(0.051, False), (0.05, True), (0.0, True), (-0.05, True), (-0.051, False)]
)
def test_singular_output_and_indicators(speed: float, singular: bool) -> None:
    block = br.blocks.linearized_robot()
    result = br.simulate(block, 1e-3, parameters={"eta_start[1]": speed})
    assert bool(result["singular"].values[0]) is singular
    limit = symbols("eta_min")[0]
    assert block.indicators == (eta1 - limit, eta1 + limit)


def test_disturbances_and_ratios_act_on_the_plant_alone() -> None:
    block = br.blocks.linearized_robot()
    d1, d2, rho1, rho2 = symbols("d[1]", "d[2]", "rho[1]", "rho[2]")
    slopes = {one.name: one.derivative for one in block.states}
    assert sp.simplify(slopes["eta[1]"] - (rho1 * u1 + d1)) == 0
    assert sp.simplify(slopes["eta[2]"] - (rho2 * expression(block, "u[2]") + d2)) == 0
    law = expression(block, "u[2]").free_symbols | slopes["u[1]"].free_symbols
    assert not law & {d1, d2, rho1, rho2}


def test_circle_is_a_circle_with_exact_derivatives() -> None:
    result = br.simulate(br.blocks.circle(), 2.0, step_size=1e-3, parameters={"center[1]": 1.0, "phase": 0.3})
    time = result["time"].values
    assert result["Z1d[1]"].values == pytest.approx(1 + 2**0.5 * np.cos(0.5 * time + 0.3))
    for chain in (1, 2):
        names = [f"Z{chain}d[{k}]" for k in (1, 2, 3)] + [f"zd3[{chain}]"]
        for low, high in itertools.pairwise(names):
            slope = (result[low].values[2:] - result[low].values[:-2]) / 2e-3
            assert slope == pytest.approx(result[high].values[1:-1], abs=1e-6)


def test_without_switching_gain_sliding_mode_is_pole_placement() -> None:
    """P = 0 is the linear law with K = [Q c1, c1 + Q c2, c2 + Q c3]/c3, symbolically and in simulation."""
    sliding, linear = br.blocks.sliding_mode(), br.blocks.pole_placement()
    c1, c2, c3, q, p = symbols("C[1]", "C[2]", "C[3]", "Q", "P")
    gains = dict(
        zip(symbols("K[1]", "K[2]", "K[3]"), [q * c1 / c3, (c1 + q * c2) / c3, (c2 + q * c3) / c3], strict=True)
    )
    for name in ("v[1]", "v[2]"):
        difference = expression(sliding, name).subs(p, 0) - expression(linear, name).subs(gains)
        assert sp.simplify(difference) == 0
    one = br.simulate(br.blocks.closed_loop(), 2.0, parameters={"P": 0.0})
    other = br.simulate(br.blocks.closed_loop(linear), 2.0)
    assert one["x"].values == pytest.approx(other["x"].values, abs=1e-10)
    assert [one.value for one in linear.parameters] == pytest.approx(br.analysis.sliding_gain([500, 10, 1], 5))


@pytest.mark.parametrize("phi", [0.0, 0.05])
def test_saturation(phi: float) -> None:
    block = br.blocks.sliding_mode()
    for surface in (-1.0, -0.05, -0.02, 0.0, 0.02, 0.05, 1.0):
        result = br.simulate(block, 1.0, step_size=1.0, inputs={"Z1[3]": surface}, parameters={"phi": phi})
        saturated = np.sign(surface) if phi == 0 else np.clip(surface / phi, -1, 1)
        # S = c3 e3 for an error in the acceleration alone
        expected = -5 * surface - 2.5 * saturated - 10 * surface
        assert result["v[1]"].values[0] == pytest.approx(expected)


def test_closed_loop_is_a_diagram_of_the_others() -> None:
    loop = br.blocks.closed_loop()
    assert loop.components["plant"] == br.blocks.linearized_robot()
    assert loop.components["controller"] == br.blocks.sliding_mode()
    assert loop.components["reference"] == br.blocks.circle()
    assert loop.components["plant"].components["plant"].states[0].name == "x"  # type: ignore[attr-defined]


def test_block_made_of_another_plant() -> None:
    """A pendulum goes through the same functions as the robot: nothing of the robot is baked in."""
    angle, rate, torque = sp.symbols("angle rate torque", real=True)
    system = br.AffineSystem([angle, rate], [torque], [rate, -9.81 * sp.sin(angle)], [[0], [1]], [angle])
    block = br.linearized_block(br.linearize(system), "pendulum", output_units=["rad"], starts={angle: 0.5})
    assert [one.name for one in block.inputs] == ["v[1]"] and block.inputs[0].unit == "rad/s2"
    assert [one.name for one in block.outputs] == ["angle", "rate", "torque", "Z1[1]", "Z1[2]", "singular"]
    result = br.simulate(block, 1.0, inputs={"v[1]": 2.0})
    assert result["angle"].values == pytest.approx(0.5 + result["time"].values ** 2, abs=1e-9)
    assert not result["singular"].any()


def test_to_control_gives_the_same_system() -> None:
    import control

    loop = br.blocks.closed_loop()
    system = br.to_control(loop)
    assert system.state_labels == ["x", "y", "theta", "eta[1]", "eta[2]", "u[1]"]
    time = np.linspace(0, 1, 101)
    start = [2.5, 0, 0, 0.5, 0, 0]
    response = control.input_output_response(
        system, time, np.zeros((2, 101)), start, solve_ivp_kwargs={"rtol": 1e-10, "atol": 1e-12}
    )
    ours = br.simulate(loop, 1.0, step_size=1e-5, record=["x", "y"])
    assert response.states[0] == pytest.approx(ours["x"].values[::1000], abs=2e-6)
    with pytest.raises(br.BrunovskyError, match="has samples"):
        br.to_control(br.Block("s", samples=[br.blocks.Sample("q", update=sp.S.One)], outputs=[br.blocks.Output("y")]))
