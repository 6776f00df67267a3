"""The files of an FMU 2.0: sources, generated and of the runtime, the description, and the binary for this machine."""

from __future__ import annotations

import hashlib
import tempfile
import uuid
from collections.abc import Iterable, Mapping
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType

import fmpy

from brunovsky._resources import resource, runtime_folder
from brunovsky.blocks import Block
from brunovsky.fmi.description2 import model_description
from brunovsky.fmi.structure import dependency_tables
from brunovsky.fmi.variables import scalar_variables
from brunovsky.native import compile_library, jacobian_source, model_source
from brunovsky.native.library import ENGINE_HEADERS, ENGINE_SOURCES

_RUNTIME = (*ENGINE_SOURCES, "instance.c", "sensitivity.c", "first_instant.c", "dependencies.c", "fmi2.c")
_HEADERS = (
    *ENGINE_HEADERS,
    "description.h",
    "first_instant.h",
    "instance.h",
    "jacobian.h",
    "sensitivity.h",
    "variables.h",
)
SOURCE_FILES = ("model.c", "jacobian.c", "description.c", *_RUNTIME)
"""C files that make up the binary; the first three are generated."""

_TYPES = {"Real": "REAL", "Integer": "INTEGER", "Boolean": "BOOLEAN"}


def headers_folder() -> Path:
    """Folder with the headers of the standard, ``fmi2Functions.h`` and those it includes, as fmpy brings them."""
    return Path(fmpy.__file__).parent / "c-code"


@lru_cache(maxsize=64)
def fmu_files(block: Block) -> Mapping[str, bytes]:
    """Every file of the FMU by its path inside, the binary compiled for this machine.

    The guid is a hash of everything else in the description and of all sources, so that it is the same for equal
    blocks and another one for others.

    Raises
    ------
    ModelError
        If the block uses a name that every FMU has.
    CompilerError
        If there is no C compiler or it fails.
    """
    from brunovsky import __version__  # known only when the package is imported whole

    blank = model_description(block, "", SOURCE_FILES, __version__)
    generated = {"model.c": model_source(block).encode(), "jacobian.c": jacobian_source(block).encode()}
    runtime = {name: (runtime_folder() / name).read_bytes() for name in (*_RUNTIME, *_HEADERS)}
    token = _token([blank, *generated.values(), *runtime.values()])
    sources = runtime | generated | {"description.c": description_source(block, token).encode()}
    files = {f"sources/{name}": text for name, text in sources.items()}
    files["documentation/licenses/brunovsky.txt"] = resource("LICENSE").read_bytes()  # of the runtime
    files["modelDescription.xml"] = model_description(block, token, SOURCE_FILES, __version__)
    files[f"binaries/{fmpy.platform}/{block.name}{fmpy.sharedLibraryExtension}"] = _binary(block.name, sources)
    return MappingProxyType(files)


def description_source(block: Block, token: str) -> str:
    """C text of what the runtime needs of the description: ``brunovsky_description`` of ``description.h``."""
    variables = scalar_variables(block)
    types = {one.name: _TYPES[one.type] for one in variables if one.causality == "output"}
    modes = [f'"{one.name}"' for one in block.modes]
    return "\n".join(
        [
            f'/* Generated from the block "{block.name}". Do not edit. */',
            '#include "description.h"',
            "",
            _table("char *const", "m_names", modes),
            _table("Type", "y_types", [types[one.name] for one in block.outputs], "REAL"),
            _table("int", "p_tunable", [str(int(one.tunable)) for one in block.parameters]),
            *dependency_tables(block, variables),
            "",
            "const Description brunovsky_description = {",
            f'    "{token}", m_names, y_types, p_tunable, initial, running,',
            "    sizeof initial / sizeof *initial - 1, sizeof running / sizeof *running - 1,",
            "};",
            "",
        ]
    )


def _table(kind: str, name: str, items: Iterable[str], last: str = "0") -> str:
    return f"static const {kind} {name}[] = {{{', '.join([*items, last])}}};"


def _token(parts: Iterable[bytes]) -> str:
    digest = hashlib.sha256()
    for part in parts:
        digest.update(hashlib.sha256(part).digest())
    return f"{{{uuid.UUID(bytes=digest.digest()[:16])}}}"


def _binary(name: str, sources: Mapping[str, bytes]) -> bytes:
    with tempfile.TemporaryDirectory(prefix="brunovsky-") as folder:
        base = Path(folder)
        for file, text in sources.items():
            (base / file).write_bytes(text)
        library = base / f"{name}{fmpy.sharedLibraryExtension}"
        compile_library([base / file for file in SOURCE_FILES], library, include=[base, headers_folder()])
        return library.read_bytes()
