"""Margins: the numbers known for the paper's gains, and stability just inside and just outside each margin."""

import dataclasses

import control
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize_scalar

from brunovsky import analysis
from brunovsky.errors import ParameterError

PAPER = np.array([2500.0, 550.0, 15.0])
LAYER = np.array([27500.0, 1050.0, 65.0])
TWO_SIDED = np.array([1.15, 1.32, 2.15, 2.3, 1.0])  # five integrators whose gain may neither fall nor rise by much
THREE_CROSSOVERS = np.array([3890.0, 594.0, 360.0, 50.2, 7.59])  # abs(L) < 1 in between, at a phase crossover
INSIDE, OUTSIDE = 1 - 1e-3, 1 + 1e-3


def is_stable(gain, *, factor=1.0, lag=0.0, lags=1, delay=0.0):
    """Stability from the roots of the characteristic polynomial; a delay as its tenth-order Pade approximation."""
    numerator, denominator = factor * np.asarray(gain)[::-1], np.r_[1.0, np.zeros(len(gain))]
    for _ in range(lags):
        denominator = np.polymul(denominator, [lag, 1.0] if lag else [1.0])
    if delay:
        pade_numerator, pade_denominator = control.pade(delay, 10)
        numerator, denominator = np.polymul(numerator, pade_numerator), np.polymul(denominator, pade_denominator)
    return np.max(np.roots(np.polyadd(numerator, denominator)).real) < 0


def test_loop_transfer_is_the_chain_behind_the_gain():
    loop = analysis.loop_transfer(PAPER)
    assert isinstance(loop, control.TransferFunction)
    plant = analysis.chain(3)
    s = 1j * np.logspace(-1, 3, 50)
    state_space = np.array([(PAPER @ np.linalg.solve(p * np.eye(3) - plant.A, plant.B))[0] for p in s])
    np.testing.assert_allclose(loop(s), state_space, rtol=1e-12)
    np.testing.assert_allclose(loop(s), np.polyval([15, 550, 2500], s) / s**3, rtol=1e-12)


def test_margins_of_the_paper():
    m = analysis.margins(PAPER)
    assert m.gain_lower == pytest.approx(0.303, abs=5e-4)
    assert m.gain_lower == pytest.approx(PAPER[0] / (PAPER[1] * PAPER[2]), rel=1e-9)  # Routh: g k2 k3 > k1
    assert m.gain_upper == np.inf
    assert m.delay == pytest.approx(18.4e-3, abs=1e-4)
    assert m.lag == pytest.approx(19.0e-3, abs=5e-5)
    assert m.lag == pytest.approx((550 * 15 - 2500) / 550**2, rel=1e-9)  # Routh
    assert m.two_lags == pytest.approx(9.2e-3, abs=5e-5)
    assert np.rad2deg(m.phase) == pytest.approx(26.18, abs=5e-3)
    assert m.gain_crossover == pytest.approx(24.756, abs=5e-4)
    assert m.max_sensitivity == pytest.approx(2.244, abs=5e-4)
    with pytest.raises(dataclasses.FrozenInstanceError):
        m.delay = 1.0


def test_phase_and_modulus_margins_from_the_frequency_response():
    m = analysis.margins(PAPER)
    at_crossover = np.polyval(PAPER[::-1], 1j * m.gain_crossover) / (1j * m.gain_crossover) ** 3
    assert abs(at_crossover) == pytest.approx(1, rel=1e-9)
    assert np.angle(-at_crossover) == pytest.approx(m.phase, rel=1e-9)
    nearest = minimize_scalar(
        lambda w: abs(1 + np.polyval(PAPER[::-1], 1j * w) / (1j * w) ** 3), bounds=(5, 100), options={"xatol": 1e-9}
    )
    assert m.modulus == pytest.approx(nearest.fun, rel=1e-9)
    assert m.modulus_frequency == pytest.approx(nearest.x, rel=1e-5)
    assert m.modulus * m.max_sensitivity == pytest.approx(1, rel=1e-15)


@pytest.mark.parametrize(
    "gain",
    [PAPER, LAYER, analysis.place([-2, -2, -2]), analysis.place([-1, -3, -4, -6]), TWO_SIDED, THREE_CROSSOVERS],
)
def test_the_loop_is_stable_inside_each_margin_and_not_outside(gain):
    m = analysis.margins(gain)
    assert is_stable(gain, factor=1 - (1 - m.gain_lower) * INSIDE)
    assert not is_stable(gain, factor=1 - (1 - m.gain_lower) * OUTSIDE)
    if np.isinf(m.gain_upper):
        assert is_stable(gain, factor=1e6)
    else:
        near, far = 1 + (m.gain_upper - 1) * INSIDE, 1 + (m.gain_upper - 1) * OUTSIDE
        assert is_stable(gain, factor=near)
        assert not is_stable(gain, factor=far)
    assert is_stable(gain, delay=m.delay * INSIDE)
    assert not is_stable(gain, delay=m.delay * OUTSIDE)
    assert is_stable(gain, lag=m.lag * INSIDE)
    assert not is_stable(gain, lag=m.lag * OUTSIDE)
    assert is_stable(gain, lag=m.two_lags * INSIDE, lags=2)
    assert not is_stable(gain, lag=m.two_lags * OUTSIDE, lags=2)


