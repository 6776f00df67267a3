"""The robot's chatter with lags at its actuators, against the chain's prediction and by independent routes."""

from functools import cache

import numpy as np
import pytest

import brunovsky as br
from brunovsky import analysis
from brunovsky.errors import ParameterError, SimulationError

B = br.blocks
C, Q, P = (500.0, 10.0, 1.0), 5.0, 2.5
W = np.geomspace(10, 2000, 15)


def two_lags(lag):
    return analysis.SwitchingLoop(C, Q, P, lags=[lag, lag])


@cache
def row(lag, degrees):
    return analysis.robot_chatter_table([two_lags(lag)], [np.radians(degrees)])[0]


@pytest.mark.parametrize("number", [1, 2])
def test_across_the_heading_a_lag_at_the_actuator_is_one_at_v(number):
    loop = analysis.SwitchingLoop(C, Q, P, lags=[0.004] * number)
    found = analysis.actuated_response(loop, W)
    np.testing.assert_allclose(found[:, 0, 0], loop.frequency_response(W), rtol=1e-5)
    np.testing.assert_allclose(found[:, [0, 1], [1, 0]], 0, atol=1e-6 * abs(found).max())


@pytest.mark.parametrize("number", [1, 2])
def test_along_the_heading_the_lag_is_behind_the_integrator_of_the_compensator(number):
    """S = (c3 + (c2/s + c1/s^2) G) u1 with u1 = v/s, typed by hand: it falls as P/s whatever the lag."""
    lag, s = 0.004, 1j * W
    found = analysis.actuated_response(analysis.SwitchingLoop(C, Q, P, lags=[lag] * number), W)[:, 1, 1]
    G = 1 / (lag * s + 1) ** number
    surface = C[2] * s**2 + (C[1] * s + C[0]) * G
    linear = C[2] * s**3 + C[1] * s**2 + C[0] * G * s + Q * surface
    np.testing.assert_allclose(found, P * surface / linear, rtol=1e-5)
    assert abs(found[-1]) == pytest.approx(P / W[-1], rel=0.02)


def test_another_heading_turns_the_axes():
    loop, theta = two_lags(0.005), 0.7
    turn = np.array([[np.cos(theta), -np.sin(theta)], [np.sin(theta), np.cos(theta)]])
    straight, turned = analysis.actuated_response(loop, W), analysis.actuated_response(loop, W, theta)
    np.testing.assert_allclose(turned, turn @ straight @ turn.T, rtol=1e-4, atol=1e-7)


@pytest.mark.parametrize("lag", [0.003, 0.008])
@pytest.mark.parametrize(("degrees", "axis"), [(0, 1), (90, 2)])
def test_along_an_axis_the_chain_is_right_and_the_other_axis_slides(lag, degrees, axis):
    found = row(lag, degrees)
    assert found.axis == axis
    assert abs(found.frequency_error) < 0.004
    assert abs(found.amplitude_error) < 0.01
    assert found.measured[2 - axis].amplitude < 0.01 * found.measured[axis - 1].amplitude
    assert found.measured[2 - axis].samples < 5  # chatters with the step


@pytest.mark.parametrize("degrees", [15, 30, 60])
def test_in_between_it_is_faster_as_the_coupled_prediction_says(degrees):
    found = row(0.005, degrees)
    seen = found.measured[found.axis - 1]
    assert found.at_u.axis == found.axis
    assert found.at_u.other < 1
    assert found.at_u.frequency == pytest.approx(seen.frequency, rel=0.03)
    assert found.at_u.amplitude == pytest.approx(seen.amplitude, rel=0.06)
    assert -0.2 < found.frequency_error < -0.03


def test_near_the_diagonal_the_other_axis_no_longer_slides():
    found = row(0.005, 42)
    assert found.at_u.other > 1
    assert min(one.amplitude for one in found.measured) > 0.5 * max(one.amplitude for one in found.measured)


