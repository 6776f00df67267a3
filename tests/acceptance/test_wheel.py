"""The wheel by itself: installed with its dependencies where nothing else is, it builds, checks and runs FMUs."""

import os
import subprocess
import sys
import venv
from pathlib import Path
from zipfile import ZipFile

import fmpy
import pytest

ROOT = Path(__file__).parents[2]
BINARY = f"circle{fmpy.sharedLibraryExtension}"
NAMES = ("linearized_robot", "closed_loop", "circle")

SIMULATE = """
import sys, fmpy
run = fmpy.simulate_fmu(sys.argv[1], fmi_type="CoSimulation", stop_time=10.0, output_interval=0.01)
print(run["x"][-1] ** 2 + run["y"][-1] ** 2)
"""
WHERE = "import brunovsky, fmpy; print(brunovsky.__file__); print(fmpy.__file__)"

pytestmark = pytest.mark.slow


class Machine:
    """A fresh virtual environment with the wheel in it, and an empty folder outside of the repository."""

    def __init__(self, base: Path) -> None:
        self.environment, self.folder = base / "environment", base / "folder"
        self.folder.mkdir()
        venv.create(self.environment, with_pip=True)
        self.bin = self.environment / ("Scripts" if os.name == "nt" else "bin")
        self.variables = {
            key: text for key, text in os.environ.items() if not key.startswith(("PYTHON", "VIRTUAL_ENV"))
        }
        self.variables |= {"BRUNOVSKY_CACHE": str(base / "cache"), "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
        wheels = base / "wheels"
        self.run("python", "-m", "pip", "wheel", "-q", "--no-deps", "-w", str(wheels), str(ROOT))
        (self.wheel,) = wheels.glob("*.whl")
        self.run("python", "-m", "pip", "install", "-q", "-c", str(ROOT / "constraints.txt"), str(self.wheel))

    def run(self, program: str, *arguments: str) -> str:
        done = subprocess.run(
            [str(self.bin / program), *arguments], cwd=self.folder, env=self.variables, capture_output=True, text=True
        )
        assert done.returncode == 0, f"{program} {' '.join(arguments)}\n{done.stdout}\n{done.stderr}"
        return done.stdout


@pytest.fixture(scope="module")
def machine(tmp_path_factory: pytest.TempPathFactory) -> Machine:
    return Machine(tmp_path_factory.mktemp("machine"))


def test_it_is_the_installed_package_that_runs(machine: Machine) -> None:
    places = machine.run("python", "-c", WHERE).split()
    assert all(Path(one).is_relative_to(machine.environment) for one in places)
    installed = machine.run("python", "-m", "pip", "list", "--format=freeze")
    assert "pytest" not in installed and "hypothesis" not in installed


@pytest.mark.parametrize(("fmi", "ssp"), [("2", "1"), ("3", "2")])
def test_it_builds_checks_and_runs_what_ships(machine: Machine, fmi: str, ssp: str) -> None:
    machine.run("brunovsky", "build", "-o", f"built{fmi}", "--fmi", fmi, "--ssp", ssp)
    built = machine.folder / f"built{fmi}"
    files = {path.relative_to(built).as_posix() for path in built.rglob("*") if path.is_file()}
    assert files >= {"ssp/robot.ssp", *(f"fmi{fmi}/{name}.fmu" for name in NAMES)}
    machine.run("brunovsky", "check", str(built / f"fmi{fmi}" / "closed_loop.fmu"))  # its status is 0
    squared = float(machine.run("python", "-c", SIMULATE, str(built / f"fmi{fmi}" / "closed_loop.fmu")))
    assert squared == pytest.approx(2.0, abs=0.05)  # on the circle of figure 6


def test_what_is_built_is_what_the_repository_builds(machine: Machine, tmp_path: Path) -> None:
    machine.run("brunovsky", "build", "-o", "wheel", "circle")
    variables = machine.variables | {"PYTHONPATH": str(ROOT / "src")}
    command = [sys.executable, "-m", "brunovsky", "build", "-o", str(tmp_path), "circle"]
    subprocess.run(command, cwd=tmp_path, env=variables, check=True, capture_output=True)
    for version in (2, 3):
        one, other = (unpacked(base / f"fmi{version}/circle.fmu") for base in (machine.folder / "wheel", tmp_path))
        assert sorted(one) == sorted(other)
        same = [name for name in one if one[name] == other[name]]
        assert {"sources/model.c", "sources/engine.c", "extra/org.fmi-standard.fmi-ls-ref/default-outputs.csv"} <= {
            *same
        }
        differ = {
            name.rsplit("/", 1)[-1] for name in one if name not in same
        }  # what names the version or has the token
        assert differ <= {"modelDescription.xml", "description.c", "icon.png", "model.png"} | {BINARY}


def unpacked(path: Path) -> dict[str, bytes]:
    with ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def test_the_rest_of_the_command_line_finds_its_data(machine: Machine) -> None:
    assert "closed_loop" in machine.run("brunovsky", "list")
    machine.run("brunovsky", "compare", "paper", "-o", "paper")
    assert (machine.folder / "paper" / "report.html").stat().st_size > 10_000
