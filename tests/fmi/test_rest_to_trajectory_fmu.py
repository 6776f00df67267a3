"""Tracking from rest as FMU: the same values as the native simulation, and a stop in model exchange."""

from __future__ import annotations

from pathlib import Path

import fmpy
import numpy as np
import pytest

import brunovsky as br

RECORD = ["x", "y", "theta", "eta[1]", "eta[2]", "u[1]", "u[2]", "mode", "elapsed", "pace"]


@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
def test_the_fmu_tracks_as_the_native_simulation_does(tmp_path: Path, version: int) -> None:
    block = br.blocks.rest_to_trajectory(br.blocks.lemniscate())
    path = br.export_fmu(block, tmp_path / "rest_to_trajectory.fmu", fmi_version=version)
    assert fmpy.validation.validate_fmu(str(path)) == []
    start = {"x_start": 1.0, "y_start": -1.0, "theta_start": 0.4}
    native = br.simulate(block, 8.0, parameters=start, record=RECORD)
    assert float(native["pace"][-1]) == pytest.approx(1.0, rel=1e-12)
    result = fmpy.simulate_fmu(str(path), fmi_type="CoSimulation", stop_time=8.0, step_size=1e-3, output_interval=1e-3,
                               start_values=start, output=RECORD)  # fmt: skip
    assert len(result["time"]) == len(native["time"])
    same = (native["mode"].values == result["mode"]) & (native["pace"].values == result["pace"])
    assert (~same).sum() <= 3  # simulate records after an instant's transitions, an FMU before
    for name in RECORD:
        np.testing.assert_allclose(result[name][same], native[name][same], rtol=1e-12, atol=1e-12)


@pytest.mark.slow
def test_a_reference_that_stops_is_held_in_model_exchange(tmp_path: Path) -> None:
    block = br.blocks.rest_to_trajectory(br.blocks.polynomial())
    path = br.export_fmu(block, tmp_path / "rest_to_trajectory.fmu", fmi_version=2)
    result = fmpy.simulate_fmu(str(path), fmi_type="ModelExchange", stop_time=12.0, output_interval=0.01,
                               relative_tolerance=1e-8, start_values={"x_start": 0.5, "y_start": -1.5}, output=RECORD,
                               )  # fmt: skip
    assert result["mode"][-1] == 0
    assert abs(result["x"][-1]) < 1e-3 and abs(result["y"][-1] - 2.0) < 1e-3
    assert abs(result["theta"][-1]) < 1e-3 and abs(result["eta[1]"][-1]) < 1e-6
