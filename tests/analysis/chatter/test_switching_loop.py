"""The linear part seen from the switching element: against control's own algebra, roots of polynomials, and margins."""

import dataclasses

import control
import numpy as np
import pytest
from scipy.linalg import expm

from brunovsky import analysis
from brunovsky.analysis import SwitchingLoop
from brunovsky.errors import ParameterError

C, Q, P = (500.0, 10.0, 1.0), 5.0, 2.5
W = np.logspace(-1, 3, 40)


def closed_by_control(loop):
    """W by feedback of python-control systems around the chain, not by the formula under test."""
    plant = analysis.chain(loop.order)
    actuator = control.tf([1], [1])
    for lag in loop.lags:
        actuator = actuator * control.tf([1], [lag, 1])
    states = control.ss(plant) * control.ss(actuator)
    inner = control.feedback(states, control.ss([], [], [], [loop.gain]), sign=-1)
    return control.ss([], [], [], [list(loop.surface)]) * inner * (loop.switching_gain / loop.surface[-1])


@pytest.mark.parametrize("lags", [(), (0.01,), (0.01, 0.004)])
@pytest.mark.parametrize("surface", [C, (3.0, -1.0 * -4.0, 1.0, 0.5), (-6.0, -2.0), (2.0,)])
def test_the_linear_part_is_the_closed_loop_of_chain_lags_and_feedback(lags, surface):
    loop = SwitchingLoop(surface, 2.0, P, lags=lags)
    expected = closed_by_control(loop)(1j * W)
    np.testing.assert_allclose(loop.frequency_response(W), expected, rtol=1e-9)
    transfer = loop.linear_part()
    assert isinstance(transfer, control.TransferFunction)
    np.testing.assert_allclose(transfer(1j * W), expected, rtol=1e-9)


@pytest.mark.parametrize("switching", [0.0, 20.0])
def test_the_loop_at_v_is_gain_times_chain_times_actuator_and_one_more_than_it_is_the_characteristic(switching):
    plain = SwitchingLoop(C, Q, P)
    expected = analysis.loop_transfer(analysis.sliding_gain(C, Q + switching * P))(1j * W)
    np.testing.assert_allclose(plain.loop_response(W, switching), expected, rtol=1e-12)
    loop = SwitchingLoop(C, Q, P, lags=(0.01, 0.004), delay=0.003)
    actuator = control.tf([1], np.polymul([0.01, 1], [0.004, 1]))(1j * W) * np.exp(-0.003j * W)
    np.testing.assert_allclose(loop.loop_response(W, switching), expected * actuator, rtol=1e-12)
    held = SwitchingLoop(C, Q, P, lags=(0.01,), delay=0.003, sampling=0.005)
    closed = held.characteristic(W, switching) / ((1j * W) ** 3 * (1 + 0.01j * W))
    np.testing.assert_allclose(held.loop_response(W, switching), closed - 1.0, rtol=1e-6, atol=1e-9)


def test_without_an_actuator_the_linear_part_is_that_of_the_reaching_law():
    np.testing.assert_allclose(SwitchingLoop(C, Q, P).frequency_response(W), P / (1j * W + Q), rtol=1e-9)


def test_the_delay_is_exact_and_its_pade_approximation_near():
    loop = SwitchingLoop(C, Q, P, lags=[0.004], delay=0.003)
    s = 1j * W
    late = np.exp(-0.003 * s) / (1 + 0.004 * s)
    k = np.polyval(loop.gain[::-1], s)
    np.testing.assert_allclose(loop.frequency_response(W), P * late * np.polyval(C[::-1], s) / (s**3 + late * k))
    low = W[W < 300]
    np.testing.assert_allclose(loop.linear_part(5)(1j * low), loop.frequency_response(low), rtol=1e-6)


def test_the_hold_is_the_mean_over_a_period():
    h = 0.004
    held = SwitchingLoop((1.0,), 0.0, 1.0, sampling=h).frequency_response(W)
    np.testing.assert_allclose(held, (1 - np.exp(-1j * W * h)) / (1j * W * h) / (1j * W), rtol=1e-9)


