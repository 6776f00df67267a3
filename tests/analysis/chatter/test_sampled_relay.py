"""Sampled switching: the chatter band of the explicit scheme, the exact cycles in whole samples, and their limits."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from brunovsky.analysis import SwitchingLoop, relay_cycles, sampled_chatter_band, sampled_cycles, simulated_cycle
from brunovsky.analysis.chatter.sampled_relay import sampled_model
from brunovsky.errors import ParameterError

C, Q, P = (500.0, 10.0, 1.0), 5.0, 2.5


@given(st.floats(0.05, 1.95), st.floats(1e-3, 1e3), st.floats(1e-4, 1.0), st.floats(-50, 50))
def test_band_of_the_explicit_scheme(rate, switching, step, start):
    """`rate` is h Q; the explicit scheme is run until it is steady, from anywhere."""
    S, orbit = start * step * switching, []
    for _ in range(1000):
        S = S - rate * S - step * switching * (1.0 if S > 0 else -1.0)
        orbit.append(S)
    measured = np.ptp(orbit[-20:]) / 2
    assert measured == pytest.approx(sampled_chatter_band(rate / step, switching, step), rel=1e-9)


def test_band_without_reaching_rate_may_be_off_centre():
    S = np.array([0.3])
    for _ in range(100):
        S = np.append(S, S[-1] - np.sign(S[-1]))
    assert np.ptp(S[-20:]) / 2 == sampled_chatter_band(0.0, 1.0, 1.0) == 0.5


@pytest.mark.parametrize("h", [1e-4, 1e-3, 0.1, 0.3])
def test_one_integrator_under_a_held_law_has_that_band(h):
    loop = SwitchingLoop((2.0,), Q, P, sampling=h)
    (cycle,) = sampled_cycles(loop)
    band = sampled_chatter_band(Q, P, h)
    assert cycle.amplitude == pytest.approx(band, rel=1e-9)
    assert cycle.frequency == pytest.approx(np.pi / h, rel=1e-12)
    assert cycle.stable
    seen = simulated_cycle(loop)
    assert seen.outcome == "cycle"
    assert seen.cycle.amplitude == pytest.approx(band, rel=5e-4)  # S shrinks by h Q a sample only


@pytest.mark.parametrize("h", [1e-3, 1e-4, 1e-5])
def test_the_chain_of_the_paper_tends_to_that_band_with_the_period(h):
    loop = SwitchingLoop(C, Q, P, sampling=h)
    (cycle,) = sampled_cycles(loop)
    band = sampled_chatter_band(Q, P, h)
    # of the explicit scheme what the other feedback does within a period is missing, of the order of h
    assert cycle.amplitude == pytest.approx(band, rel=10 * h)
    seen = simulated_cycle(loop)
    assert seen.cycle.amplitude == pytest.approx(cycle.amplitude, rel=1e-3)


@pytest.mark.parametrize("delay", [0.0, 0.0012, 0.003, 0.0035])
@pytest.mark.parametrize("lags", [(), (0.004, 0.002)])
def test_the_sampled_model_is_the_held_loop(delay, lags):
    """A made-up sequence f through the model, and through an integration of the chain with v held and late."""
    h, steps = 0.0015, 12
    loop = SwitchingLoop(C, Q, P, lags=lags, delay=delay, sampling=h)
    model = sampled_model(loop, 3)
    A, B = loop.actuated_chain()
    f = np.where(np.random.default_rng(1).random(steps) < 0.5, -1.0, 1.0)
    X = np.zeros(model.B.size)
    x = np.zeros(B.size)
    x[:3] = X[:3] = 1e-3, -2e-3, 0.05
    v = []
    for k in range(steps):
        S = np.dot(C, x[:3])
        assert float(model.C @ X) == pytest.approx(S, abs=1e-9)
        v.append(-loop.gain @ x[:3] - P * f[k])
        arrivals = (j * h + delay for j in range(-9, k + 1))
        edges = [k * h, *(t for t in arrivals if k * h < t < (k + 1) * h), (k + 1) * h]
        for left, right in pairwise(edges):
            j = int(np.floor((0.5 * (left + right) - delay) / h))
            held = v[j] if j >= 0 else 0.0
            run = solve_ivp(lambda t, x, held=held: A @ x + B * held, (left, right), x, rtol=1e-11, atol=1e-14)
            x = run.y[:, -1]
        ahead = model.between @ X + model.between_f * f[k]
        assert ahead[-1] == pytest.approx(np.dot(C, x[:3]), abs=1e-8)
        X = model.A @ X + model.B * f[k]


@pytest.mark.parametrize("delay", [0.0, 0.003])
def test_cycles_in_whole_samples_side_by_side_and_what_is_simulated_is_one_of_them(delay):
    h = 0.002
    loop = SwitchingLoop(C, Q, P, lags=[0.005, 0.005], delay=delay, sampling=h)
    cycles = relay_cycles(loop)
    assert cycles == sampled_cycles(loop)
    assert len(cycles) > 1
    halves = np.pi / np.array([one.frequency for one in cycles]) / h
    np.testing.assert_allclose(halves, np.round(halves), rtol=1e-12)
    seen = simulated_cycle(loop)
    assert seen.outcome == "cycle"
    nearest = min(cycles, key=lambda one: abs(one.frequency - seen.cycle.frequency))
    assert seen.cycle.frequency == pytest.approx(nearest.frequency, rel=1e-3)
    assert seen.cycle.amplitude == pytest.approx(nearest.amplitude, rel=5e-3)


def test_fast_sampling_tends_to_the_continuous_cycle():
    (continuous,) = relay_cycles(SwitchingLoop(C, Q, P, lags=[0.005, 0.005]))
    loop = SwitchingLoop(C, Q, P, lags=[0.005, 0.005], sampling=1e-4)
    assert all(one.frequency == pytest.approx(continuous.frequency, rel=0.03) for one in sampled_cycles(loop))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sampled_chatter_band(5, 1, 0), "step > 0"),
        (lambda: sampled_chatter_band(5, 1, 0.4), "step < 0.4"),
        (lambda: sampled_chatter_band(-1, 1, 0.1), "Q >= 0"),
        (lambda: sampled_chatter_band(1, -1, 0.1), "P >= 0"),
        (lambda: sampled_cycles(SwitchingLoop(C, Q, P, lags=[0.01])), "sampling period"),
        (lambda: sampled_cycles(SwitchingLoop(C, Q, P, boundary_layer=1, sampling=0.01)), "phi = 0"),
        (lambda: sampled_cycles(SwitchingLoop(C, Q, 0, sampling=0.01)), "P > 0"),
    ],
)
def test_bad_input_is_refused_with_a_remedy(call, message):
    with pytest.raises(ParameterError, match=message):
        call()
