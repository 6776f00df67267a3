"""Describing function: textbook answers, the saturation's threshold, and which of several cycles are stable."""

import control
import numpy as np
import pytest

from brunovsky.analysis import SwitchingLoop, harmonic_balance, predicted_cycles
from brunovsky.errors import ParameterError

C, Q, P = (500.0, 10.0, 1.0), 5.0, 2.5


def two_lags(milliseconds, **more):
    return SwitchingLoop(C, Q, P, lags=[milliseconds * 1e-3] * 2, **more)


@pytest.mark.parametrize("lag", [1e-4, 0.02, 3.0])
def test_integrator_with_two_lags(lag):
    (cycle,) = predicted_cycles(SwitchingLoop((1.0,), 0.0, P, lags=[lag, lag]))
    assert cycle.frequency == pytest.approx(1 / lag, rel=1e-9)  # P/(s (1 + lag s)^2) turns by -pi there
    assert cycle.amplitude == cycle.fundamental == pytest.approx(2 * P * lag / np.pi, rel=1e-9)
    assert cycle.stable
    assert cycle.method == "describing function"


def test_integrator_with_a_delay():
    stable = [one for one in predicted_cycles(SwitchingLoop((1.0,), 0.0, P, delay=0.01)) if one.stable]
    assert len(stable) == 1
    assert stable[0].frequency == pytest.approx(np.pi / 2 / 0.01, rel=1e-9)
    assert stable[0].amplitude == pytest.approx(8 * P * 0.01 / np.pi**2, rel=1e-9)


def test_two_equal_lags_of_the_paper():
    for lag in (5, 7, 9):
        assert [one.stable for one in predicted_cycles(two_lags(lag))] == [True]
    for lag in (9.3, 12, 14):
        small, large = predicted_cycles(two_lags(lag))
        assert (small.stable, large.stable) == (True, False)
        assert small.frequency > large.frequency
    assert predicted_cycles(two_lags(15)) == ()


def test_one_lag_of_the_paper():
    assert predicted_cycles(SwitchingLoop(C, Q, P, lags=[0.0189])) == ()
    (only,) = predicted_cycles(SwitchingLoop(C, Q, P, lags=[0.025]))
    assert not only.stable


def test_hysteresis_satisfies_the_harmonic_balance():
    loop = two_lags(5, hysteresis=0.004)
    (cycle,) = predicted_cycles(loop)
    gain = control.relay_hysteresis_nonlinearity(1.0, 0.004).describing_function(cycle.amplitude)
    assert abs(1 + gain * loop.frequency_response(cycle.frequency)) < 1e-9
    assert cycle.stable
    assert cycle.frequency < predicted_cycles(two_lags(5))[0].frequency


@pytest.mark.parametrize("phi", [1e-4, 2e-3, 7e-3])
def test_saturation_satisfies_the_harmonic_balance(phi):
    loop = two_lags(5, boundary_layer=phi)
    (cycle,) = predicted_cycles(loop)
    gain = control.saturation_nonlinearity(1.0).describing_function(cycle.amplitude / phi) / phi
    assert abs(1 + gain * loop.frequency_response(cycle.frequency)) < 1e-9
    assert cycle.stable


def test_a_saturation_wide_enough_has_no_cycle():
    threshold = np.pi / 4 * predicted_cycles(two_lags(5))[0].amplitude  # abs(W) at the phase crossover
    assert predicted_cycles(two_lags(5, boundary_layer=threshold * 1.001)) == ()
    (barely,) = predicted_cycles(two_lags(5, boundary_layer=threshold * 0.999))
    assert barely.amplitude == pytest.approx(threshold, rel=0.05)


def test_response_is_that_of_python_control_in_our_units():
    loop = two_lags(12)
    response = harmonic_balance(loop)
    assert isinstance(response, control.DescribingFunctionResponse)
    assert len(response.intersections) == 2
    for (amplitude, frequency), at in zip(response.intersections, response.positions, strict=True):
        assert at == pytest.approx(loop.frequency_response(frequency))
        assert at == pytest.approx(-np.pi * amplitude / 4, rel=1e-9)
    plain = control.describing_function_response(
        loop.linear_part(), control.relay_hysteresis_nonlinearity(1.0, 0.0), [1e-3, 1.0], np.logspace(1, 3, 500)
    )
    found = sorted(plain.intersections)
    for one, (amplitude, frequency) in zip(predicted_cycles(loop), found, strict=True):
        assert (one.amplitude, one.frequency) == pytest.approx((amplitude, frequency), rel=1e-3)


def test_amplitude_scales_with_P_and_frequency_does_not():
    for factor in (1e-6, 1e6):
        (one,), (other,) = (predicted_cycles(SwitchingLoop(C, Q, p, lags=[0.005] * 2)) for p in (P, factor * P))
        assert other.amplitude == pytest.approx(factor * one.amplitude, rel=1e-9)
        assert other.frequency == pytest.approx(one.frequency, rel=1e-9)


def test_no_switching_is_refused():
    for call in (harmonic_balance, predicted_cycles):
        with pytest.raises(ParameterError, match="pass P > 0"):
            call(SwitchingLoop(C, Q, 0.0, lags=[0.01]))
