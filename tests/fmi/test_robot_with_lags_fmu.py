"""The robot whose actuators lag, as FMU: the native simulation, in co-simulation and in model exchange."""

from pathlib import Path

import fmpy
import numpy as np
from fmpy.validation import validate_fmu

from brunovsky import blocks
from brunovsky.fmi import export_fmu
from brunovsky.native import simulate


def test_fmu_gives_the_native_simulation(tmp_path: Path) -> None:
    block = blocks.closed_loop(plant=blocks.robot_with_lags([0.004, 0.006], number=2), reference=blocks.line())
    start = {"x_start": 0.05, "eta_start[1]": 0.5, "P": 0.0}
    fmu = export_fmu(block, tmp_path / "robot_with_lags.fmu")
    assert validate_fmu(str(fmu)) == []
    names = ["x", "theta", "u[2]", "u_command[2]", "S[1]"]
    for kind, step, tolerance in (("CoSimulation", 1e-3, 1e-9), ("ModelExchange", 1e-4, 1e-4)):
        expected = simulate(block, 1.0, step_size=step, parameters=start)
        found = fmpy.simulate_fmu(
            str(fmu),
            fmi_type=kind,
            stop_time=1.0,
            output_interval=0.01,
            start_values=start,
            output=names,
            record_events=False,
            relative_tolerance=1e-8,
        )
        every = round(0.01 / step)
        for name in names:
            values = expected[name].values[::every]
            np.testing.assert_allclose(found[name], values, atol=tolerance * abs(values).max())
