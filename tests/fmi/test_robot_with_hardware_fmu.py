"""The robot behind sensors and actuators, all effects on, as FMU of both versions: the native simulation."""

from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

from brunovsky import blocks
from brunovsky.fmi import export_fmu
from brunovsky.native import simulate


@pytest.mark.parametrize("version", [2, 3])
def test_fmu_gives_the_native_simulation(tmp_path: Path, version: int) -> None:
    plant = blocks.robot_with_hardware(
        lags=[0.002, 0.003], number=2, delays=[0.004, 0.006], limits=[1.0, 20.0], period=0.002, noisy=True, matched=True
    )
    block = blocks.closed_loop(plant=plant, reference=blocks.line())
    start = {"x_start": 0.05, "eta_start[1]": 0.5, "P": 2.5}
    fmu = export_fmu(block, tmp_path / "robot_with_hardware.fmu", fmi_version=version)
    assert validate_fmu(str(fmu)) == []
    times = np.arange(501) * 1e-3
    rng = np.random.default_rng(5)
    series = {f"n[{i}]": 1e-3 * rng.standard_normal(len(times)) for i in range(1, 6)}
    series |= {"d[1]": 0.1 * np.sin(9 * times), "dv[2]": np.where(times > 0.2, 1.0, 0.0)}
    expected = simulate(block, 0.5, parameters=start, inputs=series)
    assert float(abs(expected["u[2]"]).max()) == 20.0
    names = ["x", "y", "theta", "eta[1]", "eta[2]", "position_error[1]", "u[1]", "u[2]", "u_command[1]", "Z1[3]"]
    table = np.zeros(len(times), dtype=[("time", float), *((name, float) for name in series)])
    table["time"] = times
    for name, values in series.items():
        table[name] = values
    found = fmpy.simulate_fmu(
        str(fmu),
        fmi_type="CoSimulation",
        stop_time=0.5,
        output_interval=1e-3,
        start_values=start,
        input=table,
        output=names,
        record_events=False,
    )
    between = slice(1, None, 2)  # at a sample an FMU shows what was before it
    for name in names:
        values = expected[name].values
        rows = slice(None) if name in names[:5] else between
        np.testing.assert_allclose(found[name][rows], values[rows], atol=1e-9 * abs(values).max(), err_msg=name)
