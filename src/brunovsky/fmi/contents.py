"""The files of an FMU: sources, generated and of the runtime, the descriptions, and the binaries."""

from __future__ import annotations

import hashlib
import uuid
from collections.abc import Iterable, Mapping
from functools import lru_cache
from types import MappingProxyType

from brunovsky._resources import resource, runtime_folder
from brunovsky.blocks import Block
from brunovsky.errors import ModelError, ParameterError
from brunovsky.fmi import description2, description3
from brunovsky.fmi.arrays import array_variables, spans
from brunovsky.fmi.binaries import binary_files, headers_folder
from brunovsky.fmi.build_description import build_description
from brunovsky.fmi.documentation import documentation
from brunovsky.fmi.icon import icon
from brunovsky.fmi.interfaces import INTERFACES, refused_interfaces
from brunovsky.fmi.platforms import HOST, chosen_platforms
from brunovsky.fmi.references import reference_files
from brunovsky.fmi.structure import dependency_tables
from brunovsky.fmi.terminals import terminals_and_icons
from brunovsky.fmi.variables import reference_offsets, scalar_variables
from brunovsky.native import jacobian_source, model_source
from brunovsky.native.code import quoted
from brunovsky.native.library import ENGINE_HEADERS, ENGINE_SOURCES
from brunovsky.native.output_derivatives import output_derivatives_source

__all__ = ["FMI_VERSIONS", "check_version", "description_source", "fmu_files", "headers_folder", "source_files"]

FMI_VERSIONS = (2, 3)
_INSTANCE = "instance variables stepping clocks exchange listening extrapolation state fmu"
_DERIVATIVES = "sensitivity first_instant dependencies"
_RUNTIME = (*ENGINE_SOURCES, *(f"{name}.c" for name in f"{_INSTANCE} {_DERIVATIVES}".split()))
_INTERFACE = {2: ("fmi2.c",), 3: ("fmi3.c", "fmi3_variables.c", "fmi3_clocks.c")}
_OWN_HEADERS = "description instance variables jacobian output_derivatives sensitivity first_instant fmu fmi3"
_HEADERS = (*ENGINE_HEADERS, *(f"{name}.h" for name in _OWN_HEADERS.split()))
_GENERATED = ("model.c", "jacobian.c", "output_derivatives.c", "description.c")

_SOURCES = "sources/"
_TOKEN = {2: "guid", 3: "instantiationToken"}
_TYPES = {"Real": "REAL", "Integer": "INTEGER", "Boolean": "BOOLEAN"}


def source_files(fmi_version: int) -> tuple[str, ...]:
    """C files that make up the binary; the first four are generated."""
    return (*_GENERATED, *_RUNTIME, *_INTERFACE[fmi_version])


def check_version(block: Block, fmi_version: int, arrays: bool = False) -> None:
    """Refuse what cannot be built.

    Raises
    ------
    ParameterError
        For a version that is unknown, and for arrays in FMI 2.
    ModelError
        For FMI 2 of a block with clocks.
    """
    if fmi_version not in FMI_VERSIONS:
        raise ParameterError(f"FMI {fmi_version} is not available; use fmi_version=2 or fmi_version=3")
    if fmi_version == 2 and arrays:
        raise ParameterError("FMI 2 has no array variables; use fmi_version=3, or arrays=False")
    if fmi_version == 2 and block.clocks:
        names = ", ".join(one.name for one in block.clocks)
        raise ModelError(
            f"{block.name} has clocks ({names}), which FMI 2 does not know; export it with fmi_version=3, or give its "
            "samples a period instead, as sliding_mode_sampled does in place of sliding_mode_clocked"
        )


@lru_cache(maxsize=64)
def fmu_files(
    block: Block, fmi_version: int = 2, arrays: bool = False, platforms: tuple[str, ...] = (HOST,)
) -> Mapping[str, bytes]:
    """Every file of the FMU by its path inside, the binaries compiled for the platforms.

    Raises
    ------
    ParameterError
        For a version or platform that is unknown, and for arrays in FMI 2.
    ModelError
        If the block uses a name that every FMU has, or has clocks that the version doesn't know.
    CompilerError
        If there is no C compiler or it fails.
    """
    chosen = chosen_platforms(platforms, fmi_version)
    files = portable_files(block, fmi_version, arrays)
    sources = {
        path.removeprefix(_SOURCES): text
        for path, text in files.items()
        if path.startswith(_SOURCES) and path.endswith((".c", ".h"))
    }
    binaries = binary_files(block.name, fmi_version, sources, source_files(fmi_version), chosen)
    return MappingProxyType({**files, **binaries})


