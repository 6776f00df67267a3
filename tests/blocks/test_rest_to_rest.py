"""The regulator from rest to rest: every goal is reached within the limits, and every mode is entered and left."""

from __future__ import annotations

import itertools
from collections.abc import Mapping

import numpy as np
import pytest
import xarray as xr

import brunovsky as br
from brunovsky.analysis import resting_poses
from brunovsky.blocks import Block
from brunovsky.errors import ParameterError
from brunovsky.native import NativeEngine

RECORD = ["x", "y", "theta", "eta[1]", "eta[2]", "u[1]", "u[2]", "mode"]
AT_ORIGIN = {"goal[1]": 0.0, "goal[2]": 0.0}
HOLD = 10.0
LIMITS = {"eta[1]": 1.5, "u[1]": 2.0, "u[2]": 30.0}


@pytest.fixture(scope="module")
def loop() -> Block:
    return br.blocks.rest_to_rest()


def run(loop: Block, time: float, inputs: Mapping[str, object] | None = None, **values: float) -> xr.Dataset:
    parameters = AT_ORIGIN | {"goal_heading": 0.0} | {key.replace("__", "_"): one for key, one in values.items()}
    return br.simulate(loop, time, parameters=parameters, inputs=inputs, record=RECORD)


def angle(values: np.ndarray) -> np.ndarray:
    return (values + np.pi) % (2 * np.pi) - np.pi


def arrival(data: xr.Dataset, heading: float = 0.0, goal: tuple[float, float] = (0.0, 0.0)) -> float:
    """Time from which the robot rests at the goal, within 5 mm, 0.02 rad, 1 mm/s, 1 mrad/s; else infinity."""
    there = np.hypot(data["x"] - goal[0], data["y"] - goal[1]).values < 5e-3
    there &= np.abs(angle(data["theta"].values - heading)) < 0.02
    there &= (np.abs(data["eta[1]"].values) < 1e-3) & (np.abs(data["eta[2]"].values) < 1e-3)
    away = np.nonzero(~there)[0]
    if not len(away):
        return 0.0
    return float(data["time"][away[-1] + 1]) if away[-1] + 1 < len(there) else np.inf


def check_limits(data: xr.Dataset) -> None:
    for name, limit in LIMITS.items():
        assert np.isfinite(data[name]).all()
        assert np.abs(data[name]).max() <= limit, name


def modes(data: xr.Dataset) -> list[int]:
    values = data["mode"].values
    return [int(values[0]), *(int(b) for a, b in itertools.pairwise(values) if a != b)]


def check_poses(loop: Block, number: int, seed: int) -> np.ndarray:
    """Arrival times over random resting poses, each held to the end of the run within all limits."""
    poses, times = resting_poses(number, seed=seed), []
    for k in range(number):
        start = {name: float(poses[name][k]) for name in ("x_start", "y_start", "theta_start", "goal_heading")}
        data = run(loop, 20.0 + HOLD, **start)
        check_limits(data)
        times.append(arrival(data, start["goal_heading"]))
        assert times[-1] <= 20.0, start
    return np.array(times)


def bang_bang(poses: xr.Dataset) -> np.ndarray:
    """Least times of a turn in place, a straight drive and a turn, forward or backward, under the same limits."""
    x, y = poses["x_start"].values, poses["y_start"].values
    distance, speed, acceleration = np.hypot(x, y), LIMITS["eta[1]"], LIMITS["u[1]"]
    cruising = distance > speed**2 / acceleration
    drive = np.where(cruising, distance / speed + speed / acceleration, 2 * np.sqrt(distance / acceleration))
    bearing = np.arctan2(x, -y)

    def turns(way: np.ndarray) -> np.ndarray:
        first, last = angle(way - poses["theta_start"].values), angle(poses["goal_heading"].values - way)
        return 2 * (np.sqrt(np.abs(first) / LIMITS["u[2]"]) + np.sqrt(np.abs(last) / LIMITS["u[2]"]))

    return drive + np.minimum(turns(bearing), turns(bearing + np.pi))


def test_random_poses_are_reached_within_all_limits_and_held(loop: Block) -> None:
    times = check_poses(loop, 10, seed=1)
    assert np.median(times) <= 1.5 * np.median(bang_bang(resting_poses(10, seed=1)))


@pytest.mark.slow
def test_a_thousand_random_poses_are_reached(loop: Block) -> None:
    times = check_poses(loop, 1000, seed=0)
    assert np.median(times) <= 1.25 * np.median(bang_bang(resting_poses(1000, seed=0)))


