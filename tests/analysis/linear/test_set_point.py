"""Sensitivities, set-point response and gang of four of one chain."""

import control
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import brunovsky as br
from brunovsky import analysis
from brunovsky.errors import ParameterError

PAPER = np.array([2500.0, 550.0, 15.0])
POINTS = 1j * np.logspace(-1, 3, 60)


@pytest.mark.parametrize("gain", [PAPER, [2.0], [4.0, 3.0], analysis.place([-1, -3, -4, -6])])
def test_sensitivities_are_those_of_the_loop(gain):
    L = analysis.loop_transfer(gain)(POINTS)
    np.testing.assert_allclose(analysis.sensitivity(gain)(POINTS), 1 / (1 + L), rtol=1e-9)
    np.testing.assert_allclose(analysis.complementary_sensitivity(gain)(POINTS), L / (1 + L), rtol=1e-9)


def test_peak_of_the_sensitivity_is_ms():
    peak = control.system_norm(analysis.sensitivity(PAPER), "inf", print_warning=False)
    assert peak == pytest.approx(analysis.margins(PAPER).max_sensitivity, rel=1e-5)


def test_gang_of_four_is_that_of_the_loop():
    w = POINTS.imag
    response = analysis.gang_of_four(PAPER, omega=w)
    P, C = 1 / POINTS**3, np.polyval(PAPER[::-1], POINTS)
    four = {(0, 0): P * C, (0, 1): P, (1, 0): C, (1, 1): np.ones_like(P)}
    for (row, column), top in four.items():
        np.testing.assert_allclose(response.frdata[row, column], top / (1 + P * C), rtol=1e-9)
    assert isinstance(response, control.FrequencyResponseData)
    assert response.plot().axes.shape == (2, 2)


def test_bandwidth_against_the_frequency_response():
    w = analysis.bandwidth(PAPER)
    assert abs(analysis.set_point_transfer(PAPER)(1j * w)) == pytest.approx(10 ** (-3 / 20), rel=1e-6)
    lower = np.linspace(1e-3, 0.999 * w, 500)
    assert np.all(np.abs(analysis.set_point_transfer(PAPER)(1j * lower)) > 10 ** (-3 / 20))


def test_step_information_of_a_second_order_chain_in_closed_form():
    zeta, w = 0.5, 4.0
    found = analysis.step_information([w**2, 2 * zeta * w])
    damped = w * np.sqrt(1 - zeta**2)
    assert found["Overshoot"] == pytest.approx(100 * np.exp(-np.pi * zeta / np.sqrt(1 - zeta**2)), rel=1e-5)
    assert found["PeakTime"] == pytest.approx(np.pi / damped, abs=5e-4)
    assert found["SteadyStateValue"] == pytest.approx(1.0)


def test_step_information_is_that_of_the_simulated_regulation():
    """The shipped loop with a set point as reference: radius 0, started at rest of the chain but for the position."""
    loop = br.blocks.closed_loop(br.blocks.pole_placement())
    # the robot can't start at rest: it moves along y at 1 m/s, and x is the axis that is regulated from a step
    start = {"x_start": -1.0, "y_start": 0.0, "eta_start[1]": 1.0, "radius": 0.0, "eta_min": 0.0}
    run = br.simulate(loop, 0.3, parameters=start, step_size=1e-4, record=["x"])
    time = run["time"].values
    _, step = control.step_response(analysis.set_point_transfer(PAPER), time)
    np.testing.assert_allclose(run["x"].values, step - 1.0, atol=1e-6)

    def chain(t, z):
        return [z[1], z[2], -PAPER[0] * (z[0] - 1.0) - PAPER[1] * z[1] - PAPER[2] * z[2]]

    dense = solve_ivp(chain, (0, 3), [0, 0, 0], rtol=1e-10, atol=1e-12, max_step=1e-3)
    z = dense.y[0]
    found = analysis.step_information(PAPER)
    rise = dense.t[np.argmax(z > 0.9)] - dense.t[np.argmax(z > 0.1)]
    assert found["RiseTime"] == pytest.approx(rise, abs=2e-3)
    assert found["SettlingTime"] == pytest.approx(dense.t[np.flatnonzero(np.abs(z - 1) > 0.02)[-1]], abs=2e-3)
    assert found["Overshoot"] == pytest.approx(max(0.0, 100 * (np.max(z) - 1)), abs=1e-3)


@pytest.mark.parametrize("call", [analysis.bandwidth, analysis.step_information, analysis.gang_of_four])
def test_an_unstable_loop_is_refused(call):
    with pytest.raises(ParameterError, match="stabilising gain"):
        call([1.0, 1.0, 0.5])


@pytest.mark.parametrize(
    "call", [analysis.sensitivity, analysis.complementary_sensitivity, analysis.set_point_transfer]
)
@pytest.mark.parametrize("gain", [[0, 0, 0], [1, np.nan], "K"])
def test_bad_gains_are_refused(call, gain):
    with pytest.raises(ParameterError, match="K"):
        call(gain)