def test_a_conditionally_stable_loop_with_both_gain_margins():
    m = analysis.margins(TWO_SIDED)
    assert 0.99 < m.gain_lower < 1 < m.gain_upper < 1.03
    assert m.phase < 0  # lead destabilises sooner than lag


def test_a_phase_crossover_between_two_gain_crossovers_is_no_lag_margin():
    _, _, _, phase_crossovers, gain_crossovers, _ = control.stability_margins(
        analysis.loop_transfer(THREE_CROSSOVERS), returnall=True
    )
    assert gain_crossovers.size == 3
    assert np.any((phase_crossovers > gain_crossovers[0]) & (phase_crossovers < gain_crossovers[1]))
    assert analysis.lag_margin(THREE_CROSSOVERS) > 0


def test_the_boundary_layer_changes_the_margins():
    layer, linear = analysis.margins(LAYER), analysis.margins(PAPER)
    assert layer.lag == pytest.approx((1050 * 65 - 27500) / 1050**2, rel=1e-9)
    assert layer.gain_lower == pytest.approx(27500 / (1050 * 65), rel=1e-9)
    assert layer.gain_lower > linear.gain_lower  # less gain reduction tolerated
    assert layer.delay > linear.delay


def test_a_first_order_chain():
    m = analysis.margins([2.0])
    assert (m.gain_lower, m.gain_upper, m.modulus, m.max_sensitivity) == (0, np.inf, 1, 1)
    assert m.modulus_frequency == np.inf
    assert m.phase == pytest.approx(np.pi / 2)
    assert m.delay == pytest.approx(np.pi / 4)
    assert m.lag == np.inf
    assert m.two_lags == pytest.approx(1.0)  # tau < 2/k


def test_a_second_order_chain():
    m = analysis.margins([4.0, 3.0])
    assert (m.gain_lower, m.gain_upper) == (0, np.inf)
    assert m.lag == pytest.approx(3 / 4)  # Routh: tau < k2/k1


@given(
    st.lists(st.floats(-30.0, -0.3), min_size=1, max_size=2),
    st.floats(-10.0, -0.3),
    st.floats(0.1, 30.0),
    st.integers(1, 4),
)
def test_lag_margin_is_the_first_loss_of_stability(real, sigma, omega, lags):
    gain = analysis.place([*real, complex(sigma, omega), complex(sigma, -omega)])
    margin = analysis.lag_margin(gain, lags)
    assert not is_stable(gain, lag=margin * OUTSIDE, lags=lags)
    for fraction in (0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, INSIDE):
        assert is_stable(gain, lag=margin * fraction, lags=lags)


@pytest.mark.parametrize("scale", [1e-4, 1e4])
def test_margins_scale_with_time(scale):
    slow = PAPER * scale ** np.array([3, 2, 1])
    m, reference = analysis.margins(slow), analysis.margins(PAPER)
    assert m.gain_lower == pytest.approx(reference.gain_lower, rel=1e-6)
    assert m.phase == pytest.approx(reference.phase, rel=1e-6)
    assert m.modulus == pytest.approx(reference.modulus, rel=1e-6)
    for time in ("delay", "lag", "two_lags"):
        assert getattr(m, time) * scale == pytest.approx(getattr(reference, time), rel=1e-6)


@pytest.mark.parametrize("gain", [[1, 1, 1], [-1, 2, 3], [1, 1, 0.5], [0, 1, 1]])
def test_a_loop_that_is_not_stable_has_no_margins(gain):
    with pytest.raises(ParameterError, match="stabilising gain"):
        analysis.margins(gain)
    with pytest.raises(ParameterError, match="stabilising gain"):
        analysis.lag_margin(gain)


@pytest.mark.parametrize("lags", [0, -1, 1.5, True])
def test_bad_number_of_lags_is_refused(lags):
    with pytest.raises(ParameterError, match="lags"):
        analysis.lag_margin(PAPER, lags)


def test_no_loop_is_refused():
    with pytest.raises(ParameterError, match="zero"):
        analysis.loop_transfer([0, 0, 0])


@pytest.mark.parametrize(
    ("numerator", "denominator", "modulus", "gain_upper"),
    [([-0.9], [1, 1], 0.1, 10 / 9), ([-0.9, 1], [1, 1], 0.1, 10 / 9), ([0.5, -0.5], [1, 1], 0.5, 2.0)],
)
def test_the_nearest_point_may_lie_at_the_ends(numerator, denominator, modulus, gain_upper):
    """abs(1 + L) is least at w = 0 or for w to infinity, where a search between finds nothing."""
    found = analysis.loop_margins(control.tf(numerator, denominator))
    assert found.modulus == pytest.approx(modulus) and found.max_sensitivity == pytest.approx(1 / modulus)
    assert found.gain_upper == pytest.approx(gain_upper)
