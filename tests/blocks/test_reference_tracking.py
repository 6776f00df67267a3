"""The robot follows the references: from a consistent start without error, from rest, and as FMU."""

from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from reference_cases import CASES, POINTS, TIMES, B

import brunovsky as br


def consistent_start(reference: br.Block, values: dict[str, float]) -> dict[str, float]:
    """Start of the robot on the reference, which moves there: its heading is that of the velocity."""
    data = br.simulate(reference, 1e-3, parameters=values)
    position, velocity, acceleration = (
        np.array([data[f"Z{i}d[{k}]"].values[0] for i in (1, 2)], dtype=float) for k in (1, 2, 3)
    )
    speed = np.hypot(*velocity)
    theta = np.arctan2(-velocity[0], velocity[1])
    along, across = np.array([-np.sin(theta), np.cos(theta)]), np.array([-np.cos(theta), -np.sin(theta)])
    return {
        "x_start": position[0], "y_start": position[1], "theta_start": theta, "eta_start[1]": speed,
        "eta_start[2]": across @ acceleration / speed, "u_start[1]": along @ acceleration,
    }  # fmt: skip


@pytest.mark.parametrize("engine", ["native", "numpy"])
@pytest.mark.parametrize("name", CASES)
def test_the_robot_follows_from_a_consistent_start(name: str, engine: str) -> None:
    make, values = CASES[name]
    loop = B.closed_loop(B.pole_placement(), reference=make())
    values = values | consistent_start(make(), values)
    data = br.simulate(
        loop,
        0.8 if engine == "numpy" else 2.4,
        parameters=values,
        engine=engine,
        step_size=2e-3,
        record=["e1[1]", "e2[1]", "eta[1]"],
    )  # type: ignore[arg-type]
    assert data["eta[1]"].min() > 0.1
    for one in ("e1[1]", "e2[1]"):
        assert abs(data[one]).max() < 1e-9


def test_points_between_need_not_lie_on_the_grid_of_steps() -> None:
    reference = B.waypoints(POINTS, [-0.8, 0.0, 1.30037, 2.00061, 3.3])
    loop = B.closed_loop(B.pole_placement(), reference=reference)
    data = br.simulate(loop, 2.4, parameters=consistent_start(reference, {}), record=["e1[1]", "e2[1]"])
    assert max(float(abs(data[one]).max()) for one in data) < 1e-9


@pytest.mark.parametrize("engine", ["native", "numpy"])
def test_the_robot_drives_from_rest_to_rest_on_a_line(engine: str) -> None:
    """Heading along the line, the sliding-mode loop starts at rest, arrives and stays, through the guard of the law."""
    theta = 0.6
    goal = 3.0 * np.array([-np.sin(theta), np.cos(theta)])
    values = {
        "x_start": 0.0, "theta_start": theta, "eta_start[1]": 0.0, "start_time": 0.3, "duration": 1.7,
        "end[1]": goal[0], "end[2]": goal[1],
    }  # fmt: skip
    data = br.simulate(B.closed_loop(reference=B.polynomial()), 2.2, parameters=values, engine=engine, step_size=2e-3)  # type: ignore[arg-type]
    assert max(abs(data[one]).max() for one in ("e1[1]", "e2[1]")) < 1e-9
    assert np.hypot(*(data[one].values[-1] for one in ("x", "y"))) == pytest.approx(3.0, abs=1e-9)
    assert data["eta[1]"].values[-1] == pytest.approx(0, abs=1e-9)
    assert abs(data["theta"] - theta).max() < 1e-9


def test_a_free_acceleration_is_a_regular_start_at_rest() -> None:
    """From rest on a curve, the robot starts as the reference accelerates: its error is that of the guard's width."""
    points = [[0.0, 0.0], [0.3, 1.0], [1.0, 1.8], [2.2, 2.0]]
    reference = B.waypoints(points, [0.0, 1.0, 2.0, 3.0], acceleration="free")
    data = br.simulate(reference, 1e-3)
    pull = np.array([data["Z1d[3]"].values[0], data["Z2d[3]"].values[0]])
    assert [data["zd3[1]"].values[0], data["zd3[2]"].values[0]] == pytest.approx([0, 0], abs=1e-12)
    start = {"x_start": 0.0, "eta_start[1]": 0.0, "theta_start": np.arctan2(-pull[0], pull[1])}
    errors = []
    for limit in (0.05, 0.01):
        values = start | {"u_start[1]": np.hypot(*pull), "eta_min": limit}
        data = br.simulate(
            B.closed_loop(B.pole_placement(), reference=reference), 2.9, parameters=values, step_size=1e-4
        )
        errors.append(float(np.hypot(data["e1[1]"], data["e2[1]"]).max()))
    assert errors[0] < 1e-3 and errors[1] < 0.2 * errors[0]


@pytest.mark.parametrize("version", [2, 3])
def test_as_fmu_waypoints_are_the_native_ones(version: int, tmp_path: Path) -> None:
    block = B.waypoints(POINTS[:4], TIMES[:4])
    fmu = br.export_fmu(block, tmp_path / "waypoints.fmu", fmi_version=version)  # type: ignore[arg-type]
    assert validate_fmu(str(fmu)) == []
    values = {"point[2,1]": 0.7}
    for kind in ("CoSimulation", "ModelExchange"):
        found = fmpy.simulate_fmu(
            str(fmu), fmi_type=kind, stop_time=3.0, output_interval=0.01, start_values=values, record_events=False
        )
        expected = br.simulate(block, 3.0, step_size=0.01, parameters=values)
        for one in expected:
            np.testing.assert_allclose(found[one], expected[one], atol=1e-12, err_msg=f"{kind} {one}")
