"""FMUs of linearised plants of the literature give the numbers of the native simulation, in both interfaces."""

import sys
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

import brunovsky as br

sys.path.append(str(Path(__file__).parents[1] / "blocks"))
from gallery_blocks import GALLERY, gallery_block

CHOSEN = {
    "unicycle",  # one integrator
    "pvtol_flat_untouched",  # inputs transformed with the state
    "quadrotor",  # the largest
    "induction_motor",  # internal dynamics
    "ball_and_beam",  # internal dynamics, no relative degree at rest
}
TOLERANCES = {"CoSimulation": 1e-12, "ModelExchange": 1e-6}  # the same steps; CVODE with 1e-11

PLANTS = [one if one in CHOSEN else pytest.param(one, marks=pytest.mark.slow) for one in GALLERY]


@pytest.mark.parametrize("name", PLANTS)
def test_fmu_gives_the_numbers_of_the_native_simulation(name, exported):
    block, inputs = gallery_block(name)
    fmu = str(exported(block).fmu)
    assert validate_fmu(fmu) == []
    expected = br.simulate(block, 0.3, step_size=1e-3, inputs=inputs)
    columns = [(one, float) for one in ("time", *inputs)]
    signal = np.array([(time, *inputs.values()) for time in (0.0, 0.3)], dtype=columns)
    for interface, tolerance in TOLERANCES.items():
        found = fmpy.simulate_fmu(
            fmu,
            fmi_type=interface,
            stop_time=0.3,
            output_interval=0.01,
            relative_tolerance=1e-11,
            input=signal,
            record_events=False,
        )
        np.testing.assert_allclose(found["time"], expected["time"].values[::10], atol=1e-12)
        for one in block.outputs:
            wanted = expected[one.name].values[::10]
            scale = np.max(np.abs(wanted)) + 1e-3
            np.testing.assert_allclose(found[one.name], wanted, rtol=0, atol=tolerance * scale, err_msg=one.name)
