"""Tracking from rest: each reference is reached from elsewhere and tracked within the limits, and its rest is held."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from functools import cache

import numpy as np
import pytest
import xarray as xr

import brunovsky as br
from brunovsky.analysis import resting_poses
from brunovsky.blocks import TIME, Block, Input, Relation, symbol
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.errors import ModelError, ParameterError

B = br.blocks
LEG = "tracker.supervisor.leg"
RECORD = ["x", "y", "theta", "eta[1]", "eta[2]", "u[1]", "u[2]", "mode", "elapsed", "pace", "reference[1]",
          "reference[2]", LEG]  # fmt: skip
LIMITS = {"eta[1]": 1.5, "u[1]": 2.0, "u[2]": 30.0}
ELSEWHERE = {"x_start": -3.0, "y_start": 1.0, "theta_start": 2.5}
POINTS, TIMES = [[0.0, 0.0], [0.0, 2.0], [2.0, 3.0], [3.0, 1.0]], [0.0, 2.0, 5.0, 7.0]
SIDEWAYS = {"start_velocity[1]": 0.5, "start_velocity[2]": 0.1, "end[1]": 1.0}
slow = pytest.mark.slow


@cache
def loop(name: str) -> Block:
    makers: dict[str, Callable[[], Block]] = {
        "circle": B.circle,
        "lemniscate": B.lemniscate,
        "line": B.line,
        "polynomial": B.polynomial,
        "polynomial, free": lambda: B.polynomial(acceleration="free"),
        "waypoints": lambda: B.waypoints(POINTS, TIMES),
        "waypoints, free": lambda: B.waypoints(POINTS, TIMES, acceleration="free"),
        "there and back": lambda: B.waypoints([[0.0, 0.0], [0.0, 2.0], [0.0, 0.0]], [0.0, 3.0, 6.0]),
    }
    return B.rest_to_trajectory(makers[name]())


def run(name: str, time: float, inputs: Mapping[str, object] | None = None, **options: object) -> xr.Dataset:
    return br.simulate(loop(name), time, inputs=inputs, record=RECORD, **options)


def error(data: xr.Dataset) -> np.ndarray:
    return np.hypot(data["x"] - data["reference[1]"], data["y"] - data["reference[2]"]).values


def following(data: xr.Dataset) -> np.ndarray:
    return (data["mode"].values == 1) & (data[LEG].values == 2)


def check_limits(data: xr.Dataset, limits: Mapping[str, float] = LIMITS) -> None:
    for name, limit in limits.items():
        assert np.isfinite(data[name]).all()
        assert np.abs(data[name]).max() <= limit, name


def angle(value: float) -> float:
    return float((value + np.pi) % (2 * np.pi) - np.pi)


def check_tracked(data: xr.Dataset, since: float = 5.0) -> None:
    """Followed to the end of the run; within 1 mm all along, 10 um from some seconds on."""
    there = following(data)
    assert there[-1] and error(data)[there].max() < 1e-3
    begin = int(np.nonzero(~there)[0][-1]) + 1
    assert error(data)[begin:][data["time"].values[begin:] > data["time"].values[begin] + since].max() < 1e-5


@pytest.mark.parametrize(
    ("name", "values", "pace"),
    [
        ("circle", {}, 1.0),
        ("circle", {"rate": -0.5, "phase": 2.0}, 1.0),
        ("circle", {"rate": 3.0}, 0.95 * 1.5 / (3.0 * 2**0.5)),  # too fast: the speed is the limit
        pytest.param("lemniscate", {}, 1.0, marks=slow),
        pytest.param("lemniscate", {"phase": 1.0, "rate": 1.0}, None, marks=slow),
        pytest.param("line", {"heading": 0.7}, 1.0, marks=slow),
        pytest.param("line", {"speed": 3.0}, 0.95 * 1.5 / 3.0, marks=slow),
    ],
)
def test_a_reference_without_end_is_tracked_from_elsewhere(
    name: str, values: dict[str, float], pace: float | None
) -> None:
    data = run(name, 25.0, parameters=ELSEWHERE | values)
    check_limits(data)
    check_tracked(data)
    paces = np.unique(data["pace"].values[following(data)])
    assert len(paces) == 1 and paces[0] <= 1
    if pace is not None:
        assert paces[0] == pytest.approx(pace, rel=1e-9)
    slope = np.diff(data["elapsed"].values)[-1] / 1e-3  # the clock's rate, after its rise
    assert slope == pytest.approx(paces[0], rel=1e-6)


@pytest.mark.parametrize(
    ("name", "values", "end"),
    [
        pytest.param("waypoints", {}, (3.0, 1.0), marks=slow),
        pytest.param("waypoints, free", {}, (3.0, 1.0), marks=slow),
        pytest.param("polynomial", {}, (0.0, 2.0), marks=slow),
        ("polynomial", SIDEWAYS, (1.0, 2.0)),
        pytest.param("polynomial", {"start_time": 3.0, "duration": 1.0}, (0.0, 2.0), marks=slow),
        pytest.param("polynomial, free", {}, (0.0, 2.0), marks=slow),
    ],
)
def test_a_reference_that_stops_ends_at_rest_with_its_heading(
    name: str, values: dict[str, float], end: tuple[float, float]
) -> None:
    data = run(name, 25.0, parameters=ELSEWHERE | values)
    check_limits(data)
    there = following(data)
    assert there.any() and error(data)[there].max() < 1e-3
    modes = data["mode"].values
    assert modes[-1] == 0
    rest = data.isel(time=slice(int(np.nonzero(modes != 0)[0][-1]) + 1, None))
    assert float(rest["time"][0]) < 20.0  # and holds it
    assert np.hypot(rest["x"] - end[0], rest["y"] - end[1]).max() < 1e-4
    assert max(np.abs(rest[one]).max() for one in ("eta[1]", "eta[2]")) < 1e-2
    assert max(abs(float(rest[one][-1])) for one in ("eta[1]", "eta[2]")) < 1e-9
    path = np.array([data["reference[1]"], data["reference[2]"]])[:, there]
    late = path[:, np.hypot(path[0] - end[0], path[1] - end[1]) > 1e-3][:, -2:]
    tangent = np.arctan2(-np.diff(late[0]), np.diff(late[1]))[0]
    assert abs(angle(float(rest["theta"][-1]) - tangent)) < 0.05  # 1 mm before its end
    assert np.abs(rest["theta"] - rest["theta"][-1]).max() < 0.02


@slow
def test_a_reference_that_turns_back_is_left_and_met_again() -> None:
    data = run("there and back", 25.0, parameters=ELSEWHERE)
    check_limits(data)
    assert set(data["mode"].values) == {0, 1, 2}
    last = data.isel(time=-1)
    assert np.hypot(last["x"], last["y"]) < 1e-4
    assert abs(angle(float(last["theta"]) - np.pi)) < 1e-2
    assert abs(float(last["eta[1]"])) < 1e-9


def test_the_begin_of_a_reference_needs_no_drive() -> None:
    data = run("circle", 6.0, parameters={"x_start": 2**0.5})
    there = following(data)
    assert data["time"].values[there][0] < 0.05  # the examination
    assert error(data).max() < 1e-4
    check_limits(data)


def test_random_starts_reach_the_circle() -> None:
    poses = resting_poses(8, seed=3)
    for k in range(8):
        values = {name: float(poses[name][k]) for name in ("x_start", "y_start", "theta_start")}
        data = run("circle", 25.0, parameters=values | {"phase": float(poses["goal_heading"][k])})
        check_limits(data)
        check_tracked(data)


def test_tighter_limits_scale_the_time() -> None:
    limits = {"speed_limit": 0.3, "u_limit[1]": 0.2, "u_limit[2]": 0.5}
    data = run("circle", 60.0, parameters=ELSEWHERE | limits | {"rate": 1.0})
    check_limits(data, {"eta[1]": 0.3, "u[1]": 0.2, "u[2]": 0.5})
    check_tracked(data, 10.0)
    assert float(data["pace"][-1]) == pytest.approx(0.95 * 0.3 / 2**0.5, rel=1e-9)


def test_a_push_out_of_the_tube_comes_back_to_where_the_reference_stands() -> None:
    push = {"d[2]": lambda t: 100.0 if 12.0 <= t < 12.3 else 0.0}
    data = run("circle", 40.0, push, parameters=ELSEWHERE | {"tube": 0.02})
    modes = data["mode"].values
    assert {1, 2} <= set(modes[12_000:])
    assert error(data)[12_000:].max() > 0.02
    assert np.isfinite(data["u[2]"]).all()
    there, elapsed = following(data), data["elapsed"].values
    assert np.all(np.diff(elapsed) >= 0)
    lost = 12_000 + int(np.nonzero(~there[12_000:])[0][0])
    again = lost + int(np.nonzero(there[lost:])[0][0])
    assert elapsed[again] == elapsed[lost]  # the clock stood
    assert error(data)[-5000:].max() < 1e-5
    check_limits(data.isel(time=slice(again, None)))
    check_tracked(data.isel(time=slice(again - 1, None)))


@pytest.mark.parametrize("rho", [0.8, pytest.param(1.2, marks=slow)])
@pytest.mark.parametrize("law", [{}, pytest.param({"P": 0.5}, marks=slow)])
def test_disturbances_and_another_mass_do_not_keep_it_from_the_circle(rho: float, law: dict[str, float]) -> None:
    values = ELSEWHERE | {"rho[1]": rho, "rho[2]": rho} | law
    data = run("circle", 25.0, {"d[1]": 0.2, "d[2]": -0.2}, parameters=values)
    check_limits(data.isel(time=following(data)))
    assert following(data)[-1] and error(data)[following(data)].max() < 5e-3


@slow
def test_another_law_is_taken() -> None:
    tracker = B.tracker(B.circle(), B.pole_placement(gains=[[125.0, 75.0, 15.0]] * 2))
    data = br.simulate(B.rest_to_trajectory(tracker_block=tracker), 20.0, parameters=ELSEWHERE, record=RECORD)
    check_limits(data)
    check_tracked(data)
    with pytest.raises(ModelError, match="not both"):
        B.rest_to_trajectory(B.circle(), tracker_block=tracker)


def test_a_moving_robot_is_braked_first() -> None:
    data = run("circle", 25.0, parameters=ELSEWHERE | {"eta_start[1]": 1.0, "eta_start[2]": 2.0})
    modes = [int(one) for one, _ in itertools.groupby(data["mode"].values)]
    assert modes[0] == 2 and modes[-1] == 1
    check_limits(data)
    check_tracked(data)


@pytest.mark.parametrize("values", [{"radius": 0.0}, {"rate": 0.0}, {"speed_limit": 0.0}, {"u_limit[2]": 0.0}])
def test_what_cannot_be_tracked_is_refused_with_the_reason(values: dict[str, float]) -> None:
    reason = "must be positive: a robot that may not" if any("limit" in one for one in values) else "does not move"
    with pytest.raises(ParameterError, match=reason):
        run("circle", 1.0, parameters=values)


def test_references_without_heading_or_end_are_refused() -> None:
    switched = Block("late", outputs=ROBOT_CHAINS.reference((TIME, TIME)),
                     relations=(Relation("far", TIME**2 - 4.0),))  # fmt: skip
    driven = Block("driven", inputs=(Input("a", "m"),), outputs=ROBOT_CHAINS.reference((symbol("a"), TIME)))
    for reference, reason in (
        (B.set_point(), "rests for ever"),
        (switched, "does not switch at a given time"),
        (driven, "has inputs"),
        (B.pole_placement(), "has inputs"),
        (Block("nothing"), "has no outputs Z1d"),
        ("circle", "takes a Block"),
    ):
        with pytest.raises(ModelError, match=reason):
            B.tracker(reference)


@pytest.mark.slow
def test_numpy_and_c_agree() -> None:
    values = {"x_start": 2**0.5, "y_start": -0.01, "theta_start": 0.02}
    native, plain = (br.simulate(loop("circle"), 0.2, step_size=2e-3, parameters=values, record=RECORD, engine=engine)
                     for engine in ("native", "numpy"))  # fmt: skip
    assert following(native)[-1]
    for name in RECORD:
        np.testing.assert_allclose(native[name], plain[name], rtol=1e-9, atol=1e-11)
