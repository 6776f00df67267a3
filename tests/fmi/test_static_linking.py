"""The sources alone: compiled with the standard's headers, and those of two FMUs linked into one program."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from lxml import etree

from brunovsky.blocks import library
from brunovsky.fmi.contents import headers_folder
from brunovsky.native import find_compiler

PROGRAM = """
#include <stdio.h>
int main(void)
{{
    extern const char *circle_fmi{version}GetVersion(void), *robot_fmi{version}GetVersion(void);
    return puts(circle_fmi{version}GetVersion()) < 0 || puts(robot_fmi{version}GetVersion()) < 0;
}}
"""


@pytest.fixture(scope="module")
def headers(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Headers as the standard has them: those of fmpy take no prefix in FMI 2."""
    folder = tmp_path_factory.mktemp("headers")
    for one in headers_folder().glob("*.h"):
        shutil.copy(one, folder)
    changed = folder / "fmi2Functions.h"
    text = changed.read_text(encoding="utf-8")
    prefixed = (
        "#ifdef FMI2_FUNCTION_PREFIX\n#define fmi2Paste(a, b) a##b\n#define fmi2PasteB(a, b) fmi2Paste(a, b)\n"
        "#define fmi2FullName(name) fmi2PasteB(FMI2_FUNCTION_PREFIX, name)\n"
        "#else\n#define fmi2FullName(name) name\n#endif\n"
    )
    assert text.count("#define fmi2FullName(name) name\n") == 1
    changed.write_text(text.replace("#define fmi2FullName(name) name\n", prefixed), encoding="utf-8")
    return folder


def objects(folder: Path, version: int, headers: Path, target: Path) -> list[Path]:
    """Object files of the first build configuration of an FMU, with the prefix of its model identifier."""
    root = etree.parse(str(folder / "sources" / "buildDescription.xml")).getroot()
    name = root[0].get("modelIdentifier")
    files = [folder / "sources" / one.get("name") for one in root[0].iter("SourceFile")]
    assert all(one.is_file() for one in files)
    target.mkdir()
    strict = ["-std=c99", "-O0", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    command = [*find_compiler(), *strict, f"-DFMI{version}_FUNCTION_PREFIX={name}_", f"-I{headers}", "-c"]
    subprocess.run([*command, *map(str, files)], check=True, cwd=target)
    return sorted(target.glob("*.o"))


@pytest.mark.skipif(shutil.which("nm") is None, reason="nm is not installed (binutils)")
@pytest.mark.parametrize("version", [2, 3])
def test_two_models_are_linked_into_one_program(version: int, exported, headers: Path, tmp_path: Path) -> None:
    linked: list[str] = []
    for block in (library.circle(), library.robot()):
        found = objects(exported(block, version).folder, version, headers, tmp_path / block.name)
        names = subprocess.run(
            ["nm", "-g", "--defined-only", *found], check=True, capture_output=True, text=True
        ).stdout
        symbols = re.findall(r"^[0-9a-f]+ [A-Z] _?(\w+)$", names, re.MULTILINE)
        stray = {one for one in symbols if not one.startswith(f"{block.name}_")}
        assert stray == set(), "these belong into fmu/runtime/names.h"
        assert f"{block.name}_fmi{version}DoStep" in symbols
        linked += map(str, found)
    main = tmp_path / "main.c"
    main.write_text(PROGRAM.format(version=version))
    program = tmp_path / "program"
    subprocess.run([*find_compiler(), "-o", str(program), str(main), *linked, "-lm"], check=True)
    run = subprocess.run([str(program)], check=True, capture_output=True, text=True)
    assert run.stdout.split() == [f"{version}.0"] * 2
