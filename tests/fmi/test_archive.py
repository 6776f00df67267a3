"""The FMU as a file: reproducible, complete, compilable elsewhere, written whole or not at all."""

import ctypes
import dataclasses
import hashlib
import os
import re
import subprocess
import sys
import zipfile
from pathlib import Path

import fmpy
import pytest
from fmpy import read_model_description
from fmu_driver import FUNCTIONS, Driver
from lxml import etree

from brunovsky.blocks import library
from brunovsky.errors import BrunovskyError, CompilerError, ParameterError
from brunovsky.fmi import contents, export_fmu, scalar_variables
from brunovsky.fmi.contents import fmu_files, headers_folder
from brunovsky.fmi.icon import icon
from brunovsky.native import find_compiler


def test_bytes_are_the_same_in_another_process_and_folder(exported, tmp_path):
    script = (
        "from brunovsky.blocks import library; from brunovsky.fmi import export_fmu;"
        "[export_fmu(library.circle(), f'again{v}.fmu', v) for v in (2, 3)]"
    )
    environment = {"PYTHONHASHSEED": "17", "PYTHONPATH": os.pathsep.join(sys.path)}
    environment |= {"BRUNOVSKY_CACHE": str(tmp_path / "cache")}  # compiled again
    subprocess.run([sys.executable, "-c", script], check=True, env=os.environ | environment, cwd=tmp_path)
    for version in (2, 3):
        again, first = tmp_path / f"again{version}.fmu", exported(library.circle(), version).fmu
        assert hashlib.sha256(again.read_bytes()).digest() == hashlib.sha256(first.read_bytes()).digest()


@pytest.mark.parametrize("arrays", [False, True])
def test_bytes_of_fmi_3_are_the_same_again(arrays, exported):
    block = library.circle()
    files = fmu_files(block, 3, arrays)
    for remembered in (fmu_files, contents.portable_files, contents._generated, scalar_variables, icon):
        remembered.cache_clear()
    assert fmu_files(library.circle(), 3, arrays) == files
    assert set(fmu_files(block, 3, not arrays).values()) != set(files.values())


def test_the_guid_follows_the_description_and_the_equations(sampled_integrator, exported, tmp_path):
    first = read_model_description(str(exported(sampled_integrator).fmu)).guid
    lag = sampled_integrator.states[0]
    others = [
        dataclasses.replace(sampled_integrator, description="another text"),
        dataclasses.replace(sampled_integrator, states=(dataclasses.replace(lag, derivative=2 * lag.derivative),)),
    ]
    guids = [read_model_description(str(export_fmu(one, tmp_path / "other.fmu"))).guid for one in others]
    assert len({first, *guids}) == 3


def test_entries_have_a_fixed_time_and_order(robot):
    with zipfile.ZipFile(robot.fmu) as archive:
        entries = archive.infolist()
    assert {one.date_time for one in entries} == {(1980, 1, 1, 0, 0, 0)}
    assert [one.filename for one in entries] == sorted(one.filename for one in entries)
    binary = f"binaries/{fmpy.platform}/linearized_robot{fmpy.sharedLibraryExtension}"
    assert {"modelDescription.xml", "sources/model.c", "sources/engine.c", binary} <= {one.filename for one in entries}


def test_an_fmu_3_has_its_description_sources_and_binary(exported):
    robot = exported(library.linearized_robot(), 3)
    with zipfile.ZipFile(robot.fmu) as archive:
        names = set(archive.namelist())
    binary = f"binaries/{fmpy.platform_tuple}/linearized_robot{fmpy.sharedLibraryExtension}"
    assert {binary, "modelDescription.xml", "sources/buildDescription.xml", "sources/fmi3.c"} <= names
    assert "sources/fmi2.c" not in names
    library_3 = ctypes.CDLL(str(robot.folder / binary))
    functions = re.findall(r"FMI3_Export fmi3(\w+)TYPE", (headers_folder() / "fmi3Functions.h").read_text())
    assert len(functions) > 70
    assert [one for one in functions if not hasattr(library_3, f"fmi3{one}")] == []