@pytest.mark.parametrize(
    ("start", "heading", "passed"),
    [
        ((0.0, -3.0, 0.0), 0.0, [1, 0]),  # straight ahead
        ((0.0, 3.0, 0.0), 0.0, [1, 0]),  # straight behind
        ((3.0, 0.0, 0.0), 0.0, [1, 0]),  # exactly beside
        ((0.0, -3.0, 0.0), np.pi, [1, 0]),  # ahead, the other way round
    ],
)
def test_special_goals(loop: Block, start: tuple[float, float, float], heading: float, passed: list[int]) -> None:
    x, y, theta = start
    data = run(loop, 12.0, x_start=x, y_start=y, theta_start=theta, goal_heading=heading)
    check_limits(data)
    assert arrival(data, heading) < 10.0
    assert modes(data)[-1] == passed[-1] and set(modes(data)) <= set(passed)


def test_a_straight_goal_needs_no_turn(loop: Block) -> None:
    data = run(loop, 6.0, y_start=-3.0)
    assert np.abs(data["x"]).max() < 1e-9 and np.abs(data["theta"]).max() < 1e-9


def test_a_goal_equal_to_the_start_is_rest(loop: Block) -> None:
    data = run(loop, 1.0)
    assert modes(data) == [0]
    assert np.abs(data["x"]).max() == 0 and np.abs(data["u[1]"]).max() == 0


def test_another_heading_at_the_same_place_is_a_turn(loop: Block) -> None:
    data = run(loop, 3.0, goal_heading=3.0)
    check_limits(data)
    assert modes(data) == [1, 0]
    assert arrival(data, 3.0) < 1.5
    assert np.hypot(data["x"], data["y"]).max() < 1e-6


def test_a_near_goal_to_the_side_is_reached(loop: Block) -> None:
    data = run(loop, 12.0, x_start=0.02, theta_start=0.3)
    check_limits(data)
    assert arrival(data) < 10.0


def test_a_goal_that_changes_while_moving_is_reached(loop: Block) -> None:
    engine = NativeEngine(loop)
    engine.set_parameters({"goal[1]": 0.0, "goal[2]": 4.0})
    engine.initialize()
    seen = set()
    for k in range(16_000):
        if k == 2000:
            engine.set_parameters({"goal[1]": -2.0, "goal[2]": 1.0, "goal_heading": 2.0})
        engine.advance(1e-3)
        outputs = dict(zip((one.name for one in loop.outputs), engine.outputs(), strict=True))
        seen.add(outputs["mode"])
        assert all(abs(outputs[name]) <= limit for name, limit in LIMITS.items())
    assert seen == {0, 1, 2}
    assert np.hypot(outputs["x"] + 2.0, outputs["y"] - 1.0) < 5e-3
    assert abs(angle(np.array(outputs["theta"] - 2.0))) < 0.02
    assert abs(outputs["eta[1]"]) < 1e-3 and abs(outputs["eta[2]"]) < 1e-3


def check_disturbed(loop: Block, number: int, seed: int) -> None:
    """All arrive within all limits under the largest disturbances and errors of mass and inertia."""
    poses, rng = resting_poses(number, seed=seed), np.random.default_rng(seed)
    for k in range(number):
        start = {name: float(poses[name][k]) for name in ("x_start", "y_start", "theta_start", "goal_heading")}
        wrong = {f"rho[{i}]": float(rng.choice([0.8, 1.2])) for i in (1, 2)}
        pushes = {f"d[{i}]": float(rng.choice([-0.2, 0.2])) for i in (1, 2)}
        data = br.simulate(loop, 20.0, parameters=AT_ORIGIN | start | wrong, inputs=pushes, record=RECORD)
        check_limits(data)
        assert arrival(data, start["goal_heading"]) <= 20.0, (start, wrong, pushes)


def test_disturbed_poses_are_reached_within_all_limits(loop: Block) -> None:
    check_disturbed(loop, 4, seed=2)


@pytest.mark.slow
def test_a_hundred_disturbed_poses_are_reached_within_all_limits(loop: Block) -> None:
    check_disturbed(loop, 100, seed=0)


