"""Gains and surfaces: textbook answers, the paper's numbers, and the identities between them."""

import control
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from brunovsky import analysis
from brunovsky.errors import ParameterError

C, Q, P, PHI = [500.0, 10.0, 1.0], 5.0, 2.5, 0.05

coefficient = st.floats(0.1, 100.0)


def test_place_gives_the_binomial_gain_for_a_triple_pole():
    K = analysis.place([-5, -5, -5])
    assert K.shape == (3,) and K.dtype == np.float64
    np.testing.assert_allclose(K, [125, 75, 15], rtol=1e-14)


@given(st.lists(st.floats(-20, -0.5), min_size=1, max_size=4), st.floats(-10, -0.5), st.floats(0.1, 20))
def test_place_gives_the_coefficients_of_the_polynomial(real, sigma, omega):
    poles = [*real, complex(sigma, omega), complex(sigma, -omega)]
    np.testing.assert_allclose(analysis.place(poles), np.poly(poles).real[:0:-1], rtol=1e-8)


def test_sliding_gain_of_the_paper():
    K = analysis.sliding_gain(C, Q)
    np.testing.assert_allclose(K, [2500, 550, 15], rtol=1e-15)
    expected = [-5, -5 - 1j * np.sqrt(475), -5 + 1j * np.sqrt(475)]  # the surface's, +-21.79j, and -Q
    poles = analysis.closed_loop_poles(K)
    for pole in expected:
        assert np.min(np.abs(poles - pole)) < 1e-9
    np.testing.assert_allclose(analysis.place(expected), K, rtol=1e-12)


@given(st.lists(coefficient, min_size=1, max_size=5), coefficient, st.sampled_from([-1.0, 1.0]))
def test_sliding_gain_is_the_surface_polynomial_times_the_reaching_pole(surface, rate, sign):
    surface = sign * np.array(surface)
    product = np.polymul(surface[::-1], [1.0, rate]) / surface[-1]
    np.testing.assert_allclose(np.r_[1.0, analysis.sliding_gain(surface, rate)[::-1]], product, rtol=1e-12)


@given(st.lists(st.floats(-1, 1), min_size=3, max_size=3))
def test_sliding_gain_is_the_printed_law_without_its_switching_term(error):
    S = np.dot(C, error)
    v = (-Q * S - C[0] * error[1] - C[1] * error[2]) / C[2]
    np.testing.assert_allclose(-analysis.sliding_gain(C, Q) @ error, v, atol=1e-9)


def test_boundary_layer_gain_is_the_saturated_law_inside_the_layer():
    K = analysis.boundary_layer_gain(C, Q, P, PHI)
    np.testing.assert_allclose(K, [27500, 1050, 65], rtol=1e-14)
    np.testing.assert_allclose(np.min(analysis.closed_loop_poles(K).real), -(Q + P / PHI), rtol=1e-9)

    def saturated(t, e):
        S = np.dot(C, e)
        return [e[1], e[2], -Q * S - P * np.clip(S / PHI, -1, 1) - C[0] * e[1] - C[1] * e[2]]

    start = np.array([5e-5, -2e-4, 5e-3])
    times = np.linspace(0, 1, 101)
    nonlinear = solve_ivp(saturated, (0, 1), start, t_eval=times, rtol=1e-10, atol=1e-14).y
    assert np.max(np.abs(C @ nonlinear)) < PHI
    linear = control.initial_response(analysis.error_dynamics(K), times, start).outputs
    np.testing.assert_allclose(nonlinear, linear, atol=1e-9)


def test_boundary_layer_gain_without_switching_is_the_linear_part():
    np.testing.assert_array_equal(analysis.boundary_layer_gain(C, Q, 0.0, PHI), analysis.sliding_gain(C, Q))


