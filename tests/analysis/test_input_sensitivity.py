"""Sensitivity of the inputs: 1/eta1 for the robot, the inverse decoupling matrix for any plant, simulated chatter."""

import control
import matplotlib.pyplot as plt
import numpy as np
import pytest
import sympy as sp

import brunovsky as br
from brunovsky import analysis
from brunovsky.errors import ParameterError
from brunovsky.linearization import gallery

ROBOT = br.blocks.robot_linearization()


def test_norms_of_the_robot_are_one_over_eta1_and_one():
    eta1 = next(one for one in ROBOT.extended_system.states if str(one) == "eta_1")
    gain = analysis.input_gain(ROBOT)
    squares = {name: sp.simplify(gain.row(k).dot(gain.row(k))) for k, name in enumerate(map(str, ROBOT.law))}
    assert squares == {"u_2": 1 / eta1**2, "w_1": 1}


@pytest.mark.parametrize("linearization", [ROBOT, *map(br.linearize, [gallery.unicycle(), gallery.manipulator()])])
def test_gain_is_the_inverse_of_the_decoupling_matrix(linearization):
    product = linearization.decoupling_matrix * analysis.input_gain(linearization)
    assert product.applyfunc(sp.simplify) == sp.eye(product.rows)


def test_numbers_at_a_point():
    found = analysis.input_sensitivity(ROBOT, {"eta_1": -0.5, "theta": 0.3})
    assert found.inputs == ("u_2", "w_1") and found.outer_inputs == ("v1", "v2")
    np.testing.assert_allclose(found.norms, [2.0, 1.0], rtol=1e-12)
    assert (found.largest, found.condition) == pytest.approx((2.0, 2.0))
    np.testing.assert_allclose(found.worst_case([1.0, 0.0]), np.abs([np.cos(0.3) / 0.5, np.sin(0.3)]), rtol=1e-12)


@pytest.mark.parametrize("speed", [0.2, 0.7071, 2.0])
def test_worst_case_is_the_chatter_of_u2_in_simulation(speed):
    """On a circle with the sign function u2 jumps by what v does; over a turn the worst heading is met."""
    radius, P, C3 = speed / 0.5, 2.5, 1.0
    parameters = {"phi": 0.0, "P": P, "radius": radius, "x_start": radius + 1e-6, "eta_start[1]": speed}
    parameters |= {"eta_start[2]": 0.5}
    run = br.simulate(br.blocks.closed_loop(), 13.0, parameters=parameters, record=["u[2]", "theta", "eta[1]"])
    tail = run.isel(time=slice(500, None))
    at_45_degrees = analysis.input_sensitivity(ROBOT, {"eta_1": speed, "theta": np.pi / 4})  # half on each axis
    worst = at_45_degrees.worst_case([P / C3, P / C3])[0]
    assert worst == pytest.approx(2**0.5 * P / (C3 * speed), rel=1e-3)
    assert float(abs(tail["u[2]"]).max()) == pytest.approx(worst, rel=0.05)


def test_figure_has_slope_minus_one_for_u2():
    values = np.logspace(-2, 1, 7)
    plot = analysis.input_sensitivity_plot(ROBOT, "eta_1", values, {"theta": 0.3})
    assert isinstance(plot, control.ControlPlot)
    yaw, forward = plot.lines[0, 0]
    np.testing.assert_allclose(yaw.get_ydata(), 1 / values, rtol=1e-9)
    np.testing.assert_allclose(forward.get_ydata(), 1.0, rtol=1e-9)
    axes = plot.axes[0, 0]
    assert axes.get_xscale() == axes.get_yscale() == "log" and "eta_1" in axes.get_xlabel()
    assert len({line.get_linestyle() for line in plot.lines[0, 0]}) == 2
    _, own = plt.subplots()
    assert analysis.input_sensitivity_plot(ROBOT, "eta_1", values, {"theta": 0.3}, ax=own).axes[0, 0] is own
    plt.close("all")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: analysis.input_sensitivity(ROBOT, {"eta_1": 0, "theta": 0}), "singular"),
        (lambda: analysis.input_sensitivity(ROBOT, {"eta_1": 1}), "theta"),
        (lambda: analysis.input_sensitivity(ROBOT, {"eta": 1, "theta": 0}), "eta is not a state"),
        (lambda: analysis.input_sensitivity("robot", {}), "no Linearization"),
        (lambda: analysis.input_sensitivity_plot(ROBOT, "eta_1", [-1, 1], {"theta": 0}), "positive and ascending"),
        (lambda: analysis.input_sensitivity_plot(ROBOT, "eta_1", [1], {"theta": 0}), "at least 2"),
        (lambda: analysis.input_sensitivity(ROBOT, {"eta_1": 1, "theta": 0}).worst_case([1]), "2 numbers"),
        (lambda: analysis.input_sensitivity(ROBOT, {"eta_1": 1, "theta": 0}).worst_case([1, -1]), ">= 0"),
    ],
)
def test_bad_input_is_refused_with_a_remedy(call, message):
    with pytest.raises(ParameterError, match=message):
        call()