@pytest.mark.parametrize("rho", [0.8, 1.2])
@pytest.mark.parametrize("law", [{}, {"P": 0.5}])
def test_disturbances_and_another_mass_do_not_keep_it_from_the_goal(
    loop: Block, rho: float, law: dict[str, float]
) -> None:
    start = {"x_start": -3.0, "y_start": -4.0, "theta_start": 1.0, "goal_heading": 0.5}
    values = start | {"rho[1]": rho, "rho[2]": rho} | law
    data = br.simulate(loop, 25.0, parameters=AT_ORIGIN | values, inputs={"d[1]": 0.2, "d[2]": -0.2}, record=RECORD)
    check_limits(data)
    assert arrival(data, 0.5) < 15.0


def test_a_push_out_of_the_tube_is_braked_and_planned_anew(loop: Block) -> None:
    data = run(loop, 25.0, {"d[2]": lambda t: 25.0 if 2.0 <= t < 2.4 else 0.0}, y_start=-5.0)
    assert 2 in modes(data)
    assert arrival(data) < 20.0
    assert np.isfinite(data["u[2]"]).all()


def test_a_moving_robot_is_braked_before_it_plans(loop: Block) -> None:
    data = br.simulate(loop, 15.0, parameters=AT_ORIGIN | {"y_start": -3.0, "eta_start[1]": 1.0, "eta_start[2]": 2.0},
                       record=RECORD)  # fmt: skip
    assert modes(data)[0] == 2
    check_limits(data)
    assert arrival(data) < 12.0


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"speed_limit": 0.0}, "may not move"),
        ({"u_limit[1]": 0.0}, "may not accelerate"),
        ({"u_limit[2]": 0.0}, "may not turn"),
        ({"u_limit[2]": 1.8e-3}, "half a turn in place takes more than 120 s; raise u_limit"),
        ({"u_limit[2]": 6e-3, "reserve": 0.9}, "half a turn in place .* lower reserve"),
        ({"u_limit[1]": 0.02}, "takes more than 120 s to reach speed_limit; raise u_limit"),
        ({"speed_limit": 0.1}, "eta_min must be less than the 95 % of speed_limit .* lower eta_min"),
        ({"tolerance": 1e-5}, "tolerance must be at least 0.0001 m"),
        ({"tube": 0.002}, "tube must be greater than tolerance"),
        ({"hold_rate": 0.0}, "hold_rate must be at least 0.1 1/s"),
        ({"observer_rate": 0.0}, "observer_rate must be at least 0.1 1/s"),
        ({"reserve": 0.95}, "reserve = 0.95 .* from 0 to 0.9"),
    ],
)
def test_what_no_plan_can_keep_is_refused_with_the_reason(loop: Block, values: dict[str, float], reason: str) -> None:
    with pytest.raises(ParameterError, match=reason):
        br.simulate(loop, 0.01, parameters=values)


@pytest.mark.parametrize(
    "values",
    [
        {"u_limit[2]": 2.0e-3},
        {"u_limit[1]": 0.03},
        {"speed_limit": 0.1, "eta_min": 0.09},
        {"tolerance": 1e-4, "tube": 1.1e-4},
        {"hold_rate": 0.1, "observer_rate": 0.1},
    ],
)
def test_what_a_plan_can_just_keep_is_not_refused(loop: Block, values: dict[str, float]) -> None:
    assert np.isfinite(br.simulate(loop, 0.01, parameters=values)["u[2]"]).all()


def test_tighter_limits_scale_the_time(loop: Block) -> None:
    values = {"speed_limit": 0.3, "u_limit[1]": 0.2, "u_limit[2]": 2.0}
    data = run(loop, 40.0, x_start=2.0, y_start=-2.0, **values)
    assert arrival(data) < 30.0
    assert np.abs(data["eta[1]"]).max() <= 0.3
    assert np.abs(data["u[1]"]).max() <= 0.2
    assert np.abs(data["u[2]"]).max() <= 2.0


@pytest.mark.slow  # the engines agree at each transition in test_rest_to_rest_transitions.py
def test_numpy_and_c_agree(loop: Block) -> None:
    values = AT_ORIGIN | {"x_start": 0.5, "y_start": -0.5, "goal_heading": 0.4}
    native, plain = (br.simulate(loop, 0.3, step_size=2e-3, parameters=values, record=RECORD, engine=engine)
                     for engine in ("native", "numpy"))  # fmt: skip
    assert set(native["mode"].values) == {1}
    for name in RECORD:
        np.testing.assert_allclose(native[name], plain[name], rtol=1e-9, atol=1e-11)
