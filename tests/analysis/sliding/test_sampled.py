"""Limits of the sampling period, and of the slope that super-twisting bears."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from brunovsky import analysis
from brunovsky.errors import ParameterError

C = [500.0, 10.0, 1.0]


def test_numbers_of_the_paper():
    assert analysis.largest_sampling_period(C) == pytest.approx(0.0572, abs=5e-5)
    assert analysis.largest_sampling_period(C, surface_map="exact") == pytest.approx(0.1549, abs=5e-5)
    assert analysis.largest_sampling_period(C, reaching_rate=5.0) == pytest.approx(0.0405, abs=5e-5)
    assert analysis.largest_sampling_period(C, reaching_rate=5.0, surface_map="exact") == pytest.approx(
        0.1549, abs=5e-5
    )


@given(st.floats(0.1, 1e4), st.floats(0.05, 5.0), st.floats(0.1, 10.0))
@settings(max_examples=15)
def test_the_exact_map_s_limit_of_three_integrators(c1, damping, leading):
    """The zeros of c1 h^2/6 (z^2 + 4 z + 1) + c2 h/2 (z^2 - 1) + c3 (z - 1)^2 leave by z = -1, at h^2 = 12 c3/c1."""
    surface = leading * np.array([c1, 2 * damping * np.sqrt(c1), 1.0])
    assert analysis.largest_sampling_period(surface, surface_map="exact") == pytest.approx(np.sqrt(12 / c1), rel=1e-9)


@given(st.floats(0.1, 100.0), st.floats(0.1, 100.0))
@settings(max_examples=15)
def test_two_integrators(c1, rate):
    """Euler: e+ = e + h e2 + h^2/2 u, e2+ = e2 + h u with u = -c1 e2 - S/h leaves by z = -1 at c1 h = 2."""
    assert analysis.largest_sampling_period([c1, 1.0], surface_map="exact") == float("inf")
    assert analysis.largest_sampling_period([c1, 1.0], reaching_rate=rate, surface_map="exact") == pytest.approx(
        2 / rate
    )
    euler = analysis.largest_sampling_period([c1, 1.0])
    poles = analysis.sampled_sliding_poles([c1, 1.0], euler)
    assert abs(poles).max() == pytest.approx(1.0, abs=1e-9)


def test_light_damping_and_repeated_poles():
    """The limit is where a pole crosses the unit circle; equal poles do not blur it."""
    light = analysis.largest_sampling_period([1.0, 2e-3, 1.0])
    for factor, stable in ((0.99, True), (1.01, False)):
        assert (abs(analysis.sampled_sliding_poles([1.0, 2e-3, 1.0], factor * light)).max() < 1) == stable
    equal = analysis.surface_from_poles([-5.0] * 4)
    found = analysis.largest_sampling_period(equal)
    assert 0.01 < found < 1.0
    with pytest.raises(ParameterError, match="so lightly damped"):
        analysis.largest_sampling_period([1.0, 1e-12, 1.0], reaching_rate=1.0)


def test_one_integrator_is_dead_beat():
    assert analysis.sampled_sliding_poles([2.0], 0.3) == pytest.approx([0.0], abs=1e-12)
    assert analysis.largest_sampling_period([2.0]) == float("inf")
    assert analysis.largest_sampling_period([2.0], reaching_rate=4.0) == pytest.approx(0.5)


@pytest.mark.parametrize("surface", [[24.0, 26.0, 9.0, 1.0], C, [3.0, 1.0]])
@pytest.mark.parametrize("rate", [None, 5.0])
def test_poles_of_the_exact_map_are_the_zeros_and_the_rate(surface, rate):
    """Independently: zeros as generalised eigenvalues of the system matrix of the sampled chain, with S as output."""
    n, h = len(surface), 0.07
    held = expm(h * np.eye(n + 1, k=1))
    pencil = np.block([[held[:n, :n], held[:n, n:]], [np.array([surface]), np.zeros((1, 1))]])
    z = np.random.default_rng(0).normal(size=7) + 1.5
    found = analysis.sampled_sliding_poles(surface, h, reaching_rate=rate, surface_map="exact")
    own = 0.0 if rate is None else 1 - h * rate
    index = int(np.argmin(abs(found - own)))
    assert found[index] == pytest.approx(own, abs=1e-9)
    zeros = np.delete(found, index)
    for one in z:
        shifted = pencil - one * np.diag([1.0] * n + [0.0])
        ratio = np.linalg.det(shifted) / np.prod(one - zeros)
        assert ratio == pytest.approx(np.linalg.det(pencil - 9 * np.diag([1.0] * n + [0.0])) / np.prod(9 - zeros))


def test_short_periods_give_the_continuous_poles():
    h = 1e-5
    for surface_map in ("euler", "exact"):
        poles = analysis.sampled_sliding_poles(C, h, reaching_rate=5.0, surface_map=surface_map)
        found = np.log(poles) / h
        assert np.poly(found) == pytest.approx(np.polymul([1.0, 5.0], [1.0, 10.0, 500.0]), rel=1e-2)


def test_gains_of_super_twisting():
    assert analysis.super_twisting_slope_bound(4.0) == pytest.approx(4.4)
    assert analysis.super_twisting_slope_bound(1.0, [2.0, 3.0]) == pytest.approx(1.0)
    assert analysis.super_twisting_slope_bound(9.0, [1.0, 3.0]) == 0.0


@given(st.floats(1e-3, 1e3))
def test_levant_s_gains_satisfy_the_condition_of_seeber_and_horn(slope):
    K1, K2 = 1.5 * np.sqrt(slope), 1.1 * slope
    assert slope < K2 and np.sqrt(K2 + slope) < K1
    assert analysis.super_twisting_condition(slope, slope)
    assert not analysis.super_twisting_condition(1.2 * slope, slope)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: analysis.sampled_sliding_poles(C, 0.0), "sampling_period = 0 is out of range"),
        (lambda: analysis.sampled_sliding_poles([1.0, 0.0], 0.1), "v does not appear"),
        (lambda: analysis.sampled_sliding_poles(C, 0.1, surface_map="zoh"), "pass 'euler' or 'exact'"),
        (lambda: analysis.sampled_sliding_poles([-2.0, 1.0], 1.0, surface_map="exact"), "v does not move S"),
        (lambda: analysis.largest_sampling_period([500.0, -10.0, 1.0]), "not stable at any period"),
        (lambda: analysis.largest_sampling_period(C, reaching_rate=0.0), "Q > 0"),
        (lambda: analysis.largest_sampling_period(C, surface_map="Euler"), "pass 'euler' or 'exact'"),
        (lambda: analysis.super_twisting_slope_bound(0.0), "L > 0"),
        (lambda: analysis.super_twisting_slope_bound(1.0, [1.5]), "at least 2"),
        (lambda: analysis.super_twisting_slope_bound(1.0, [1.5, -1.0]), "two positive gains"),
        (lambda: analysis.super_twisting_condition(-1.0, 1.0), "slope >= 0"),
    ],
)
def test_bad_input_is_refused(call, message):
    with pytest.raises(ParameterError, match=message):
        call()
