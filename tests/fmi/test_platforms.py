"""FMUs for other platforms than this one: what is in them, that it is the same again, and that Windows runs it."""

import os
import re
import shutil
import struct
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from binary_symbols import exported as exported_names
from binary_symbols import parts
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu
from fmu_driver import FUNCTIONS

from brunovsky.blocks import library
from brunovsky.errors import CompilerError, ParameterError
from brunovsky.fmi import export_fmu
from brunovsky.fmi.contents import fmu_files, headers_folder
from brunovsky.fmi.platforms import NAMES, chosen_platforms, host_platform
from brunovsky.fmi.ssp import export_ssp, robot_system, robot_variants
from brunovsky.fmi.universal import universal_library
from brunovsky.native import compiler

FUNCTIONS_3 = re.findall(r"FMI3_Export fmi3(\w+)TYPE", (headers_folder() / "fmi3Functions.h").read_text())
STANDARD = {2: {f"fmi2{one}" for one in FUNCTIONS}, 3: {f"fmi3{one}" for one in FUNCTIONS_3}}
FOLDERS = {
    2: {"linux64", "aarch64-linux", "win64", "darwin64", "aarch64-darwin"},
    3: {"x86_64-linux", "aarch64-linux", "x86_64-windows", "x86_64-darwin", "aarch64-darwin"},
}
LINKER = {"__dso_handle", "_mh_dylib_header"}  # which ziglang's linker for macOS exports of its own accord
needs_zig = pytest.mark.skipif(not compiler.has_ziglang(), reason="ziglang is not installed (extra zig)")


@pytest.mark.parametrize("version", [2, 3])
def test_each_platform_has_its_folder(version: int) -> None:
    assert {one.folder(version) for one in chosen_platforms(("all",), version)} == FOLDERS[version]
    assert host_platform().folder(version) == (fmpy.platform if version == 2 else fmpy.platform_tuple)


def test_platforms_are_built_once_and_go_by_the_names_of_both_versions() -> None:
    assert [one.name for one in chosen_platforms(("all", "x86_64-linux", "host"), 3)] == list(NAMES)
    assert [one.name for one in chosen_platforms(("win64", "darwin64"), 2)] == [
        "x86_64-windows",
        "x86_64-darwin",
        "aarch64-darwin",
    ]
    with pytest.raises(ParameterError, match="'win64' is not available in FMI 3; there are x86_64-linux"):
        chosen_platforms(("win64",), 3)


