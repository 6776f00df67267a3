"""The pair of Dormand and Prince against scipy's, its order, and what it does with values that are not finite."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import RK45

from brunovsky.blocks import dormand_prince as dp

ONE = np.ones(1)


def slope(time: float, x: np.ndarray) -> np.ndarray:
    return math.cos(time) * x


def exact(time: float) -> np.ndarray:
    return np.array([math.exp(math.sin(time))])


def one_step(size: float) -> dp.Step:
    """Step from t = 0.3, where it starts exactly."""
    return dp.attempt(slope, 0.3, exact(0.3), slope(0.3, exact(0.3)), size)


def test_coefficients_are_those_of_scipy() -> None:
    for row, theirs in zip(dp.MATRIX[:6], RK45.A, strict=True):
        assert row == pytest.approx(theirs[: len(row)], rel=1e-15)
    assert dp.MATRIX[6] == pytest.approx(RK45.B, rel=1e-15)
    assert dp.NODES[:6] == pytest.approx(RK45.C, rel=1e-15)
    assert np.array(dp.ERROR) == pytest.approx(-RK45.E, rel=1e-13)


@given(st.floats(0, 1), st.integers(0, 6))
def test_the_interpolation_is_that_of_scipy(fraction: float, which: int) -> None:
    slopes = np.zeros((7, 1))
    slopes[which] = 1.0
    end = np.array([dp.MATRIX[6][which] if which < 6 else 0.0])
    step = dp.Step(1.0, ((0.0, np.zeros(1)), (1.0, end)), slopes)
    expected = RK45.P[which] @ fraction ** np.arange(1, 5)
    assert step.at(fraction)[0] == pytest.approx(expected, abs=1e-14)


def test_fixed_steps_have_order_five() -> None:
    errors = []
    for count in (80, 160, 320):
        x, size = exact(0.0), 4 / count
        for index in range(count):
            x = dp.attempt(slope, index * size, x, slope(index * size, x), size).end
        errors.append(float(abs(x - exact(4.0))[0]))
    assert np.diff(-np.log2(errors)) == pytest.approx(5, abs=0.1)


@pytest.mark.parametrize(("fraction", "order"), [(0.5, 5), (1.0, 6)])
def test_one_step_is_off_by_a_power_more_than_its_order(fraction: float, order: int) -> None:
    """Order 4 in its middle, 5 at its end."""
    errors = [abs(one_step(size).at(fraction) - exact(0.3 + fraction * size))[0] for size in (0.2, 0.1, 0.05)]
    assert np.diff(-np.log2(errors)) == pytest.approx(order, abs=0.1)


def test_the_estimate_is_that_of_order_four() -> None:
    assert math.log2(one_step(0.02).error(1e-6, ONE) / one_step(0.01).error(1e-6, ONE)) == pytest.approx(5, abs=0.1)


@pytest.mark.parametrize("value", [math.inf, math.nan])
def test_a_step_that_is_not_finite_is_no_step_within_the_tolerance(value: float) -> None:
    step = dp.attempt(lambda _time, x: x * value, 0.0, np.ones(2), np.ones(2), 0.1)
    assert not step.error(1e-6, ONE) <= 1
    assert dp.factor(step.error(1e-6, ONE)) == dp.SMALLEST_FACTOR


@given(st.floats(-1e9, 1e9), st.floats(-1e9, 1e9), st.floats(1e-9, 1e3))
def test_the_first_size_is_positive_and_not_too_long(start: float, gain: float, longest: float) -> None:
    x = np.array([start])
    size = dp.first_size(lambda _time, x: gain * x, 0.0, x, gain * x, longest, 1e-6, ONE)
    assert 0 < size <= longest
