"""Metrics against signals whose metrics are known in closed form."""

import math

import numpy as np
import pytest
import xarray as xr

from brunovsky.comparison import compute_metrics
from brunovsky.comparison.metrics import integral, settling_time, tail, total_variation


def trajectory(time, e1, e2, speed, u1, u2) -> xr.Dataset:
    columns = {"e1[1]": e1, "e2[1]": e2, "eta[1]": speed, "u[1]": u1, "u[2]": u2}
    return xr.Dataset(
        {name: ("time", np.broadcast_to(one, time.shape)) for name, one in columns.items()}, {"time": time}
    )


@pytest.fixture
def decay() -> xr.Dataset:
    """Error 5 exp(-2 t) split 3:4 over the axes, speed -1 - t, u1 = sin t, u2 a ramp."""
    time = np.linspace(0.0, 8.0, 8001)
    error = np.exp(-2.0 * time)
    return trajectory(time, 3.0 * error, -4.0 * error, -1.0 - time, np.sin(time), 2.0 - time)


def test_integrals_of_an_exponential(decay):
    metrics = compute_metrics(decay)
    assert metrics.iae == pytest.approx(5.0 / 2.0, rel=1e-5)
    assert metrics.ise == pytest.approx(25.0 / 4.0, rel=1e-5)
    assert metrics.itae == pytest.approx(5.0 / 4.0, rel=1e-5)
    assert metrics.effort_u1 == pytest.approx(4.0 - math.sin(16.0) / 4.0, rel=1e-6)
    assert metrics.effort_u2 == pytest.approx((6.0**3 + 2.0**3) / 3.0, rel=1e-6)


def test_times_and_peaks(decay):
    metrics = compute_metrics(decay)
    assert metrics.settling_time == pytest.approx(math.log(500.0) / 2.0, abs=1e-3)
    assert metrics.final_error == pytest.approx(5.0 * math.exp(-16.0))
    assert (metrics.peak_speed, metrics.min_speed) == (9.0, 1.0)
    assert metrics.peak_yaw_acceleration == 6.0
    mean_square = 25.0 * (math.exp(-24.0) - math.exp(-32.0)) / 4.0 / 2.0
    assert metrics.rms_tail_error == pytest.approx(math.sqrt(mean_square), rel=1e-2)


def test_total_variation_is_the_sum_of_the_ups_and_downs(decay):
    metrics = compute_metrics(decay)
    assert metrics.total_variation_u2 == pytest.approx(8.0)
    ups_and_downs = 1 + 2 + 2 + abs(math.sin(8.0) - math.sin(2.5 * math.pi))
    assert metrics.total_variation_u1 == pytest.approx(ups_and_downs, rel=1e-5)
    assert total_variation(np.array([1.0, -1.0, 1.0, -1.0])) == 6.0


def test_the_trapezoid_is_exact_for_a_line_on_uneven_instants():
    time = np.array([0.0, 0.1, 0.5, 2.0])
    assert integral(time, 3.0 * time + 1.0) == pytest.approx(8.0)


@pytest.mark.parametrize(
    ("error", "expected"),
    [([0.001, 0.002, 0.001], 0.0), ([1.0, 0.02, 0.001], 1.0), ([0.0, 0.001, 0.02], None), ([0.02, 0.01, 0.01], 0.0)],
)
def test_settling_time_is_the_last_time_above_one_centimetre(error, expected):
    assert settling_time(np.array([0.0, 1.0, 2.0]), np.array(error)) == expected


def test_a_run_that_never_settles_has_no_settling_time():
    time = np.linspace(0.0, 1.0, 11)
    metrics = compute_metrics(trajectory(time, 1.0, 0.0, 1.0, 0.0, 0.0))
    assert metrics.settling_time is None
    assert metrics.rms_tail_error == pytest.approx(1.0)


def test_the_tail_is_the_last_quarter_with_its_first_instant():
    time = np.linspace(0.0, 20.0, 20001)
    assert time[tail(time)][0] == pytest.approx(15.0)
    assert time[tail(time)].size == 5001


def test_what_is_not_finite_is_none_not_nan():
    time = np.linspace(0.0, 1.0, 3)
    metrics = compute_metrics(trajectory(time, 1e200, 0.0, 1.0, 0.0, 0.0))
    assert metrics.ise is None and metrics.iae == pytest.approx(1e200)
