"""The closed loop from rest to rest as FMU: the same modes and values as the native simulation."""

from __future__ import annotations

from pathlib import Path

import fmpy
import numpy as np
import pytest

import brunovsky as br

START = {"x_start": -1.0, "y_start": -1.5, "theta_start": 0.4, "goal[1]": 0.0, "goal[2]": 0.0, "goal_heading": -0.5}
RECORD = ["x", "y", "theta", "eta[1]", "eta[2]", "u[1]", "u[2]", "mode"]


@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
def test_the_fmu_drives_as_the_native_simulation_does(tmp_path: Path, version: int) -> None:
    block = br.blocks.rest_to_rest()
    path = br.export_fmu(block, tmp_path / "rest_to_rest.fmu", fmi_version=version)
    assert fmpy.validation.validate_fmu(str(path)) == []
    native = br.simulate(block, 8.0, parameters=START, record=RECORD)
    assert set(native["mode"].values) == {0, 1}
    result = fmpy.simulate_fmu(str(path), fmi_type="CoSimulation", stop_time=8.0, step_size=1e-3, output_interval=1e-3,
                               start_values=START, output=RECORD)  # fmt: skip
    assert len(result["time"]) == len(native["time"])
    changes = native["mode"].values != result["mode"]  # simulate records after an instant's transitions, an FMU before
    assert changes.sum() <= 2
    for name in RECORD:
        np.testing.assert_allclose(result[name][~changes], native[name][~changes], rtol=1e-12, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
def test_model_exchange_arrives_too(tmp_path: Path, version: int) -> None:
    block = br.blocks.rest_to_rest()
    path = br.export_fmu(block, tmp_path / "rest_to_rest.fmu", fmi_version=version)
    result = fmpy.simulate_fmu(str(path), fmi_type="ModelExchange", stop_time=8.0, output_interval=0.01,
                               relative_tolerance=1e-8, start_values=START, output=RECORD)  # fmt: skip
    assert result["mode"][-1] == 0
    assert abs(result["x"][-1]) < 1e-3 and abs(result["y"][-1]) < 1e-3
    assert abs(result["theta"][-1] + 0.5) < 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", ["regulator", "rest_to_rest"])
def test_every_check_passes(tmp_path: Path, name: str, version: int) -> None:
    report = br.check_fmu(br.export_fmu(getattr(br.blocks, name)(), tmp_path / f"{name}.fmu", fmi_version=version))
    assert report.passed, report.failed


@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
def test_what_no_plan_can_keep_is_refused_by_the_fmu_too(tmp_path: Path, version: int) -> None:
    path = br.export_fmu(br.blocks.rest_to_rest(), tmp_path / "rest_to_rest.fmu", fmi_version=version)
    messages: list[str] = []
    with pytest.raises(fmpy.fmi1.FMICallException):
        fmpy.simulate_fmu(str(path), fmi_type="CoSimulation", stop_time=0.01, start_values={"observer_rate": 0.0},
                          logger=lambda *arguments: messages.append(str(arguments[-1])))  # fmt: skip
    assert any("observer_rate must be at least 0.1 1/s" in one for one in messages)
