"""Poles in the frame of the goal: the law against equations typed by hand, and the manoeuvre's modes."""

import math
from functools import cache

import numpy as np
import pytest
import xarray as xr

import brunovsky as br
from brunovsky.errors import ModelError, ParameterError

B = br.blocks
FAR = {"x_start": 3.0, "y_start": -6.0, "theta_start": 0.7}


@cache
def manoeuvre(P: float = 0.0) -> br.Diagram:
    return B.goal_frame_manoeuvre(B.goal_frame_law(P=P))


def outputs_at(block: br.Block, inputs: dict[str, float], parameters: dict[str, float]) -> dict[str, float]:
    data = br.simulate(block, 1.0, step_size=1.0, inputs=inputs, parameters=parameters, engine="numpy")
    return {name: float(data[name][0]) for name in data}


@pytest.mark.parametrize(("P", "phi"), [(0.0, 0.05), (0.4, 0.05), (0.4, 1e4)])
def test_law_is_that_of_equations_typed_by_hand(P: float, phi: float) -> None:
    law = B.goal_frame_law((-0.1, -0.4, -0.7), (-0.5, -0.8, -0.9), P=P, phi=phi)
    random = np.random.default_rng(3)
    for _ in range(3):
        z, zd, jerk, g = random.normal(size=(2, 3)), random.normal(size=(2, 3)), random.normal(size=2), random.normal()
        inputs = {f"Z{i + 1}[{k + 1}]": z[i, k] for i in (0, 1) for k in range(3)}
        inputs |= {f"Z{i + 1}d[{k + 1}]": zd[i, k] for i in (0, 1) for k in range(3)}
        found = outputs_at(law, inputs | {"zd3[1]": jerk[0], "zd3[2]": jerk[1]}, {"goal_heading": g})
        frame = np.array([[-math.sin(g), math.cos(g)], [-math.cos(g), -math.sin(g)]])
        error = frame @ (z - zd)
        wanted = []
        for e, (first, second, third) in zip(error, ((0.1, 0.4, 0.7), (0.5, 0.8, 0.9)), strict=True):
            s = first * second * e[0] + (first + second) * e[1] + e[2]
            wanted.append(-third * s - P * np.clip(s / phi, -1, 1) - first * second * e[1] - (first + second) * e[2])
        assert [found["v[1]"], found["v[2]"]] == pytest.approx(frame.T @ wanted + jerk)


def test_law_regulates_in_the_usual_loop_and_arrives_along_the_heading() -> None:
    loop = B.closed_loop(B.goal_frame_law(), reference=B.set_point())
    start = {"x_start": -1.0, "y_start": -4.0, "eta_start[1]": 0.5, "target[1]": 1.0, "target[2]": 2.0}
    data = br.simulate(loop, 30.0, parameters=start | {"goal_heading": -0.4, "eta_min": 1e-3})
    error = np.array([data["e1[1]"][-1], data["e2[1]"][-1]])
    assert 0.01 < np.linalg.norm(error) < 1.0
    assert error / np.linalg.norm(error) == pytest.approx([math.sin(-0.4), -math.cos(-0.4)], abs=0.01)
    assert float(data["theta"][-1]) == pytest.approx(-0.4, abs=0.01)


@pytest.mark.parametrize(
    ("along", "across", "word"),
    [
        ((-0.5, -0.1, -0.6), (-0.5, -0.6, -0.7), "not the slowest"),
        ((-0.1, -0.5, -0.6), (-0.05, -0.6, -0.7), "not the slowest"),
        ((-0.1, -0.5), (-0.5, -0.6, -0.7), "three negative poles"),
        ((0.1, -0.5, -0.6), (-0.5, -0.6, -0.7), "three negative poles"),
    ],
)
def test_poles_that_do_not_make_the_path_tangent_are_refused(along: tuple, across: tuple, word: str) -> None:
    with pytest.raises(ParameterError, match=word):
        B.goal_frame_law(along, across)


