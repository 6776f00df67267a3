"""Reference results in FMUs: the files keep the layered standard, and the FMU that carries them repeats them."""

import dataclasses
import os
from pathlib import Path

import fmpy
import numpy as np
import pytest
import sympy as sp
from layered_reference import FOLDER, check, related_files
from lxml import etree

from brunovsky.blocks import TIME, Block, Input, Output, Parameter, State, library, symbols
from brunovsky.fmi import shipped_block, shipped_fmus
from brunovsky.fmi.references import reference_files
from brunovsky.native import simulate

ROUNDING = 1e-8
"""Twice what nine significant digits leave of a number, relative to it, or to 1 in its unit."""

ALL = [(name, version) for version in (2, 3) for name in shipped_fmus(version)]


def experiments(unpacked: Path) -> dict[str, etree._Element]:
    root = etree.parse(unpacked / FOLDER / "experiments.exp").getroot()
    assert root.tag == "Experiments"
    check(root)
    return {one.get("name"): one for one in root}


def difference(fmu: Path, experiment: etree._Element, unpacked: Path, **options: object) -> float:
    """Largest difference between what fmpy finds and the results, relative to the number or to 1."""
    times = {key: float(value) for key, value in experiment.find("TransientSimulation").items()}
    folder = unpacked / FOLDER
    results = fmpy.read_csv(folder / experiment.find("References").get("source"))
    stimuli = experiment.find("Stimuli")
    names = list(results.dtype.names[1:])
    found = fmpy.simulate_fmu(
        str(fmu),
        start_time=times["startTime"],
        stop_time=times["stopTime"],
        output_interval=times["stepSize"],
        input=None if stimuli is None else fmpy.read_csv(folder / stimuli.get("source")),
        output=names,
        **{"fmi_type": "CoSimulation", **options},
    )
    rows = np.searchsorted(found["time"], results["time"] - 1e-6)
    np.testing.assert_allclose(found["time"][rows], results["time"], rtol=0, atol=1e-9)
    return max(
        float(np.max(np.abs(found[one][rows] - results[one]) / np.maximum(1, np.abs(results[one])))) for one in names
    )


@pytest.mark.parametrize(("name", "version"), ALL)
def test_every_fmu_that_ships_repeats_its_results(name: str, version: int, exported) -> None:
    block = shipped_block(name)
    fmu = exported(block, version)
    files = related_files(fmu.folder)
    roles = sorted(role for role, _ in files.values())
    if block.clocks:
        assert roles == ["document"]
        return
    ran = experiments(fmu.folder)
    assert set(ran) == ({"default", "ramps"} if block.inputs else {"default"})
    assert roles.count("result") == len(ran) and roles.count("experiment/smoke-test") == 1
    for one in ran.values():
        assert difference(fmu.fmu, one, fmu.folder) < ROUNDING


def test_another_method_agrees_within_its_error(exported) -> None:
    loop = exported(library.closed_loop(), 3)
    default = experiments(loop.folder)["default"]
    located = difference(loop.fmu, default, loop.folder, start_values={"solver": 2})
    assert 1e-5 < located < 5e-3  # of v, where it leaves saturation: RK4 freezes the branch over a step
    assert difference(loop.fmu, default, loop.folder, start_values={"radius": 1.1}) > 0.05


def test_results_are_those_of_a_simulation_in_python(exported) -> None:
    """Plain NumPy, over the first of the ten seconds."""
    robot = exported(library.linearized_robot())
    folder = robot.folder / FOLDER
    ramps, results = (fmpy.read_csv(folder / f"ramps-{one}.csv") for one in ("inputs", "outputs"))
    held = {
        one: lambda t, one=one: ramps[one][0] + (ramps[one][1] - ramps[one][0]) * np.floor(t * 100 + 1e-6) / 1000
        for one in ramps.dtype.names[1:]
    }
    run = simulate(library.linearized_robot(), 1.0, inputs=held, engine="numpy", record=["x", "y", "theta"])
    assert len({slope for slope in ramps[1].tolist()[1:]}) == 4  # each input by itself
    for name in ("x", "y", "theta"):
        np.testing.assert_allclose(run[name][::100], results[name][:11], rtol=ROUNDING, atol=ROUNDING)
    assert abs(results["theta"][-1]) > 0.1


def test_elements_of_an_array_are_one_column(exported) -> None:
    scalars, arrays = (exported(library.closed_loop(), 3, arrays=one) for one in (False, True))
    related_files(arrays.folder)
    one, other = (fmpy.read_csv(fmu.folder / FOLDER / "default-outputs.csv") for fmu in (scalars, arrays))
    assert other["S"].shape == (101, 2)
    assert np.array_equal(other["S"][:, 1], one["S[2]"])
    assert difference(arrays.fmu, experiments(arrays.folder)["default"], arrays.folder) < ROUNDING


def test_a_block_that_fails_says_so_in_its_notes(exported) -> None:
    x, u, a = symbols("x", "u", "a")
    root = Block(
        "root",
        inputs=(Input("u", "m/s", start=-1.0),),
        states=(State("x", "m", derivative=u, start=sp.Integer(1)),),
        outputs=(Output("y", "m", "not a number from 1 s on", sp.sqrt(x)),),
    )
    fmu = exported(root)
    assert {role for role, _ in related_files(fmu.folder).values()} == {"document"}
    notes = (fmu.folder / "documentation" / "fmi-ls-ref.txt").read_text()
    assert "* default: default experiment, inputs at their start values; no results: root: y is not finite" in notes
    never = dataclasses.replace(root, name="never", parameters=(Parameter("a", value=1.0),))
    never = dataclasses.replace(never, outputs=(Output("y", expression=1 / (a - 1) + TIME),))
    assert b"no results" in reference_files(never)["documentation/fmi-ls-ref.txt"]


def test_numbers_do_not_depend_on_the_version_of_the_standard(exported) -> None:
    two, three = (exported(library.robot(), version).folder / FOLDER for version in (2, 3))
    assert sorted(os.listdir(two)) == sorted(os.listdir(three))
    for name in os.listdir(two):
        assert (two / name).read_bytes() == (three / name).read_bytes()


def test_the_page_of_the_fmu_names_the_notes(exported) -> None:
    folder = exported(library.circle()).folder / "documentation"
    assert 'href="fmi-ls-ref.txt"' in (folder / "index.html").read_text()
    assert "1.0.0-alpha.1" in (folder / "fmi-ls-ref.txt").read_text()
