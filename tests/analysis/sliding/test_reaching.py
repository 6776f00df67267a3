"""Reaching times of the power rate, and the relay's cycle, against integrations."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad, solve_ivp

from brunovsky import analysis
from brunovsky.errors import ParameterError


@given(st.floats(0.01, 50), st.floats(0.0, 10), st.floats(0.1, 20), st.floats(0.0, 0.9))
def test_time_is_the_integral_of_the_slowness(start: float, Q: float, P: float, a: float) -> None:
    """dt = -dS/(Q S + P S^a); with S = y^(1/(1-a)) the integrand is bounded."""
    power = 1.0 / (1.0 - a)
    expected, _ = quad(lambda y: power / (Q * y + P), 0.0, start ** (1.0 - a), epsabs=1e-13, epsrel=1e-11)
    assert analysis.reaching_time(-start, Q, P, a) == pytest.approx(expected, rel=1e-8)


def test_power_rate_against_an_integration() -> None:
    Q, P, a = 2.0, 3.0, 0.4

    def reached(t: float, s: np.ndarray) -> float:
        return s[0] - 1e-2

    reached.terminal = True  # type: ignore[attr-defined]
    found = solve_ivp(
        lambda t, s: -Q * s - P * np.maximum(s, 0) ** a, (0, 9), [5.0], events=reached, rtol=1e-10, atol=1e-13
    )
    rest = analysis.reaching_time(1e-2, Q, P, a)
    assert analysis.reaching_time(5.0, Q, P, a) - rest == pytest.approx(found.t_events[0][0], rel=1e-6)


def test_closed_forms_of_the_limits() -> None:
    assert analysis.reaching_time(9.0, 0.0, 2.0, 0.5) == pytest.approx(3.0)  # 2 sqrt(9)/2
    assert analysis.reaching_time(9.0, 1e-12, 2.0, 0.5) == pytest.approx(3.0)
    assert analysis.reaching_time(9.0, 3.0, 0.0, 0.5) == np.inf


@given(st.floats(0.5, 50), st.floats(0.001, 0.5), st.floats(0.0, 0.9), st.floats(0.001, 0.2))
def test_half_a_cycle_brings_the_amplitude_to_its_opposite(P: float, h: float, ratio: float, dwell: float) -> None:
    Q = ratio * P / h
    for rest in (0.0, dwell):
        cycle = analysis.relay_cycle(P, h, reaching_rate=Q, dwell=rest)
        half, A = cycle.period / 2, cycle.amplitude
        end = (A + P / Q) * np.exp(-Q * half) - P / Q if 1e-9 * P / h < Q else A - P * half
        assert end == pytest.approx(-A, rel=1e-6)
        assert h * (1 - 1e-12) <= A and half >= rest * (1 - 1e-12)


def test_the_exponential_part_tends_to_none() -> None:
    one, other = (analysis.relay_cycle(2.0, 0.1, reaching_rate=Q) for Q in (0.0, 1e-7))
    assert one == analysis.RelayCycle(0.1, pytest.approx(0.2))
    assert other.period == pytest.approx(one.period, rel=1e-9)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: analysis.reaching_time(1, 1, 1, 1.0), "exponent = 1; from 1 on"),
        (lambda: analysis.reaching_time(1, 1, 1, -0.1), "exponent >= 0"),
        (lambda: analysis.relay_cycle(2.0, 0.0), "the period is zero"),
        (lambda: analysis.relay_cycle(1.0, 0.5, reaching_rate=2.0), "comes to rest"),
        (lambda: analysis.relay_cycle(0.0, 0.5), "P > 0"),
        (lambda: analysis.relay_cycle(1.0, -0.5), "hysteresis >= 0"),
    ],
)
def test_bad_input_is_refused(call: object, message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        call()  # type: ignore[operator]
