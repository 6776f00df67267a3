"""Root loci: each point is a closed loop, and the plots are python-control's."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from brunovsky import analysis
from brunovsky.errors import ParameterError

C, Q = np.array([500.0, 10.0, 1.0]), 5.0


def distance(found, expected):
    """Largest distance from an expected pole to the nearest one found."""
    return max(np.min(np.abs(np.asarray(found) - one)) for one in expected)


def lagged_poles(gain, lag):
    polynomial = np.concatenate(([1.0], np.zeros(len(gain))))
    return np.roots(np.polyadd(np.polymul(polynomial, [lag, 1.0]), gain[::-1]))


def test_over_q_one_pole_moves_and_those_of_the_surface_stay():
    rates = np.array([0.0, 1.0, 5.0, 40.0])
    locus = analysis.root_locus_over_reaching_rate(C, rates=rates)
    assert locus.loci.shape == (4, 3)
    np.testing.assert_array_equal(locus.gains, rates)
    for rate, poles in zip(rates, locus.loci, strict=True):
        assert distance(poles, [-rate, *analysis.surface_poles(C)]) < 1e-9


@pytest.mark.parametrize("surface", [C, [-1000.0, -20.0, -2.0], [6.0, 5.0], [24.0, 26.0, 9.0, 1.0]])
@pytest.mark.parametrize("lag", [0.0, 0.01])
def test_every_point_over_q_is_a_closed_loop(surface, lag):
    locus = analysis.root_locus_over_reaching_rate(surface, lag=lag, rates=[0.3, 5.0, 60.0])
    for rate, poles in zip(locus.gains, locus.loci, strict=True):
        gain = analysis.sliding_gain(surface, rate)
        expected = lagged_poles(gain, lag) if lag else analysis.closed_loop_poles(gain)
        assert distance(poles, expected) < 1e-6 * np.max(np.abs(expected))


@settings(max_examples=30)
@given(st.sampled_from([1, 2]), st.floats(0.1, 2000.0), st.floats(0.1, 50.0), st.sampled_from([0.0, 0.02]))
def test_every_point_over_a_surface_gain_is_a_closed_loop(element, value, rate, lag):
    surface = C.copy()
    locus = analysis.root_locus_over_surface_gain(surface, rate, element, lag=lag, gains=[value])
    surface[element - 1] = value
    gain = analysis.sliding_gain(surface, rate)
    expected = lagged_poles(gain, lag) if lag else analysis.closed_loop_poles(gain)
    assert distance(locus.loci[0], expected) < 1e-4 * np.max(np.abs(expected))


def test_the_locus_with_a_lag_crosses_the_axis_at_the_lag_margin():
    margin = analysis.lag_margin(analysis.sliding_gain(C, Q))
    for lag, stable in ((0.99 * margin, True), (1.01 * margin, False)):
        poles = analysis.root_locus_over_reaching_rate(C, lag=lag, rates=[Q]).loci[0]
        assert (np.max(poles.real) < 0) == stable


def test_pole_zero_map_is_that_of_the_closed_loop():
    gain = analysis.sliding_gain(C, Q)
    found = analysis.pole_zero_map(gain)
    assert distance(found.poles, analysis.closed_loop_poles(gain)) < 1e-9
    assert distance(found.zeros, np.roots(gain[::-1])) < 1e-9


@pytest.mark.parametrize(
    "make",
    [
        lambda: analysis.pole_zero_map(analysis.sliding_gain(C, Q)),
        lambda: analysis.root_locus_over_reaching_rate(C, lag=0.01),
        lambda: analysis.root_locus_over_surface_gain(C, Q, 1),
    ],
)
def test_the_result_plots_itself(make):
    plt.figure()
    axes = make().plot().axes[0, 0]
    assert axes.get_xlabel() and axes.get_ylabel()
    plt.close("all")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: analysis.root_locus_over_reaching_rate([1, 2, 0]), "c_n != 0"),
        (lambda: analysis.root_locus_over_reaching_rate(C, lag=-1), "lag >= 0"),
        (lambda: analysis.root_locus_over_reaching_rate(C, rates=[1, -2]), "Q >= 0"),
        (lambda: analysis.root_locus_over_surface_gain(C, Q, 3), "only scales S"),
        (lambda: analysis.root_locus_over_surface_gain(C, Q, 0), "pass 1"),
        (lambda: analysis.root_locus_over_surface_gain(C, Q, "c1"), "pass 1"),
        (lambda: analysis.root_locus_over_surface_gain([1.0], Q, 1), "at least 2"),
        (lambda: analysis.root_locus_over_surface_gain(C, Q, 1, gains=[np.nan]), "finite"),
        (lambda: analysis.pole_zero_map([0, 0, 0]), "zero"),
    ],
)
def test_bad_input_is_refused_with_a_remedy(call, message):
    with pytest.raises(ParameterError, match=message):
        call()
