"""FMUs that were built before: kept in the cache, and found again by everything that their bytes depend on."""

from __future__ import annotations

import hashlib
import json
import platform
import zlib
from collections.abc import Sequence
from pathlib import Path

import fmpy
import lxml.etree
import mpmath
import PIL
import sympy as sp

from brunovsky._resources import resource, runtime_folder
from brunovsky._sources import files_digest, package_digest
from brunovsky.blocks import Block
from brunovsky.blocks.digest import block_digest
from brunovsky.fmi.binaries import compiler_target, headers_folder
from brunovsky.fmi.platforms import chosen_platforms
from brunovsky.native.compiler import cache_folder, compiler_for, compiler_version, keep

_HASH = hashlib.sha256
_VERSIONS = {
    "python": platform.python_version(),
    "sympy": sp.__version__,
    "mpmath": mpmath.__version__,
    "lxml": str((lxml.etree.LXML_VERSION, lxml.etree.LIBXML_VERSION)),
    "pillow": PIL.__version__,
    "fmpy": fmpy.__version__,
    "zlib": zlib.ZLIB_RUNTIME_VERSION,
}


def fmu_key(block: Block, fmi_version: int, platforms: Sequence[str], arrays: bool) -> str | None:
    """Name under which an FMU is kept: a hash of all that it is made of.

    That is the block, the options, the Python files of this package, the runtime, the headers of the standard, the
    compilers, and the versions of the libraries that write and pack the files.

    Parameters
    ----------
    block : Block
        What the FMU runs.
    fmi_version : {2, 3}
        Of the standard.
    platforms : sequence of str
        What it is compiled for.
    arrays : bool
        Whether elements are arrays.

    Returns
    -------
    str or None
        None if one of them can't be known for sure; the FMU is then built anew.

    Raises
    ------
    ParameterError
        If a platform is unknown.
    CompilerError
        If there is no compiler for one.
    """
    from brunovsky import __version__  # known only when the package is imported whole

    chosen = chosen_platforms(platforms, fmi_version)
    commands = [compiler_for(compiler_target(one)) for one in chosen]
    parts = {
        "brunovsky": __version__,
        "package": package_digest(),
        "block": block_digest(block),
        "files": _files_digest(),
        "compilers": [(one, compiler_version(one)) for one in commands],
        "options": [fmi_version, [one.name for one in chosen], arrays],
    }
    if None in parts.values():
        return None
    return f"{block.name}-{_HASH(json.dumps(parts | _VERSIONS, sort_keys=True).encode()).hexdigest()[:32]}"


def _files_digest() -> str | None:
    folders = (runtime_folder(), headers_folder())
    try:
        found = [files_digest(sorted(place.rglob("*.[ch]")), place) for place in folders]
        return " ".join([*found, files_digest([resource("LICENSE")], resource("LICENSE").parent)])
    except OSError:
        return None


def kept_fmu(key: str) -> bytes | None:
    """FMU that was kept under a key; none if there is none or its file is damaged."""
    try:
        stored = _path(key).read_bytes()
    except OSError:
        return None
    digest, content = stored[: _HASH().digest_size], stored[_HASH().digest_size :]
    return content if _HASH(content).digest() == digest else None


def keep_fmu(key: str, content: bytes) -> None:
    """Keep an FMU; a cache that can't be written costs time only."""
    keep(_path(key), _HASH(content).digest() + content)


def _path(key: str) -> Path:
    return cache_folder() / "fmus" / key