def test_every_function_of_the_standard_is_exported(robot):
    with Driver(robot.folder) as instance:
        assert len(FUNCTIONS) == 44
        missing = [one for one in FUNCTIONS if not hasattr(instance.library, f"fmi2{one}")]
        assert missing == []
        assert not hasattr(instance.library, "engine_new"), "the runtime must not clash with that of another FMU"


@pytest.mark.parametrize("version", [2, 3])
def test_the_sources_make_a_library_without_warnings(version, exported, tmp_path):
    robot = exported(library.linearized_robot(), version, arrays=version == 3)
    configuration = read_model_description(str(robot.folder)).buildConfigurations[0]
    (sources,) = configuration.sourceFileSets
    assert configuration.modelIdentifier == "linearized_robot"
    files = [robot.folder / "sources" / one for one in sources.sourceFiles]
    built = tmp_path / "built.so"
    command = [*find_compiler(), "-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-shared", "-fPIC"]
    subprocess.run([*command, f"-I{headers_folder()}", "-o", str(built), *map(str, files), "-lm"], check=True)
    assert f"fmi{version}DoStep".encode() in built.read_bytes()


def test_both_interfaces_of_fmi_2_list_the_same_sources(robot):
    root = etree.parse(str(robot.folder / "modelDescription.xml"))
    listed, again = ([one.get("name") for one in root.find(kind)[0]] for kind in ("CoSimulation", "ModelExchange"))
    assert listed == again


def test_missing_folders_are_made_and_nothing_else_is_left(sampled_integrator, tmp_path):
    path = export_fmu(sampled_integrator, tmp_path / "a" / "b" / "one.fmu")
    assert path.is_file()
    assert os.listdir(path.parent) == ["one.fmu"]


def test_a_write_that_fails_names_the_file_and_leaves_the_old_one(sampled_integrator, tmp_path, monkeypatch):
    path = tmp_path / "one.fmu"
    path.write_bytes(b"old")

    def full(*_arguments):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.chmod", full)  # when all is written
    with pytest.raises(BrunovskyError, match=r"one\.fmu cannot be written: No space left"):
        export_fmu(sampled_integrator, path)
    assert path.read_bytes() == b"old"
    assert os.listdir(tmp_path) == ["one.fmu"]


def test_a_folder_in_the_place_of_the_file_is_named(sampled_integrator, tmp_path):
    (tmp_path / "one.fmu").mkdir()
    with pytest.raises(BrunovskyError, match=r"one\.fmu cannot be written"):
        export_fmu(sampled_integrator, tmp_path / "one.fmu")
    assert os.listdir(tmp_path) == ["one.fmu"]


def test_a_missing_compiler_is_named_and_nothing_is_written(sampled_integrator, tmp_path, monkeypatch):
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(CompilerError, match="no-such-compiler"):
        export_fmu(dataclasses.replace(sampled_integrator, name="fresh"), tmp_path / "one.fmu")
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"fmi_version": 1}, "FMI 1 is not available; use fmi_version=2 or fmi_version=3"),
        ({"arrays": True}, "FMI 2 has no array variables; use fmi_version=3"),
        (
            {"fmi_version": 3, "platforms": ("linux64",)},
            "platform 'linux64' is not available in FMI 3; there are x86_64",
        ),
        ({"platforms": ("host", "vax")}, "platform 'vax' is not available in FMI 2"),
        ({"platforms": ()}, "no platform was named"),
    ],
)
def test_what_is_not_built_is_refused_with_the_alternative(options, message, tmp_path):
    with pytest.raises(ParameterError, match=message):
        export_fmu(library.circle(), tmp_path / "one.fmu", **options)
    assert os.listdir(tmp_path) == []


def test_the_host_may_be_named(sampled_integrator, tmp_path):
    assert export_fmu(sampled_integrator, str(tmp_path / "one.fmu"), platforms=(fmpy.platform,)) == Path(
        tmp_path, "one.fmu"
    )
