"""Outer loops as FMUs: each closed loop gives the native simulation, in co-simulation and in model exchange."""

import sys
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

from brunovsky.blocks import Block
from brunovsky.errors import ParameterError
from brunovsky.fmi import component, export_fmu
from brunovsky.native import simulate

sys.path.append(str(Path(__file__).parents[1] / "blocks"))
from outer_loop_cases import LOOPS, SURFACE, B, chain_loop, chain_plant

UNCLOCKED = [name for name in LOOPS if name != "sampled, on a clock"]  # FMI 2 has no clocks
BY_STEPS = {"sign", "power rate, sign", "super-twisting"}  # without model exchange


def run(fmu: Path, kind: str, **options: object) -> np.ndarray:
    return fmpy.simulate_fmu(
        str(fmu), fmi_type=kind, stop_time=1.5, output_interval=0.01, record_events=False, **options
    )


@pytest.mark.parametrize("name", UNCLOCKED)
def test_fmu_gives_the_native_simulation(name: str, tmp_path: Path) -> None:
    block = chain_loop(LOOPS[name](chain_plant()))
    fmu = export_fmu(block, tmp_path / "loop.fmu")
    assert validate_fmu(str(fmu)) == []
    expected = simulate(block, 1.5)["e1[1]"].values[::10]
    found = run(fmu, "CoSimulation")
    by_steps = name in BY_STEPS  # rounding of S near zero decides a step's branch
    np.testing.assert_allclose(found["e1[1]"], expected, atol=1e-6 if by_steps else 1e-12)
    if by_steps:
        return
    fine = simulate(block, 1.5, step_size=1e-4)["e1[1]"].values[::100]
    exchanged = run(fmu, "ModelExchange", relative_tolerance=1e-8)
    np.testing.assert_allclose(exchanged["e1[1]"], fine, atol=1e-3 if name == "relay" else 1e-5)


def test_a_relay_keeps_its_hysteresis_in_model_exchange(tmp_path: Path) -> None:
    """Its switches are located, so that S turns at the hysteresis itself, and there are as many as the cycle says."""
    block = chain_loop(B.sliding_mode_relay(chain_plant(), SURFACE, P=20.0, hysteresis=0.5))
    fmu = export_fmu(block, tmp_path / "relay.fmu")
    found = fmpy.simulate_fmu(
        str(fmu), fmi_type="ModelExchange", stop_time=2.5, output_interval=1e-3, relative_tolerance=1e-8
    )
    s = found["S[1]"][found["time"] > 1.2]
    assert s.max() == pytest.approx(0.5, abs=1e-3) and s.min() == pytest.approx(-0.5, abs=1e-3)


@pytest.mark.parametrize("name", sorted(BY_STEPS))
def test_the_sign_function_has_no_model_exchange(name: str) -> None:
    remedy = "super_twisting_sampled" if name == "super-twisting" else "sliding_mode_relay"
    for version in (2, 3):
        with pytest.raises(ParameterError, match=f"no end of events.*{remedy}.*; use CoSimulation$"):
            component(chain_loop(LOOPS[name](chain_plant())), version, "ModelExchange")


def test_the_measured_robot_is_an_fmu(tmp_path: Path) -> None:
    block = B.linearized_robot(measured=True)
    fmu = export_fmu(block, tmp_path / "measured.fmu")
    assert validate_fmu(str(fmu)) == []
    inputs = {"v[1]": 0.3, "v[2]": -0.2, "d[1]": 0.4}
    found = run(fmu, "CoSimulation", start_values=inputs)
    expected = simulate(block, 1.5, inputs=inputs)
    for name in ("Z1[3]", "Z2[3]", "x"):
        np.testing.assert_allclose(found[name], expected[name].values[::10], atol=1e-12)


@pytest.mark.parametrize(
    "block",
    [
        B.super_twisting(),
        B.super_twisting_sampled(),
        B.sliding_mode_sampled(surface_map="exact", preview=True),
        B.preview(B.circle()),
    ],
    ids=lambda one: one.name,
)
def test_a_law_by_itself_is_an_fmu(block: Block, tmp_path: Path) -> None:
    """Between samples its outputs are the native ones; at a sample they wait for the next step and its inputs."""
    fmu = export_fmu(block, tmp_path / "law.fmu")
    assert validate_fmu(str(fmu)) == []
    names = [one.name for one in block.inputs]
    rate = 0.0 if block.states else 3.0  # a law that is not sampled shows the inputs of the step before
    inputs = {name: (lambda time, k=k: 1e-3 * np.sin(rate * time + k)) for k, name in enumerate(names)}
    expected = simulate(block, 0.2, inputs=inputs)
    time = expected["time"].values
    signals = np.array(
        [(t, *(inputs[name](t) for name in names)) for t in time], dtype=[(one, float) for one in ("time", *names)]
    )
    found = fmpy.simulate_fmu(
        str(fmu),
        fmi_type="CoSimulation",
        stop_time=0.2,
        output_interval=1e-3,
        input=signals if names else None,
        use_event_mode=False,
    )
    between = np.arange(len(time)) % 10 != 0
    for one in block.outputs:
        if not one.name.startswith("S"):  # S is of the inputs of the step before
            np.testing.assert_allclose(
                found[one.name][between], expected[one.name].values[between], rtol=1e-9, atol=1e-9
            )
