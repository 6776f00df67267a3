"""Poles in the frame of the goal, from many resting poses: forecast, simulation, and why it fails where it fails."""

import math
from collections import Counter
from functools import cache

import numpy as np
import pytest
import xarray as xr

import brunovsky as br
from brunovsky import analysis as an
from brunovsky.errors import ModelError, ParameterError

ALONG, ACROSS = (-0.12, -0.5, -0.6), (-0.5, -0.6, -0.7)
LAUNCH_SPEED, LAUNCH_ACCELERATION = 0.3, 0.3


def poses_of(*rows: tuple[float, float, float, float]) -> xr.Dataset:
    names = ("x_start", "y_start", "theta_start", "goal_heading")
    return xr.Dataset(
        {name: ("pose", np.array(column)) for name, column in zip(names, zip(*rows, strict=True), strict=True)}
    )


@cache
def both(number: int, P: float = 0.0) -> tuple[xr.Dataset, xr.Dataset, xr.Dataset]:
    poses, law = an.resting_poses(number), br.blocks.goal_frame_law(P=P)
    return poses, an.goal_frame_forecast(poses, law), an.goal_frame_runs(poses, law, step_size=5e-3)


def starts_that_the_launch_carries_too_far(poses: xr.Dataset) -> np.ndarray:
    """Where the slow mode has the wrong sign after the launch, by hand, for P = 0.

    The slow mode's part of the error along the goal's heading is a + a'(1/f1 + 1/f2) + a''/(f1 f2), up to a factor.
    """
    first, second = -ALONG[1], -ALONG[2]
    reach = LAUNCH_SPEED**2 / (2 * LAUNCH_ACCELERATION)
    reach += LAUNCH_SPEED * (1 / first + 1 / second) + LAUNCH_ACCELERATION / (first * second)
    g = poses["goal_heading"].values
    along = -np.sin(g) * poses["x_start"].values + np.cos(g) * poses["y_start"].values
    return np.abs(along) < reach * np.cos(poses["theta_start"].values - g)


def test_poses_are_uniform_and_come_again() -> None:
    poses = an.resting_poses(20_000, radius=4.0, seed=5)
    assert poses.equals(an.resting_poses(20_000, radius=4.0, seed=5))
    assert not poses.equals(an.resting_poses(20_000, radius=4.0, seed=6))
    square = (poses["x_start"] ** 2 + poses["y_start"] ** 2).values / 16
    bearing = np.arctan2(poses["y_start"], poses["x_start"]).values
    assert square.max() <= 1
    for uniform in (square, *((one / math.pi + 1) / 2 for one in (bearing, *angles(poses)))):
        counts, _ = np.histogram(uniform, bins=10, range=(0, 1))
        assert counts.sum() == 20_000
        assert np.sum((counts - 2000) ** 2 / 2000) < 33.7  # chi-square with 9 degrees of freedom, 1e-4
    assert abs(np.corrcoef([square, bearing, *angles(poses)]) - np.eye(4)).max() < 0.03


