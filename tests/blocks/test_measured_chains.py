"""Chains measured on the true plant instead of computed from the model: every disturbance is matched then."""

import numpy as np
import pytest
import sympy as sp
from outer_loop_cases import B

import brunovsky as br
from brunovsky import analysis
from brunovsky.errors import LinearizationError
from brunovsky.linearization import disturbance_map, measured_chains

C, Q, P, PHI, RATE, D1 = (500.0, 10.0, 1.0), 5.0, 2.5, 0.05, 0.5, 0.2


def test_what_is_left_of_a_constant_disturbance_is_the_boundary_layer() -> None:
    """Computed from the model the residual is that of an unmatched disturbance, measured that of the layer alone.

    Measured, y''' = v + 2 eta2 d1 h_th: S' = -(Q + P/phi) S + that, a rotation at the rate of the circle.
    """
    errors = {}
    for measured in (False, True):
        loop = B.closed_loop(plant=B.linearized_robot(measured=measured))
        start = {"x_start": 2.5, "eta_start[1]": 0.5}
        data = br.simulate(loop, 20.0, parameters=start, inputs={"d[1]": D1}).isel(time=slice(-5000, None))
        errors[measured] = float(np.hypot(data["e1[1]"], data["e2[1]"]).max())
    matched = 2 * RATE * D1 / abs(Q + P / PHI + 1j * RATE)
    layer = matched / abs(np.polyval(C[::-1], 1j * RATE))
    assert errors[True] == pytest.approx(layer, rel=1e-3)
    assert errors[False] == pytest.approx(analysis.unmatched_residual(C, D1, RATE), rel=0.2)
    assert errors[False] > 50 * errors[True]


def test_measured_elements_are_derivatives_of_the_true_outputs() -> None:
    """Central differences of what is simulated, with wrong mass and inertia and disturbances that change."""
    inputs = {"d[1]": lambda t: 0.3 * np.sin(5 * t), "d[2]": lambda t: 0.2 * np.cos(3 * t), "v[1]": 0.4, "v[2]": -0.3}
    data = br.simulate(
        B.linearized_robot(measured=True), 1.0, step_size=1e-4, inputs=inputs, parameters={"rho[1]": 0.8, "rho[2]": 1.3}
    )
    time = data["time"].values
    for i, position in ((1, "x"), (2, "y")):
        velocity = np.gradient(data[position].values, time)
        assert data[f"Z{i}[2]"].values[1:-1] == pytest.approx(velocity[1:-1], abs=1e-6)
        acceleration = np.gradient(data[f"Z{i}[2]"].values, time)
        assert data[f"Z{i}[3]"].values[1:-1] == pytest.approx(acceleration[1:-1], abs=1e-3)


def test_the_next_derivative_is_what_the_disturbance_map_says() -> None:
    linearization, plant = B.robot_linearization(), B.robot_system()
    found = disturbance_map(linearization, plant)
    extended = linearization.extended_system
    true = plant.dynamics.xreplace(dict(linearization.input_map))
    slopes = [*true, *(extended.dynamics[len(true) :])]
    for v, chain, expected in zip(
        _nominal(linearization), measured_chains(linearization, plant), found.measured, strict=True
    ):
        last = chain[-1]
        rate = sum(sp.diff(last, x) * slope for x, slope in zip(extended.states, slopes, strict=True))
        rate += sum(sp.diff(last, d) * found.rates[d] for d in plant.disturbances if last.has(d))
        assert sp.simplify(rate - v - expected) == 0


def _nominal(linearization: br.Linearization) -> list[sp.Expr]:
    """F + G u, which the law makes v."""
    inputs = sp.Matrix(linearization.extended_system.inputs)
    return list(linearization.drift_term + linearization.decoupling_matrix * inputs)


def test_the_default_is_the_model() -> None:
    assert B.linearized_robot() == B.linearized_robot(measured=False)
    assert not B.linearized_robot().feedthrough["Z1[3]"]
    measured = B.linearized_robot(measured=True)
    assert measured.name == "linearized_robot_measured" and measured.feedthrough["Z1[3]"] == {"d[1]"}
    assert [one.name for one in measured.inputs] == [one.name for one in B.linearized_robot().inputs]
    assert [one.name for one in measured.parameters] == [one.name for one in B.linearized_robot().parameters]
    assert [one.name for one in measured.outputs] == [one.name for one in B.linearized_robot().outputs]


def test_nominal_plants_are_measured_as_the_model_has_them() -> None:
    linearization = B.robot_linearization()
    undisturbed = [[one.subs(B.symbol("d[1]"), 0) for one in chain] for chain in measured_chains(linearization)]
    for one, other in zip(undisturbed, linearization.chains, strict=True):
        assert sp.simplify(sp.Matrix(one) - sp.Matrix(list(other))).is_zero_matrix


def test_what_cannot_be_measured_is_refused() -> None:
    z, u, d, p = sp.symbols("z:4", real=True), *sp.symbols("u d p", real=True)
    four = br.AffineSystem(z, (u,), [*z[1:], 0], [0, 0, 0, 1], (z[0],), disturbances={d: (0, 1, 0, 0)})
    with pytest.raises(LinearizationError, match="derivative 3 of output 1 contains the rate of d"):
        br.linearized_block(br.linearize(four), measured=True)
    true = br.AffineSystem(z[:3], (u,), [z[1], z[2], 0], [0, p, 1], (z[0],), (p,))
    nominal = br.linearize(true.with_parameters({p: 0}))
    with pytest.raises(LinearizationError, match="derivative 2 of output 1 contains an input of the true plant"):
        br.linearized_block(nominal, plant=true, parameters={p: 0.1}, measured=True)
