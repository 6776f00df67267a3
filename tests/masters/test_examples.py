"""The examples in fmu/examples, each run as a user runs it, against the native simulation.

Co-simulation runs the very steps of the native simulation, so that only rounding is left (Ecos adds up its own time).
Model exchange is solved by the master to 1e-10 for each step and compared with Dormand-Prince of 1e-11 for each, which
locates events too. The loop is stable, so that errors of former steps decay; ten of the largest are allowed.
"""

import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import brunovsky as br

EXAMPLES = Path(__file__).parents[2] / "fmu" / "examples"
MASTERS = tomllib.loads((EXAMPLES / "masters.toml").read_text())["master"]
RUNS = [
    pytest.param(one, interface, id=f"{one['name']}, {interface}") for one in MASTERS for interface in one["interfaces"]
]
TOLERANCE = {"CS": 1e-12, "ME": 1e-9}


def run(*command: object) -> str:
    done = subprocess.run([sys.executable, *map(str, command)], capture_output=True, text=True, timeout=100)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@cache
def native(interface: str, changes: tuple[tuple[str, float], ...]) -> list[float]:
    options = {"solver": "dormand_prince", "tolerance": 1e-11} if interface == "ME" else {}
    end = br.simulate(br.blocks.closed_loop(), 1.0, step_size=1e-3, parameters=dict(changes), **options).isel(time=-1)
    return [float(end[name]) for name in "xy"]


@pytest.fixture(scope="module")
def fmus(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder, block = tmp_path_factory.mktemp("fmus"), br.blocks.closed_loop()
    return {one: br.export_fmu(block, folder / f"loop{one}.fmu", fmi_version=int(one)) for one in "23"}


@pytest.mark.parametrize(("master", "interface"), RUNS)
def test_an_example_prints_the_end_of_the_native_simulation(
    fmus: dict[str, Path], master: dict[str, object], interface: str
) -> None:
    pytest.importorskip(master["module"])
    _, version, kind = interface.split()
    name = {"CS": "CoSimulation", "ME": "ModelExchange"}[kind]
    printed = run(EXAMPLES / master["example"], fmus[version], name)
    found = next(line for line in printed.splitlines() if line[:2] == "1." and len(line.split()) == 2)
    expected = native(kind, tuple(master.get("changes", {}).items()))
    assert np.allclose(list(map(float, found.split())), expected, rtol=0.0, atol=TOLERANCE[kind])


def test_every_example_is_listed_and_the_readme_names_it() -> None:
    scripts = {one.name for one in EXAMPLES.glob("*.py")}
    assert scripts == {one["example"] for one in MASTERS}
    assert all(f"`{one}`" in (EXAMPLES / "README.md").read_text() for one in scripts)