def test_surface_poles_of_the_paper_and_back():
    poles = analysis.surface_poles(C)
    np.testing.assert_allclose(poles, [-5 - 1j * np.sqrt(475), -5 + 1j * np.sqrt(475)], rtol=1e-13)
    np.testing.assert_allclose(analysis.surface_from_poles(poles), C, rtol=1e-13)
    np.testing.assert_allclose(analysis.surface_from_poles(poles, leading=-2), [-1000, -20, -2], rtol=1e-13)
    np.testing.assert_allclose(analysis.surface_poles([-1000, -20, -2]), poles, rtol=1e-13)


def test_surface_of_a_first_order_chain_has_no_poles():
    assert analysis.surface_poles([2.0]).shape == (0,)


@given(st.lists(st.floats(-20, -1e-3) | st.floats(1e-3, 5), min_size=1, max_size=5), st.floats(0.5, 20))
def test_surface_from_poles_vanishes_at_its_poles(poles, leading):
    surface = analysis.surface_from_poles(poles, leading=leading)
    assert surface.shape == (len(poles) + 1,) and surface[-1] == leading
    for pole in poles:
        size = np.polyval(np.abs(surface[::-1]), abs(pole))
        assert abs(np.polyval(surface[::-1], pole)) <= 1e-12 * size


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: analysis.place([]), "at least 1"),
        (lambda: analysis.place([-1, -2 + 1j]), "conjugate"),
        (lambda: analysis.place([[-1, -2], [-3, -4]]), "one chain at a time"),
        (lambda: analysis.place([-1, np.inf]), "not finite"),
        (lambda: analysis.place("abc"), "not a list of numbers"),
        (lambda: analysis.closed_loop_poles([1j, 1]), "complex"),
        (lambda: analysis.sliding_gain([500, 10, 0], 5), "ascending order"),
        (lambda: analysis.sliding_gain(C, np.nan), "Q = nan is not finite"),
        (lambda: analysis.sliding_gain(C, None), "not a real number"),
        (lambda: analysis.boundary_layer_gain(C, Q, -1, PHI), "P >= 0"),
        (lambda: analysis.boundary_layer_gain(C, Q, P, 0), "phi > 0"),
        (lambda: analysis.boundary_layer_gain(C, Q, 1e300, 1e-300), "not finite"),
        (lambda: analysis.surface_poles([1, 0]), "c_n != 0"),
        (lambda: analysis.surface_from_poles([-1], leading=0), "c_n != 0"),
        (lambda: analysis.surface_from_poles([1j]), "conjugate"),
    ],
)
def test_bad_input_is_refused_with_a_remedy(call, message):
    with pytest.raises(ParameterError, match=message):
        call()


def test_the_switching_bound_of_the_paper_is_that_of_its_closed_form():
    assert analysis.switching_gain_margin(C, Q) == pytest.approx(50 * 500**0.5 / ((500**0.5 + 10) * (500**0.5 + 50)))
    assert analysis.switching_gain_margin(C, 100.0) == pytest.approx(50 * 100 / (110 * 150))
    assert analysis.switching_gain_margin(C, Q) == pytest.approx(0.4775, abs=1e-4)


@given(coefficient, coefficient, coefficient, coefficient)
def test_no_effective_rate_has_a_larger_lower_gain_margin_than_the_bound(c1, c2, c3, rate):
    bound = analysis.switching_gain_margin([c1, c2, c3], rate)
    rates = np.append(rate * np.geomspace(1.0, 1e4, 60), max(rate, (c1 / c3) ** 0.5))
    limits = []
    for one in rates:  # k with a pair of roots on the imaginary axis: k k3 k2 = k1
        k1, k2, k3 = analysis.sliding_gain([c1, c2, c3], one)
        limits.append(k1 / (k2 * k3))
    assert max(limits) == pytest.approx(bound, rel=1e-9) and bound < 1.0


@pytest.mark.parametrize(("surface", "rate"), [([500.0, -10.0, 1.0], 5.0), ([10.0, 1.0], 5.0), (C, 0.0)])
def test_the_switching_bound_is_refused_where_there_is_none(surface, rate):
    with pytest.raises(ParameterError, match="switching_gain_margin"):
        analysis.switching_gain_margin(surface, rate)
