"""FMU files: what :mod:`brunovsky.fmi.contents` makes of a block, zipped, with the same bytes for equal blocks."""

from __future__ import annotations

import os
import tempfile
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from brunovsky.blocks import Block
from brunovsky.errors import BrunovskyError
from brunovsky.fmi.contents import fmu_files

_EPOCH = (1980, 1, 1, 0, 0, 0)


def export_fmu(
    block: Block,
    path: str | os.PathLike[str],
    fmi_version: int = 2,
    platforms: Sequence[str] = ("host",),
    *,
    arrays: bool = False,
) -> Path:
    """Write an FMU for co-simulation and model exchange, with its sources.

    A block that clocks alone make act has scheduled execution as well (FMI 3); one with a sign function that has no
    width, as its parameters are by default, has no model exchange.

    The file is written whole or not at all, and has the same bytes for equal blocks and compilers.

    Parameters
    ----------
    block : Block
        Any block or diagram; its name is the model identifier.
    path : path
        Of the FMU; missing folders are made.
    fmi_version : int
        2 or 3. A block with clocks needs 3.
    platforms : sequence of str
        ``"host"``, this machine with its own compiler, and platforms by name, or ``"all"`` of them: ``x86_64-linux``,
        ``aarch64-linux`` (glibc 2.17 or later), ``x86_64-windows``, ``x86_64-darwin``, ``aarch64-darwin`` (macOS).
        FMI 2 also takes its own names, ``linux64``, ``win64``, ``darwin64``. All but the host are compiled by ziglang.
    arrays : bool
        Whether elements ``name[1]`` to ``name[n]`` of one unit are one array variable ``name`` (FMI 3). By default
        they are scalars, with the names of FMI 2.

    Returns
    -------
    Path
        Of the FMU.

    Raises
    ------
    ParameterError
        For a version or platform that is unknown, and for arrays in FMI 2.
    ModelError
        If the block uses a name that every FMU has: ``step_size``, ``solver``; for FMI 2 of a block with clocks.
    CompilerError
        If there is no C compiler, or no ziglang for another platform, or it fails.
    BrunovskyError
        If the file cannot be written.
    """
    target = Path(path)
    files = fmu_files(block, fmi_version, arrays, tuple(platforms))
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        write_archive(target, files)
    except OSError as error:
        raise BrunovskyError(f"the FMU {target} cannot be written: {error.strerror or error}") from None
    return target


def write_archive(target: Path, files: Mapping[str, bytes]) -> None:
    """Write a zip file whole or not at all, with the same bytes for equal files; may raise ``OSError``."""
    with tempfile.NamedTemporaryFile(dir=target.parent, prefix=f".{target.name}-", delete=False) as fresh:
        try:
            with zipfile.ZipFile(fresh, "w", zipfile.ZIP_DEFLATED) as archive:
                for name in sorted(files):
                    entry = zipfile.ZipInfo(name, _EPOCH)
                    entry.create_system = 3
                    entry.compress_type = zipfile.ZIP_DEFLATED
                    entry.external_attr = (0o100755 if name.startswith("binaries/") else 0o100644) << 16
                    archive.writestr(entry, files[name])
            fresh.close()
            os.chmod(fresh.name, 0o644)
            os.replace(fresh.name, target)
        except BaseException:
            fresh.close()
            os.unlink(fresh.name)
            raise
