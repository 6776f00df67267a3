"""FMUs of FMI 3 run as those of FMI 2 and as the native simulation, in both interfaces."""

import sys
from collections.abc import Callable
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

import brunovsky as br
from brunovsky.blocks import library
from brunovsky.fmi import shipped_block, shipped_fmus

sys.path.append(str(Path(__file__).parents[1] / "blocks"))
from gallery_blocks import gallery_block

KINDS = {"CoSimulation": 1e-12, "ModelExchange": 1e-9}
"""Tolerances between the two versions: the same steps, and the same solver of the master."""


def _run(fmu: Path, kind: str, starts: dict[str, float], stop: float = 0.5, **options: object) -> np.ndarray:
    return fmpy.simulate_fmu(
        str(fmu),
        fmi_type=kind,
        stop_time=stop,
        output_interval=0.01,
        relative_tolerance=1e-10,
        record_events=False,
        start_values=starts,
        **options,
    )


@pytest.mark.parametrize("name", shipped_fmus(2))
def test_every_fmu_that_ships_runs_as_in_fmi_2(name: str, exported: Callable) -> None:
    block = shipped_block(name)
    second, third = exported(block), exported(block, 3)
    assert validate_fmu(str(third.fmu)) == []
    inputs = {one.name: 0.01 * (k + 1) for k, one in enumerate(block.inputs)}
    native = br.simulate(block, 0.5, inputs=inputs)
    for kind, tolerance in KINDS.items():
        if name == "super_twisting" and kind == "ModelExchange":  # has none
            continue
        expected, found = (_run(one.fmu, kind, inputs) for one in (second, third))
        assert expected.dtype.names == found.dtype.names
        for column in found.dtype.names:
            np.testing.assert_allclose(
                found[column].astype(float), expected[column].astype(float), rtol=tolerance, atol=tolerance
            )
            if kind == "CoSimulation" and column != "time" and not block.samples:
                wanted = native[column].values[::10].astype(float)
                np.testing.assert_allclose(found[column].astype(float), wanted, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", ["unicycle", "induction_motor"])
def test_a_linearised_plant_of_the_literature_is_an_fmu_3(name: str, exported: Callable) -> None:
    block, inputs = gallery_block(name)
    fmu = exported(block, 3).fmu
    assert validate_fmu(str(fmu)) == []
    native = br.simulate(block, 0.3, inputs=inputs)
    for kind, tolerance in (("CoSimulation", 1e-12), ("ModelExchange", 1e-6)):
        found = _run(fmu, kind, inputs, 0.3)
        for one in block.outputs:
            wanted = native[one.name].values[::10]
            scale = np.max(np.abs(wanted)) + 1e-3
            np.testing.assert_allclose(found[one.name], wanted, rtol=0, atol=tolerance * scale, err_msg=one.name)


@pytest.mark.parametrize("kind", KINDS)
def test_arrays_have_the_values_of_the_scalars(kind: str, exported: Callable) -> None:
    block = library.closed_loop()
    scalars, arrays = exported(block, 3), exported(block, 3, arrays=True)
    assert validate_fmu(str(arrays.fmu)) == []
    expected = _run(scalars.fmu, kind, {"center[1]": 0.2, "center[2]": -0.1})
    found = _run(arrays.fmu, kind, {"center": [0.2, -0.1]})
    assert {"S", "v"} <= set(found.dtype.names) and "S[1]" not in found.dtype.names
    for name in found.dtype.names:
        columns = [name] if found[name].ndim == 1 else [f"{name}[{k}]" for k in range(1, found[name].shape[1] + 1)]
        wanted = np.column_stack([expected[one].astype(float) for one in columns])
        np.testing.assert_allclose(found[name].astype(float).reshape(wanted.shape), wanted, rtol=1e-12, atol=1e-12)


def test_states_that_are_an_array_are_integrated(exported: Callable) -> None:
    """Three lags in a row, as a state vector that only its derivative shows beside the last one."""
    x = br.blocks.symbols("x[1]", "x[2]", "x[3]")
    u = br.blocks.symbols("u")[0]
    before = (u, *x)
    block = br.Block(
        "lags",
        inputs=[br.blocks.Input("u", "m", start=1.0)],
        parameters=[br.blocks.Parameter(f"rate[{k}]", "1/s", "rate of lag", float(k)) for k in (1, 2, 3)],
        states=[
            br.blocks.State(
                f"x[{k}]", "m", derivative=br.blocks.symbols(f"rate[{k}]")[0] * (before[k - 1] - x[k - 1]), start=0
            )
            for k in (1, 2, 3)
        ],
        outputs=[br.blocks.Output("y", "m", expression=x[2])],
    )
    arrays = exported(block, 3, arrays=True)
    names = {one.name: one.shape for one in fmpy.read_model_description(str(arrays.fmu)).modelVariables}
    assert (names["x"], names["der(x)"], names["rate"]) == ((3,), (3,), (3,))
    found = _run(arrays.fmu, "CoSimulation", {"rate": [2.0, 3.0, 4.0]}, output=["x", "y"])
    native = br.simulate(
        block, 0.5, parameters={"rate[1]": 2.0, "rate[2]": 3.0, "rate[3]": 4.0}, record=["x[1]", "x[2]", "x[3]"]
    )
    for k in (1, 2, 3):
        np.testing.assert_allclose(found["x"][:, k - 1], native[f"x[{k}]"].values[::10], rtol=1e-12)