def test_poles_that_are_no_numbers_are_refused() -> None:
    with pytest.raises(ModelError, match="along"):
        B.goal_frame_law((-0.1, -0.5, math.nan))
    with pytest.raises(ModelError, match="across"):
        B.goal_frame_law(across=(-0.5, -0.6, -0.7 + 1j))  # type: ignore[arg-type]


@pytest.mark.parametrize("P", [0.0, 0.1])
def test_manoeuvre_launches_tracks_parks_and_rests_at_the_goal(P: float) -> None:
    data = br.simulate(manoeuvre(P), 120.0, step_size=5e-3, parameters=FAR)
    mode = data["mode"].values
    assert set(np.diff(mode)) == {0, 1}, "modes follow each other"
    assert mode[0] == 1
    assert mode[-1] == 3
    launching = data.isel(time=mode == 1)
    assert abs(launching["u[1]"] - 0.3).max() == 0
    assert abs(launching["u[2]"]).max() == 0
    last = data.isel(time=-1)
    assert math.hypot(last["x"], last["y"]) < 5e-3
    assert abs(float(last["theta"])) < 0.02
    assert max(abs(float(last["eta[1]"])), abs(float(last["eta[2]"]))) < 1e-3


def test_robot_ahead_of_the_goal_backs_into_it() -> None:
    ahead = {"x_start": -3.0, "y_start": 6.0, "theta_start": 0.7}
    backward, forward = (br.simulate(manoeuvre(), 120.0, step_size=5e-3, parameters=one) for one in (ahead, FAR))
    assert float(backward["eta[1]"].max()) < 1e-9
    for name in ("x", "y", "eta[1]", "u[1]"):  # the mirror image, driven the other way round
        assert backward[name].values == pytest.approx(-forward[name].values, abs=1e-9)
    assert backward["theta"].values == pytest.approx(forward["theta"].values, abs=1e-9)


def test_goal_may_be_anywhere() -> None:
    goal, turn = np.array([2.0, -1.0]), 1.1
    start = goal + np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]]) @ (3.0, -6.0)
    moved = {"goal[1]": goal[0], "goal[2]": goal[1], "goal_heading": turn}
    moved |= {"x_start": start[0], "y_start": start[1], "theta_start": 0.7 + turn}
    there, here = (br.simulate(manoeuvre(), 60.0, step_size=5e-3, parameters=one) for one in (moved, FAR))
    for name in ("eta[1]", "eta[2]", "u[1]", "u[2]"):
        assert there[name].values == pytest.approx(here[name].values, abs=1e-9)


def test_robot_at_the_goal_stays() -> None:
    data = br.simulate(manoeuvre(), 1.0, parameters={"x_start": 0.01, "theta_start": 2.0})
    assert set(data["mode"].values) == {3}
    assert float(abs(data["x"] - 0.01).max()) == 0


def test_parking_goes_on_with_the_slow_mode_of_the_law() -> None:
    values = B.goal_frame_manoeuvre(B.goal_frame_law((-0.2, -0.9, -1.0), (-0.7, -0.8, -1.1))).parameter_values()
    assert values["brake[1]"] == pytest.approx(0.2)
    assert values["brake[2]"] == pytest.approx(1.1)
    assert values["park_speed"] == pytest.approx(1.25 * 0.2 * values["park_distance"])


def test_manoeuvre_of_another_law_is_refused() -> None:
    with pytest.raises(ModelError, match="goal_heading"):
        B.goal_frame_manoeuvre(B.sliding_mode())


def test_engines_agree_through_all_modes() -> None:
    def run(engine: str) -> xr.Dataset:
        options = {"park_distance": 3.0, "park_speed": 0.5}
        return br.simulate(
            B.goal_frame_manoeuvre(),
            20.0,
            step_size=0.02,
            parameters=FAR | options,
            engine=engine,  # type: ignore
        )

    native, numpy = run("native"), run("numpy")
    assert set(native["mode"].values) == {1, 2, 3}
    for name in native:
        assert native[name].values == pytest.approx(numpy[name].values, rel=1e-9, abs=1e-9)
