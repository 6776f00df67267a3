"""Heading error at the end and time of arrival, by hand; None where no heading is asked for."""

import math

import numpy as np
import pytest
import xarray as xr

from brunovsky.comparison import compute_metrics

TIME = np.arange(0.0, 10.5, 0.5)


def trajectory(**changed):
    zero = np.zeros(TIME.size)
    names = ("x", "y", "theta", "eta[1]", "eta[2]", "u[1]", "u[2]", "position_error[1]", "position_error[2]")
    return xr.Dataset({name: ("time", changed.get(name, zero)) for name in names}, coords={"time": TIME})


def test_a_heading_counts_modulo_a_turn():
    data = trajectory(theta=np.full(TIME.size, 2.0 * math.pi + 0.3))
    assert compute_metrics(data, goal_heading=0.1).final_heading_error == pytest.approx(0.2)
    assert compute_metrics(data, goal_heading=0.3 - 4.0 * math.pi).final_heading_error == pytest.approx(0.0, abs=1e-12)
    assert compute_metrics(data).final_heading_error is None
    assert compute_metrics(data).arrival_time is None


@pytest.mark.parametrize(
    ("name", "size"), [("position_error[2]", 5e-3), ("theta", 0.02), ("eta[1]", 1e-3), ("eta[2]", 1e-3)]
)
def test_arrival_waits_for_place_heading_and_rest(name, size):
    late = np.where(TIME <= 4.0, 1.001 * size, 0.999 * size)
    assert compute_metrics(trajectory(**{name: late}), goal_heading=0.0).arrival_time == 4.0
    never = np.where(TIME >= 9.0, -1.001 * size, 0.0)
    assert compute_metrics(trajectory(**{name: never}), goal_heading=0.0).arrival_time is None
    assert compute_metrics(trajectory(**{name: 0.999 * size * (TIME < 3.0)}), goal_heading=0.0).arrival_time == 0.0