def test_on_the_diagonal_both_relays_switch_together_and_the_chain_is_right_again():
    found = row(0.005, 45)
    assert abs(found.frequency_error) < 0.01
    assert found.measured[0].amplitude == pytest.approx(found.measured[1].amplitude, rel=0.01)


def test_the_step_converges():
    loop = two_lags(0.005)
    found = [abs(analysis.robot_chatter_table([loop], step_size=one)[0].frequency_error) for one in (1e-4, 2.5e-5)]
    assert found[1] < 0.4 * found[0]


def test_one_lag_at_each_actuator_slides_as_the_chain_says():
    found = analysis.robot_chatter_table([analysis.SwitchingLoop(C, Q, P, lags=[0.005])], [0.0, 0.5])
    for one in found:
        assert one.at_v is None
        assert one.at_u is None
        assert max(part.amplitude for part in one.measured) < 1e-4
        assert one.frequency_error is None


def test_on_the_paper_s_circle_the_chatter_is_that_of_the_line_of_the_same_heading():
    lag, rate, radius = 0.005, 0.5, 2**0.5
    data = br.simulate(
        B.closed_loop(plant=B.robot_with_lags(number=2)), 7.5, step_size=lag / 250,
        parameters={"phi": 0, "lag[1]": lag, "lag[2]": lag, "x_start": radius, "eta_start[1]": radius * rate,
                    "eta_start[2]": rate},
        record=["S[1]", "S[2]", "theta"],
    )  # fmt: skip
    for degrees in (180, 195, 210):
        middle = float(data["time"][int(np.argmin(abs(data["theta"].values - np.radians(degrees))))])
        found = analysis.measured_chatter(data, "S[1]", middle - 0.12, middle + 0.12)
        line = row(lag, degrees - 180).measured[0]
        assert found.frequency == pytest.approx(line.frequency, rel=0.01)
        assert found.amplitude == pytest.approx(line.amplitude, rel=0.02)


@pytest.mark.parametrize(
    "loop",
    [
        analysis.SwitchingLoop(C, Q, P),
        analysis.SwitchingLoop(C, Q, P, lags=[0.001, 0.002]),
        analysis.SwitchingLoop(C, Q, P, lags=[0.001], delay=0.001),
        analysis.SwitchingLoop(C, Q, P, lags=[0.001], sampling=0.001),
        analysis.SwitchingLoop((5.0, 1.0), Q, P, lags=[0.001]),
        analysis.SwitchingLoop(C, Q, P, lags=[0.001], boundary_layer=0.1),
        analysis.SwitchingLoop(C, Q, 0.0, lags=[0.001]),
    ],
)
def test_other_loops_are_refused(loop):
    for call in (analysis.predicted_robot_chatter, lambda one: analysis.robot_chatter_table([one])):
        with pytest.raises(ParameterError, match="pass"):
            call(loop)


def test_bad_numbers_are_refused():
    with pytest.raises(ParameterError, match="heading"):
        analysis.predicted_robot_chatter(two_lags(0.005), np.nan)
    with pytest.raises(ParameterError, match="frequencies above 0"):
        analysis.actuated_response(two_lags(0.005), [0.0])
    with pytest.raises(ParameterError, match="step_size"):
        analysis.robot_chatter_table([two_lags(0.005)], step_size=0.0)
    with pytest.raises(ParameterError, match="longer step_size"):
        analysis.robot_chatter_table([two_lags(1e-6)])


def test_beyond_the_limit_along_the_heading_it_grows():
    """Two lags of 12 ms: the chain at v has a stable cycle, the robot does not, since its motion along grows."""
    try:
        (found,) = analysis.robot_chatter_table([two_lags(0.012)])
    except SimulationError:
        return
    assert found.at_v.stable
    assert found.frequency_error is None
    assert max(one.largest for one in found.measured if one) > 10 * found.at_v.amplitude
