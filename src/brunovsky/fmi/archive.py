"""FMU files: what :mod:`brunovsky.fmi.contents` makes of a block, zipped, with the same bytes for equal blocks."""

from __future__ import annotations

import io
import os
import tempfile
import zipfile
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from functools import partial
from pathlib import Path

from brunovsky.blocks import Block
from brunovsky.errors import BrunovskyError
from brunovsky.fmi.contents import check_version, fmu_files, portable_files
from brunovsky.fmi.kept import fmu_key, keep_fmu, kept_fmu

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

    The file is written whole or not at all, and has the same bytes for equal blocks and compilers. It is kept in the
    cache as well, from where equal arguments get it until anything that it is made of changes: the block, this package,
    a library that it uses, or the compiler.

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
    (written,) = export_fmus([(block, path, fmi_version)], platforms, arrays=arrays)
    return written


def export_fmus(
    fmus: Iterable[tuple[Block, str | os.PathLike[str], int]],
    platforms: Sequence[str] = ("host",),
    *,
    arrays: bool = False,
) -> Iterator[Path]:
    """Write several FMUs; while the compiler runs for one, the next is derived.

    Parameters
    ----------
    fmus : iterable of (Block, path, int)
        What each runs, where it goes, and the version of FMI.
    platforms, arrays
        As those of :func:`export_fmu`.

    Yields
    ------
    Path
        Of each FMU, in order, when it is written.

    Raises
    ------
    BrunovskyError
        As :func:`export_fmu`, of the first FMU that can't be written. What is being compiled then is finished, what is
        waiting is not begun; no file is left half-written.
    """
    waiting: deque[Future[Path]] = deque()
    with ThreadPoolExecutor(os.cpu_count()) as pool:  # for compilers; SymPy stays in this thread
        try:
            for block, path, version in fmus:
                check_version(block, version, arrays)
                key = fmu_key(block, version, platforms, arrays)
                content = key and kept_fmu(key)
                if not content:
                    portable_files(block, version, arrays)
                build = partial(_built, key, block, version, tuple(platforms), arrays)
                waiting.append(pool.submit(_write, Path(path), content or build))
                while waiting and waiting[0].done():
                    yield waiting.popleft().result()
            while waiting:
                yield waiting.popleft().result()
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _built(key: str | None, block: Block, fmi_version: int, platforms: tuple[str, ...], arrays: bool) -> bytes:
    """FMU of a block, kept if nothing that it is made of has changed meanwhile."""
    content = packed(fmu_files(block, fmi_version, arrays, platforms))
    if key and key == fmu_key(block, fmi_version, platforms, arrays):
        keep_fmu(key, content)
    return content


def _write(target: Path, content: bytes | Callable[[], bytes]) -> Path:
    content = content if isinstance(content, bytes) else content()
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        write_whole(target, content)
    except OSError as error:
        raise BrunovskyError(f"the FMU {target} cannot be written: {error.strerror or error}") from None
    return target


def packed(files: Mapping[str, bytes]) -> bytes:
    """Zip file, with the same bytes for equal files."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in sorted(files):
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.create_system = 3
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o100755 if name.startswith("binaries/") else 0o100644) << 16
            archive.writestr(entry, files[name])
    return stream.getvalue()


def write_whole(target: Path, content: bytes) -> None:
    """Write a file whole or not at all; may raise ``OSError``."""
    with tempfile.NamedTemporaryFile(dir=target.parent, prefix=f".{target.name}-", delete=False) as fresh:
        try:
            fresh.write(content)
            fresh.close()
            os.chmod(fresh.name, 0o644)
            os.replace(fresh.name, target)
        except BaseException:
            fresh.close()
            os.unlink(fresh.name)
            raise
