"""FMU Manipulation Toolbox: its checks of the FMUs that ship, and robot.ssp as one FMU, made by the example.

The container steps its three FMUs at once and holds inputs, so the bound is that of ``coupling_error_bound``.
"""

import subprocess
import sys
from pathlib import Path

import fmpy
import numpy as np
import pytest

import brunovsky as br
from brunovsky import analysis
from brunovsky.fmi import export_ssp, robot_system, robot_variants, shipped_block, shipped_fmus

pytest.importorskip("fmu_manipulation_toolbox")
EXAMPLE = Path(__file__).parents[2] / "fmu" / "examples" / "run_container.py"
IN_CI = {("closed_loop", 2), ("linearized_robot", 3), ("sliding_mode_clocked", 3)}
SHIPPED = [
    pytest.param(name, version, marks=() if (name, version) in IN_CI else pytest.mark.slow)
    for version in (2, 3)
    for name in shipped_fmus(version)
]
STEP = 1e-3


def done(*command: object) -> str:
    process = subprocess.run([sys.executable, *map(str, command)], capture_output=True, text=True, timeout=100)
    assert process.returncode == 0, process.stdout + process.stderr
    return process.stdout + process.stderr


@pytest.mark.parametrize(("name", "version"), SHIPPED)
def test_it_finds_no_fault(name: str, version: int, tmp_path: Path) -> None:
    fmu = br.export_fmu(shipped_block(name), tmp_path / f"{name}.fmu", fmi_version=version)
    said = done("-m", "fmu_manipulation_toolbox.cli.fmutool", "-input", fmu, "-check")
    assert f"compliant with FMI-{version}.0" in said
    assert f"No semantic error against the FMI-{version} standard" in said
    assert "ERROR" not in said


def test_the_system_as_one_fmu(tmp_path: Path) -> None:
    variants = robot_variants()
    package = export_ssp(robot_system(), tmp_path / "robot.ssp", variants=variants)
    done(EXAMPLE, package, tmp_path / "figure6.fmu")
    found = fmpy.simulate_fmu(
        tmp_path / "figure6.fmu", stop_time=1.0, output_interval=STEP, output=["x", "y"], fmi_type="CoSimulation"
    )
    native = br.simulate(br.blocks.closed_loop(), 1.0, step_size=STEP, parameters=dict(variants[0].parameters))
    gain = analysis.sliding_gain([500.0, 10.0, 1.0], 5.0)
    for z, v in (("x", "v[1]"), ("y", "v[2]")):
        bound = analysis.coupling_error_bound(native["time"], native[v].values, gain, STEP)
        error = np.abs(found[z] - native[z].values)
        assert 0.1 * bound.max() < error.max() < bound.max()
