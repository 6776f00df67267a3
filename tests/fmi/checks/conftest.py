"""A tiny foreign FMU with faults on request, and edited copies of FMUs."""

import zipfile
from collections.abc import Callable, Mapping
from pathlib import Path

import fmpy
import pytest

from brunovsky.blocks import Block
from brunovsky.fmi.contents import fmu_files, headers_folder, source_files
from brunovsky.native import compile_library

HERE = Path(__file__).parent
FAULTS = [
    "ANY_TOKEN",
    "ANY_VARIABLE",
    "CRASHES",
    "CRASHES_ON_RESTORE",
    "ENDLESS",
    "EXITS",
    "FEEDTHROUGH",
    "FORGETS",
    "HANGS",
    "IGNORES_RESET",
    "LOSES",
    "NAN_AT_HALF",
    "NOISY",
    "SHARED",
    "WRONG_DERIVATIVE",
]


def write_zip(path: Path, files: Mapping[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return path


@pytest.fixture
def tiny(tmp_path: Path) -> Callable[..., Path]:
    """The tiny FMU, with these faults."""

    def make(*faults: str) -> Path:
        library = tmp_path / f"tiny{fmpy.sharedLibraryExtension}"
        defines = {name: str(int(name in faults)) for name in FAULTS}
        compile_library([HERE / "tiny.c"], library, include=[headers_folder()], defines=defines)
        files = {"modelDescription.xml": (HERE / "tiny.xml").read_bytes()}
        files[f"binaries/{fmpy.platform}/{library.name}"] = library.read_bytes()
        return write_zip(tmp_path / "tiny.fmu", files)

    return make


@pytest.fixture
def planted(tmp_path: Path) -> Callable[..., Path]:
    """An FMU 3 of a block whose runtime has a text replaced, which must be there."""

    def plant(block: Block, file: str, before: str, after: str) -> Path:
        files = dict(fmu_files(block, 3))
        text = files[f"sources/{file}"].decode()
        assert before in text
        files[f"sources/{file}"] = text.replace(before, after, 1).encode()
        for name in (one for one in files if one.startswith("sources/")):
            (tmp_path / Path(name).name).write_bytes(files[name])
        library = tmp_path / f"{block.name}{fmpy.sharedLibraryExtension}"
        compile_library([tmp_path / one for one in source_files(3)], library, include=[tmp_path, headers_folder()])
        files[f"binaries/{fmpy.platform_tuple}/{library.name}"] = library.read_bytes()
        return write_zip(tmp_path / "planted.fmu", files)

    return plant


@pytest.fixture
def edited(tmp_path: Path) -> Callable[..., Path]:
    """A copy of an FMU with a text of its description replaced, which must be there."""

    def edit(fmu: Path, before: str, after: str) -> Path:
        with zipfile.ZipFile(fmu) as archive:
            files = {name: archive.read(name) for name in archive.namelist()}
        text = files["modelDescription.xml"].decode()
        assert before in text
        files["modelDescription.xml"] = text.replace(before, after, 1).encode()
        return write_zip(tmp_path / "edited.fmu", files)

    return edit