def angles(poses: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    return poses["theta_start"].values, poses["goal_heading"].values


@pytest.mark.parametrize(
    "arguments", [{"number": 0}, {"number": 2.5}, {"number": True}, {"seed": -1}, {"radius": 0.0}, {"radius": math.nan}]
)
def test_poses_that_cannot_be_drawn_are_refused(arguments: dict) -> None:
    with pytest.raises(ParameterError, match="resting_poses"):
        an.resting_poses(**({"number": 3} | arguments))


def test_hand_picked_starts() -> None:
    cases = {
        (0.0, -6.0, 0.0, 0.0): "reached",  # behind the goal and aligned with it
        (0.0, 6.0, 0.0, 0.0): "reached",  # ahead and aligned: backward
        (3.0, -6.0, 0.7, 0.0): "reached",
        (0.0, -6.0, 2 * math.pi, 0.0): "reached",  # modulo 2 pi
        (2.0, -0.5, 0.0, 0.0): "reversed",  # near: the launch carries it beyond the goal
        (6.0, 1.0, 0.3, 0.0): "reversed",  # far, but near to the line across the goal
        (0.002, 0.0, 0.0, 0.0): "reached",  # at the goal
        (0.002, 0.0, 1.0, 0.0): "tilted",  # at the goal, but for the heading
        (0.002, 0.0, 3.0, 0.0): "reversed",
        (0.01, 0.0, 0.0, 0.0): "away",  # parks where it stands
    }
    poses = poses_of(*cases)
    forecast, runs = an.goal_frame_forecast(poses), an.goal_frame_runs(poses, step_size=5e-3)
    assert list(runs["outcome"].values) == list(cases.values())
    assert list(forecast["outcome"].values) == list(cases.values())
    assert list(runs["launch"].values) == list(forecast["launch"].values) == [1, -1, 1, 1, 1, -1, 0, 0, 0, 0]
    assert (np.isfinite(runs["arrival_time"].values) == (runs["outcome"].values == "reached")).all()
    assert abs(runs["heading_error"].values[[4, 5]]) == pytest.approx([math.pi, math.pi], abs=0.02)


@pytest.mark.parametrize("P", [0.0, 0.1])
def test_forecast_is_what_the_simulation_does(P: float) -> None:
    """To 2 per cent, where the speed stays above 0.05 m/s: the launch ends up to a step late in simulation."""
    _, forecast, runs = both(24, P)
    regular = (forecast["minimum_speed"] > 0.05).values
    assert regular.sum() >= 15
    assert (forecast["outcome"].values == runs["outcome"].values)[regular].all()
    for name in ("minimum_speed", "peak_speed", "peak_forward_acceleration", "peak_yaw_acceleration"):
        assert runs[name].values[regular] == pytest.approx(forecast[name].values[regular], rel=0.02), name
    for name in ("position_error", "heading_error"):
        assert runs[name].values[regular] == pytest.approx(forecast[name].values[regular], abs=0.01), name
    table = an.outcome_table(forecast, runs)
    assert int(table.sum()) == 24
    assert dict(Counter(runs["outcome"].values)) == {
        name: count
        for name, count in zip(table["simulation"].values, table.sum("forecast").values, strict=True)
        if count
    }


def test_forecast_is_that_of_the_linearisation() -> None:
    """Linear law: the chains by matrix exponentials, and the singularity's distance of `br.forecast`."""
    poses = poses_of((3.0, -6.0, 2.0, 0.0), (-5.0, -4.0, -2.4, 0.0))
    found = an.goal_frame_forecast(poses)
    along, across = an.place(ALONG), an.place(ACROSS)
    for k, (x, y, theta) in enumerate(((3.0, -6.0, 2.0), (-5.0, -4.0, -2.4))):
        h = np.array([-math.sin(theta), math.cos(theta)])
        launched = [np.array([x, y]) + LAUNCH_SPEED**2 / (2 * LAUNCH_ACCELERATION) * h, LAUNCH_SPEED * h]
        launched.append(LAUNCH_ACCELERATION * h)
        predicted = br.forecast(
            br.blocks.robot_linearization(),
            [across, along],
            [[one[i] for one in launched] for i in (0, 1)],
            lambda _: [np.zeros(4), np.zeros(4)],
            15.0,
            samples=3001,
        )
        rising = np.flatnonzero(np.diff(predicted.distances) > 0)[-1]
        assert float(found["minimum_speed"][k]) == pytest.approx(predicted.distances[: rising + 2].min(), rel=1e-3)
        assert float(found["peak_speed"][k]) == pytest.approx(predicted.distances.max(), rel=1e-4)
        peaks = {str(symbol): peak for symbol, peak in predicted.peaks.items()}
        assert float(found["peak_yaw_acceleration"][k]) == pytest.approx(peaks["u_2"], rel=1e-2)


def test_robot_arrives_turned_where_the_launch_carries_it_too_far() -> None:
    poses = an.resting_poses(200)
    forecast = an.goal_frame_forecast(poses, step_size=0.02)
    far = starts_that_the_launch_carries_too_far(poses)
    outcomes = forecast["outcome"].values
    assert (outcomes == "reversed").sum() >= 10
    assert far[outcomes == "reversed"].all()
    assert set(outcomes[far]) <= {"reversed", "away", "singular"}
    assert (outcomes[~far] == "reached").mean() > 0.85


def test_guard_that_is_wide_makes_singular_starts_which_the_forecast_knows() -> None:
    poses = an.resting_poses(150, seed=1)
    wide = {"eta_min": 0.05}
    forecast = an.goal_frame_forecast(poses, parameters=wide, step_size=0.01)
    told = (forecast["outcome"] == "singular").values
    assert told.any()
    came = an.goal_frame_runs(poses.isel(pose=told), parameters=wide, step_size=5e-3)["outcome"].values
    assert (came == "singular").mean() > 0.8


@pytest.mark.slow
def test_driven_more_slowly_it_keeps_within_limits_on_the_same_path() -> None:
    poses, forecast, runs = both(24)
    limits = (0.5, 2.0, 30.0)
    rate = an.goal_frame_rate(forecast, limits)
    assert 0 < float(rate.min()) < 1
    assert float(rate.max()) <= 1
    slower = an.goal_frame_forecast(poses, rate=rate, t_end=2000.0, step_size=0.02)
    bound = rate < 1
    assert slower["peak_speed"].values == pytest.approx((forecast["peak_speed"] * rate).values, rel=1e-3)
    assert slower["minimum_speed"].values == pytest.approx((forecast["minimum_speed"] * rate).values, rel=0.02)
    assert (slower["peak_speed"] <= 0.5 * 1.001)[bound].all()
    pick = poses.isel(pose=[int(np.argmax((runs["outcome"] == "reached").values & bound.values))])
    again = an.goal_frame_runs(pick, rate=0.5, t_end=240.0, step_size=0.01)
    first = an.goal_frame_runs(pick, step_size=5e-3)
    assert float(again["arrival_time"][0]) > float(first["arrival_time"][0])
    assert float(again["peak_yaw_acceleration"][0]) == pytest.approx(
        float(first["peak_yaw_acceleration"][0]) / 4, rel=1e-6
    )


def test_what_cannot_be_used_is_refused() -> None:
    poses = an.resting_poses(2)
    for arguments, word in (
        ({"rate": 0.0}, "rate"),
        ({"rate": [1.0, 1.0, 1.0]}, "rate"),
        ({"limits": (1.0, 2.0)}, "limits"),
        ({"limits": (1.0, 2.0, -1.0)}, "limit"),
        ({"t_end": -1.0}, "t_end"),
        ({"parameters": {"eta": 1.0}}, "eta"),
    ):
        for function in (an.goal_frame_runs, an.goal_frame_forecast):
            with pytest.raises(ParameterError, match=word):
                function(poses, **arguments)
    with pytest.raises(ParameterError, match="goal_heading"):
        an.goal_frame_runs(poses.drop_vars("goal_heading"))
    with pytest.raises(ModelError, match="goal_frame_law"):
        an.goal_frame_runs(poses, br.blocks.sliding_mode())
    runs = an.goal_frame_forecast(poses, t_end=2.0)
    with pytest.raises(ParameterError, match="outcome"):
        an.outcome_table(runs, poses)
    with pytest.raises(ParameterError, match="same poses"):
        an.outcome_table(runs, runs.isel(pose=[0]))


@pytest.mark.slow
@pytest.mark.parametrize("P", [0.0, 0.1])
def test_a_thousand_poses(P: float) -> None:
    poses, forecast, runs = both(1000, P)
    outcomes = Counter(str(one) for one in runs["outcome"].values)
    assert 780 <= outcomes["reached"] <= 860
    assert (forecast["outcome"].values == runs["outcome"].values).mean() > 0.98
    for name in ("position_error", "heading_error", "peak_speed", "peak_yaw_acceleration"):
        assert np.isfinite(runs[name]).all()
    if P == 0.0:
        far = starts_that_the_launch_carries_too_far(poses)
        assert far[runs["outcome"].values == "reversed"].all()
        assert not far[runs["outcome"].values == "reached"].any()