@lru_cache(maxsize=64)
def portable_files(block: Block, fmi_version: int = 2, arrays: bool = False) -> Mapping[str, bytes]:
    """Every file of the FMU but the binaries, which are compiled from them.

    The guid or instantiation token is a hash of everything else in the description and of all sources, so that it is
    the same for equal blocks and another one for others.

    Raises
    ------
    ParameterError
        For a version that is unknown, and for arrays in FMI 2.
    ModelError
        If the block uses a name that every FMU has, or has clocks that the version doesn't know.
    """
    check_version(block, fmi_version, arrays)
    names = source_files(fmi_version)
    descriptions = _descriptions(block, fmi_version, arrays)
    generated = _generated(block)
    copied = (*(one for one in names if one not in _GENERATED), *_HEADERS)
    runtime = {name: (runtime_folder() / name).read_bytes() for name in copied}
    token = _token([*descriptions.values(), *generated.values(), *runtime.values()])
    description = description_source(block, token, arrays).encode()
    files = {f"{_SOURCES}{name}": text for name, text in (runtime | generated | {"description.c": description}).items()}
    files["documentation/licenses/license.txt"] = resource("LICENSE").read_bytes()  # of the runtime
    blank, named = f'{_TOKEN[fmi_version]}=""', f'{_TOKEN[fmi_version]}="{token}"'
    descriptions["modelDescription.xml"] = descriptions["modelDescription.xml"].replace(
        blank.encode(), named.encode(), 1
    )
    files |= descriptions | _presentation(block, fmi_version, arrays) | reference_files(block, arrays)
    return MappingProxyType(files)


@lru_cache(maxsize=64)
def _generated(block: Block) -> dict[str, bytes]:
    """Generated sources that both versions share."""
    return {
        "model.c": model_source(block).encode(),
        "jacobian.c": jacobian_source(block).encode(),
        "output_derivatives.c": output_derivatives_source(block).encode(),
    }


def _descriptions(block: Block, fmi_version: int, arrays: bool) -> dict[str, bytes]:
    """Descriptions with a blank token."""
    from brunovsky import __version__  # known only when the package is imported whole

    names = source_files(fmi_version)
    text = (
        description2.model_description(block, "", names, __version__)
        if fmi_version == 2
        else description3.model_description(block, "", __version__, arrays)
    )
    return {"modelDescription.xml": text, "sources/buildDescription.xml": build_description(block, names)}


def _presentation(block: Block, fmi_version: int, arrays: bool) -> dict[str, bytes]:
    """What people and diagrams see: icon, terminals, page."""
    variables = scalar_variables(block, fmi_version)
    names = [one.name for one in (array_variables(variables, arrays) if fmi_version == 3 else variables)]
    picture = icon(block)
    files = {
        "documentation/index.html": documentation(block, variables),
        "terminalsAndIcons/terminalsAndIcons.xml": terminals_and_icons(block, names),
        "terminalsAndIcons/icon.png": picture,
    }
    return files | ({"model.png": picture} if fmi_version == 2 else {})


def description_source(block: Block, token: str, arrays: bool = False) -> str:
    """C text of what the runtime needs of the description: ``brunovsky_description`` of ``description.h``."""
    variables = scalar_variables(block, fmi_version=3)
    types = {one.name: _TYPES[one.type] for one in variables if one.causality == "output"}
    lengths = spans(array_variables(variables, arrays), reference_offsets(block)["end"])
    tables = [
        _table("char *const", "m_names", [f'"{one.name}"' for one in block.modes]),
        _table("char *const", "z_names", [f'"{one.name}"' for one in variables if one.indicator]),
        _table("Type", "y_types", [types[one.name] for one in block.outputs], "REAL"),
        _table("int", "p_tunable", [str(int(one.tunable)) for one in block.parameters]),
    ]
    if lengths:
        tables.append(_table("unsigned", "spans", map(str, lengths)))
    tables += dependency_tables(block, variables)
    fields = {"token": f'"{token}"'}
    fields |= {name: name for name in ("m_names", "z_names", "y_types", "p_tunable", "initial", "running")}
    fields |= {f"n_{name}": f"sizeof {name} / sizeof *{name} - 1" for name in ("initial", "running")}
    fields["spans"] = "spans" if lengths else "0"
    refused = refused_interfaces(block)
    fields["refused"] = f"{{{', '.join(quoted(refused[one]) if one in refused else '0' for one in INTERFACES)}}}"
    return "\n".join(
        [
            f'/* Generated from the block "{block.name}". Do not edit. */',
            '#include "description.h"',
            "",
            *tables,
            "",
            "const Description brunovsky_description = {",
            *(f"    .{name} = {value}," for name, value in fields.items()),
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