@pytest.mark.parametrize(
    "lags", [(), (0.015,), (0.019,), (0.0191,), (0.03,), (0.009, 0.009), (0.0095, 0.0095), (0.05,) * 3]
)
@pytest.mark.parametrize("switching", [0.0, 0.5, 20.0])
def test_unstable_poles_are_the_roots_in_the_right_half_plane(lags, switching):
    loop = SwitchingLoop(C, Q, P, lags=lags)
    denominator = np.r_[1.0, np.zeros(3)]
    for lag in lags:
        denominator = np.polymul(denominator, [lag, 1.0])
    feedback = loop.gain + switching * P * np.asarray(C)
    roots = np.roots(np.polyadd(denominator, feedback[::-1]))
    assert loop.unstable_poles(switching) == np.count_nonzero(roots.real > 0)


def test_unstable_poles_of_a_delay_lie_beyond_its_margin():
    delay = analysis.margins(analysis.sliding_gain(C, Q)).delay
    assert SwitchingLoop(C, Q, P, delay=delay * 0.999).unstable_poles() == 0
    assert SwitchingLoop(C, Q, P, delay=delay * 1.001).unstable_poles() == 2
    assert SwitchingLoop(C, 0.0, P, delay=0.001).unstable_poles() == 0  # the root at s = 0 is not counted


def test_the_actuated_chain_holds_the_lags_in_series():
    loop = SwitchingLoop((2.0, 1.0), 1.0, 1.0, lags=[0.1, 0.3, 0.7])
    A, B = loop.actuated_chain()
    row = np.array([2.0, 1.0, 0, 0, 0])
    for w in (0.1, 1.0, 10.0):
        s = 1j * w
        expected = (2 + s) / s**2 / ((1 + 0.1 * s) * (1 + 0.3 * s) * (1 + 0.7 * s))
        assert row @ np.linalg.solve(s * np.eye(5) - A, B) == pytest.approx(expected, rel=1e-12)
    assert np.all(np.isfinite(expm(A)))


def test_a_loop_is_frozen_hashable_and_drops_lags_of_zero():
    loop = SwitchingLoop(np.array(C), 5, 2.5, lags=[0, 0.01])
    assert loop == SwitchingLoop(C, Q, P, lags=(0.01,))
    assert len({loop, SwitchingLoop(C, Q, P, lags=(0.01,))}) == 1
    assert loop.dead_time == 0.01
    with pytest.raises(dataclasses.FrozenInstanceError):
        loop.delay = 1.0


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"lags": [-0.01]}, "lag = -0.01 is out of range"),
        ({"lags": ["x"]}, "lags"),
        ({"delay": -1}, "delay >= 0"),
        ({"delay": np.nan}, "finite"),
        ({"sampling": 0}, "None for a continuous law"),
        ({"sampling": -0.1}, "sampling >= 0"),
        ({"surface": [1, 1, 0]}, "c_n != 0"),
        ({"surface": [1, -1, 1]}, "surface_from_poles"),
        ({"surface": [0, 1, 1]}, "surface_from_poles"),
        ({"reaching_rate": -1}, "Q >= 0"),
        ({"switching_gain": -1}, "P >= 0"),
        ({"boundary_layer": 0.1, "hysteresis": 0.1}, "either"),
    ],
)
def test_bad_input_is_refused_with_a_remedy(changes, message):
    with pytest.raises(ParameterError, match=message):
        SwitchingLoop(**{"surface": C, "reaching_rate": Q, "switching_gain": P, **changes})


def test_no_rational_linear_part_is_made_up():
    with pytest.raises(ParameterError, match="pade_order"):
        SwitchingLoop(C, Q, P, delay=0.01).linear_part()
    with pytest.raises(ParameterError, match="frequency_response"):
        SwitchingLoop(C, Q, P, sampling=0.01).linear_part()
