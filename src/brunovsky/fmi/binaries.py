"""The binaries of an FMU, compiled for each platform."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import fmpy

from brunovsky.fmi.platforms import UNIVERSAL, Platform, host_platform
from brunovsky.fmi.universal import universal_library
from brunovsky.native.compiler import compile_library, has_ziglang


def headers_folder() -> Path:
    """Folder with the headers of the standard, ``fmi2Functions.h``, ``fmi3Functions.h`` and those they include."""
    return Path(fmpy.__file__).parent / "c-code"  # as fmpy brings them


def compiler_target(platform: Platform) -> str | None:
    """What ziglang calls a platform; none for this machine with its own compiler."""
    native = platform.name == host_platform().name and not has_ziglang()
    return None if native else platform.target or None


def binary_files(
    name: str, fmi_version: int, sources: Mapping[str, bytes], compiled: Sequence[str], platforms: Iterable[Platform]
) -> dict[str, bytes]:
    """Libraries by their path in the FMU.

    Parameters
    ----------
    name : str
        The model identifier.
    fmi_version : {2, 3}
        Names the folders; FMI 2 has one for both processors of macOS.
    sources : mapping of str to bytes
        C files and headers.
    compiled : sequence of str
        Names of those to be compiled.
    platforms : iterable of Platform
        What to compile for. This machine's own needs no ziglang.

    Raises
    ------
    CompilerError
        If there is no compiler or it fails.
    """
    found: dict[Platform, bytes] = {}
    with tempfile.TemporaryDirectory(prefix="brunovsky-") as folder:
        base = Path(folder)
        for file, text in sources.items():
            (base / file).write_bytes(text)
        for one in platforms:
            library = base / one.name / f"{name}{one.suffix}"
            library.parent.mkdir()
            compile_library(
                [base / file for file in compiled],
                library,
                include=[base, headers_folder()],
                target=compiler_target(one),
            )
            found[one] = library.read_bytes()
    files = {f"binaries/{one.folder(fmi_version)}/{name}{one.suffix}": text for one, text in found.items()}
    macos = [text for one, text in found.items() if one.suffix == ".dylib"]
    if fmi_version == 2 and len(macos) > 1:
        files[f"binaries/{UNIVERSAL}/{name}.dylib"] = universal_library(macos)
    return files