def test_a_missing_ziglang_is_named_with_the_remedy(sampled_integrator, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(compiler.importlib.util, "find_spec", lambda name: None)
    fmu_files.cache_clear()
    with pytest.raises(CompilerError, match=r"x86_64-windows-gnu needs ziglang; .*pip install 'brunovsky\[zig\]'"):
        export_fmu(sampled_integrator, tmp_path / "one.fmu", platforms=("x86_64-windows",))
    assert os.listdir(tmp_path) == []
    if host_platform().name in NAMES:  # this machine's own needs none
        assert export_fmu(sampled_integrator, tmp_path / "one.fmu", platforms=(host_platform().name,)).is_file()


def mach_o(processor: int, size: int) -> bytes:
    return struct.pack("<3I", 0xFEEDFACF, processor, 3) + b"x" * size


def test_a_universal_library_holds_its_parts_as_they_are() -> None:
    libraries = [mach_o(0x01000007, 70_000), mach_o(0x0100000C, 5)]
    assert parts(universal_library(libraries)) == libraries


@pytest.mark.parametrize(
    ("libraries", "message"),
    [
        ([b"\x7fELF" + b"\0" * 60], "not a 64-bit Mach-O file"),
        ([b""], "not a 64-bit Mach-O file"),
        ([mach_o(7, 1), mach_o(7, 2)], "two Mach-O files for one processor"),
    ],
)
def test_what_makes_no_universal_library_is_refused(libraries: list[bytes], message: str) -> None:
    with pytest.raises(ParameterError, match=message):
        universal_library(libraries)


@pytest.mark.parametrize("version", [2, 3])
def test_the_host_exports_the_functions_of_the_standard_and_nothing_else(version: int, exported) -> None:
    circle = exported(library.circle(), version)
    binary = circle.folder / "binaries" / host_platform().folder(version) / f"circle{host_platform().suffix}"
    assert exported_names(binary.read_bytes()) == STANDARD[version]


@needs_zig
@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
def test_one_file_for_all_platforms(version: int, tmp_path: Path) -> None:
    path = export_fmu(library.closed_loop(), tmp_path / "closed_loop.fmu", version, ("all",))
    assert path.stat().st_size < 1_000_000
    assert validate_fmu(str(path)) == []
    with zipfile.ZipFile(path) as archive:
        binaries = {name: archive.read(name) for name in archive.namelist() if name.startswith("binaries/")}
    assert {name.split("/")[1] for name in binaries} == FOLDERS[version]
    for name, data in binaries.items():
        files = parts(data) if version == 2 and "darwin64" in name else [data]
        assert len(files) == (2 if version == 2 and "darwin64" in name else 1)
        for one in files:
            assert exported_names(one) - (LINKER if "darwin" in name else set()) == STANDARD[version], name
            assert str(tmp_path).encode() not in one and str(Path.home()).encode() + b"/" not in one
        if name.endswith(".so"):
            versions = {tuple(map(int, one.split(b"."))) for one in re.findall(rb"GLIBC_([\d.]+)", data)}
            assert versions and max(versions) <= (2, 17)
    if host_platform().name in NAMES:
        host = export_fmu(library.closed_loop(), tmp_path / "host.fmu", version)
        ours, zigs = (simulate_fmu(str(one), stop_time=1.0, output=["x", "y"]) for one in (host, path))
        np.testing.assert_allclose(zigs["x"], ours["x"], rtol=0, atol=1e-12)


@needs_zig
@pytest.mark.slow
@pytest.mark.parametrize("version", [1, 2])
def test_a_package_of_three_for_all_platforms_stays_small(version: int, tmp_path: Path) -> None:
    path = export_ssp(
        robot_system(),
        tmp_path / "robot.ssp",
        ssp_version=version,
        variants=robot_variants(),
        platforms=("all",),
        system_connectors=False,
    )
    assert path.stat().st_size < 1_000_000


@needs_zig
@pytest.mark.slow
def test_all_platforms_have_the_same_bytes_again(tmp_path: Path) -> None:
    script = (
        "import sys; from brunovsky.blocks import library; from brunovsky.fmi import export_fmu;"
        "[export_fmu(library.circle(), f'circle{v}.fmu', v, ('all',)) for v in (2, 3)]"
    )
    built = []
    for seed in ("1", "2"):
        folder = tmp_path / seed
        folder.mkdir()
        environment = {"PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)}
        environment |= {"BRUNOVSKY_CACHE": str(folder / "cache")}  # compiled again
        subprocess.run([sys.executable, "-c", script], check=True, env=os.environ | environment, cwd=folder)
        built.append([(folder / f"circle{version}.fmu").read_bytes() for version in (2, 3)])
    assert built[0] == built[1]


@needs_zig
@pytest.mark.slow
@pytest.mark.wine
@pytest.mark.skipif(shutil.which("wine") is None, reason="wine is not installed")
def test_wine_runs_the_windows_library(tmp_path: Path) -> None:
    block = library.closed_loop()
    fmu = export_fmu(block, tmp_path / "closed_loop.fmu", platforms=("host", "x86_64-windows"))
    folder = Path(fmpy.extract(str(fmu), str(tmp_path / "fmu")))
    loader = tmp_path / "loader.exe"
    source = Path(__file__).with_name("windows_loader.c")
    zig = [sys.executable, "-m", "ziglang", "cc", "-target", "x86_64-windows-gnu", "-O2", "-s"]
    subprocess.run([*zig, f"-I{headers_folder()}", "-o", str(loader), str(source)], check=True)
    description = read_model_description(str(fmu))
    (x,) = (one.valueReference for one in description.modelVariables if one.name == "x")
    printed = tmp_path / "printed.txt"
    with printed.open("w") as output:  # no pipe: wine's server would keep it open
        subprocess.run(
            ["wine", str(loader), str(folder / "binaries" / "win64" / "closed_loop.dll"), description.guid, str(x)],
            env=os.environ | {"WINEPREFIX": str(tmp_path / "wine"), "WINEDEBUG": "-all"},
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.DEVNULL,
            check=True,
        )
    here = simulate_fmu(str(fmu), stop_time=1.0, output_interval=0.01, fmi_type="CoSimulation", output=["x"])
    assert float(printed.read_text()) == pytest.approx(here["x"][-1], abs=1e-12)
