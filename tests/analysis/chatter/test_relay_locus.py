"""Exact relay cycles: textbook answers, the half-period map in state space, and integration with events."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from brunovsky.analysis import SwitchingLoop, cycle_state, predicted_cycles, relay_cycles, relay_locus, simulated_cycle
from brunovsky.errors import ParameterError

C, Q, P = (500.0, 10.0, 1.0), 5.0, 2.5
LOOPS = [
    SwitchingLoop(C, Q, P, lags=[0.005, 0.005]),
    SwitchingLoop(C, Q, P, lags=[0.0095, 0.0095]),
    SwitchingLoop(C, Q, P, lags=[0.014, 0.014]),
    SwitchingLoop(C, Q, P, lags=[0.025]),
    SwitchingLoop(C, Q, P, lags=[0.002, 0.02, 0.003]),
    SwitchingLoop(C, Q, P, lags=[0.005, 0.005], hysteresis=0.003),
    SwitchingLoop((6.0, 5.0, 1.0), 2.0, P, lags=[0.05, 0.05]),
    SwitchingLoop((1.0,), 0.0, P, lags=[0.02, 0.02]),
    SwitchingLoop((2.0, 1.0), 0.0, P, lags=[0.02, 0.03]),
]


def closed(loop):
    A, B = loop.actuated_chain()
    pad = np.zeros(len(loop.lags))
    return A - np.outer(B, np.r_[loop.gain, pad]), -loop.switching_gain / loop.surface[-1] * B, np.r_[loop.surface, pad]


@pytest.mark.parametrize("loop", LOOPS)
def test_cycles_are_fixed_points_of_the_half_period_map_with_its_stability(loop):
    A, b, row = closed(loop)
    cycles = relay_cycles(loop)
    assert cycles
    for cycle in cycles:
        half = np.pi / cycle.frequency
        start = cycle_state(loop, cycle.frequency)
        assert row @ start == pytest.approx(loop.hysteresis, abs=1e-7 * cycle.amplitude)
        augmented = np.zeros((b.size + 1,) * 2)
        augmented[:-1, :-1], augmented[:-1, -1] = A, b
        times = np.linspace(0, half, 4001)
        step, z, S = expm(augmented * times[1]), np.r_[start, 1.0], []
        for _ in times:
            S.append(row @ z[:-1])
            z = step @ z
        S = np.array(S)
        assert S[-1] == pytest.approx(-S[0], abs=1e-7 * cycle.amplitude)
        assert np.all(S[1:-1] > -loop.hysteresis)
        assert cycle.amplitude == pytest.approx(np.max(np.abs(S)), rel=1e-5)
        fundamental = 2 / half * abs(np.trapezoid(S * np.exp(-1j * cycle.frequency * times), times))
        assert cycle.fundamental == pytest.approx(fundamental, rel=1e-5)
        velocity = -(A @ start - b)  # of the mirrored state, as the relay switches down
        jacobian = (np.eye(b.size) - np.outer(velocity, row) / (row @ velocity)) @ expm(A * half)
        assert cycle.stable == (np.max(np.abs(np.linalg.eigvals(jacobian))) < 1)


def test_a_cycle_against_an_adaptive_integration_with_events():
    loop = LOOPS[0]
    A, b, row = closed(loop)
    (cycle,) = relay_cycles(loop)

    def crossing(t, x):
        return row @ x

    crossing.terminal = True
    x, f, spans = 0.5 * cycle_state(loop, cycle.frequency) + 1e-6, 1.0, []
    top = 0.0
    for _ in range(60):
        run = solve_ivp(lambda t, x, f=f: A @ x + b * f, (0, 1e-6), x, rtol=1e-10, atol=1e-14)
        first, x = run.t[-1], run.y[:, -1]
        run = solve_ivp(
            lambda t, x, f=f: A @ x + b * f, (0, 1), x, events=crossing, rtol=1e-10, atol=1e-14, max_step=1e-3
        )
        spans.append(first + run.t[-1])
        top = np.max(np.abs(row @ run.y))
        x, f = run.y[:, -1], -f
    assert np.pi / spans[-1] == pytest.approx(cycle.frequency, rel=1e-6)
    assert top == pytest.approx(cycle.amplitude, rel=1e-3)


@pytest.mark.parametrize("delay", [1e-3, 0.05])
def test_integrator_with_a_delay_is_a_triangle(delay):
    (cycle,) = (one for one in relay_cycles(SwitchingLoop((1.0,), 0.0, P, delay=delay)) if one.stable)
    assert cycle.frequency == pytest.approx(np.pi / 2 / delay, rel=1e-7)
    assert cycle.amplitude == pytest.approx(P * delay, rel=1e-4)
    assert cycle.fundamental == pytest.approx(8 / np.pi**2 * P * delay, rel=1e-7)


def test_integrator_with_hysteresis_is_a_triangle():
    (cycle,) = relay_cycles(SwitchingLoop((1.0,), 0.0, P, hysteresis=0.01))
    assert cycle.frequency == pytest.approx(np.pi / 2 * P / 0.01, rel=1e-7)
    assert cycle.amplitude == pytest.approx(0.01, rel=1e-4)
    assert cycle.stable


@pytest.mark.parametrize("lag", [0.0, 0.004])
def test_a_delay_is_the_limit_of_many_small_lags(lag):
    own = [lag] if lag else []
    late = SwitchingLoop(C, Q, P, lags=own, delay=0.004)
    (exact,) = (one for one in relay_cycles(late) if one.stable)
    errors = []
    for count in (20, 40):
        (near,) = (
            one for one in relay_cycles(SwitchingLoop(C, Q, P, lags=own + [0.004 / count] * count)) if one.stable
        )
        errors.append(abs(near.frequency / exact.frequency - 1))
    assert errors[1] < 0.6 * errors[0] < 0.03  # halves as the number of lags doubles


def test_locus_is_the_sum_over_the_odd_harmonics():
    loop = SwitchingLoop(C, Q, P, lags=[0.005, 0.005])
    w = np.array([20.0, 90.0, 300.0])
    terms = [(loop.frequency_response(k * w), k) for k in range(1, 2000, 2)]
    expected = sum(one.real + 1j * one.imag / k for one, k in terms)
    np.testing.assert_allclose(relay_locus(loop, w), expected, rtol=1e-5)
    np.testing.assert_allclose(relay_locus(loop, w, 1), loop.frequency_response(w), rtol=1e-12)


def test_closed_form_of_the_slow_harmonics_changes_nothing():
    loop = SwitchingLoop(C, Q, P, delay=0.007)
    w = np.array([50.0, 210.0])
    k = np.arange(1, 400001, 2)
    brute = [(loop.frequency_response(k * one).imag / k).sum() for one in w]
    np.testing.assert_allclose(relay_locus(loop, w).imag, brute, rtol=1e-4)


def test_a_relay_behind_one_small_lag_has_no_cycle():
    assert relay_cycles(SwitchingLoop(C, Q, P, lags=[0.0189])) == ()


def test_the_cycles_of_the_paper_merge_a_little_before_the_describing_function_says():
    between = SwitchingLoop(C, Q, P, lags=[0.0146, 0.0146])
    assert len(predicted_cycles(between)) == 2
    assert relay_cycles(between) == ()
    assert simulated_cycle(between).outcome == "diverges"
    assert len(relay_cycles(SwitchingLoop(C, Q, P, lags=[0.0144, 0.0144]))) == 2


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"boundary_layer": 0.1, "lags": [0.01]}, "predicted_cycles"),
        ({}, "a lag or a delay"),
        ({"switching_gain": 0.0, "lags": [0.01]}, "P > 0"),
    ],
)
def test_what_is_no_late_relay_is_refused(changes, message):
    loop = SwitchingLoop(**{"surface": C, "reaching_rate": Q, "switching_gain": P, **changes})
    with pytest.raises(ParameterError, match=message):
        relay_cycles(loop)
    with pytest.raises(ParameterError, match=message):
        relay_locus(loop, [1.0])


def test_bad_frequencies_and_harmonics_are_refused():
    loop = SwitchingLoop(C, Q, P, lags=[0.01])
    with pytest.raises(ParameterError, match="above 0"):
        relay_locus(loop, [1.0, 0.0])
    with pytest.raises(ParameterError, match="harmonics"):
        relay_locus(loop, [1.0], 0)
    with pytest.raises(ParameterError, match="sampled"):
        relay_locus(SwitchingLoop(C, Q, P, sampling=0.01), [1.0])
