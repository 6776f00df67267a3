"""The C compiler: the system's, or ziglang's where there is none (extra ``zig``)."""

from __future__ import annotations

import hashlib
import importlib.util
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections import defaultdict
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import lru_cache
from pathlib import Path
from threading import Lock

from brunovsky.errors import CompilerError

SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
"""File name ending of shared libraries on this machine."""

_compiling: defaultdict[Path, Lock] = defaultdict(Lock)
"""Locks of object files, so that libraries compiled at once compile each of them once."""

_FLAGS = ("-std=c99", "-O2", "-ffp-contract=off", "-fvisibility=hidden")


def cache_folder() -> Path:
    """Folder of what was compiled and built: ``$BRUNOVSKY_CACHE``, else the user's cache folder."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(os.environ.get("BRUNOVSKY_CACHE") or Path(base) / "brunovsky")


def find_compiler() -> tuple[str, ...]:
    """Command that compiles C here: ``$CC``, cc, gcc, clang, or ``python -m ziglang cc``.

    Raises
    ------
    CompilerError
        If there is none; the message says how to get one.
    """
    if os.environ.get("CC"):
        command = shlex.split(os.environ["CC"])
        if shutil.which(command[0]) is None:
            raise CompilerError(f"the C compiler named by CC, '{command[0]}', was not found; correct or unset CC")
        return tuple(command)
    for name in ("cc", "gcc", "clang"):
        if shutil.which(name):
            return (name,)
    if has_ziglang():
        return (sys.executable, "-m", "ziglang", "cc")
    raise CompilerError(
        "no C compiler was found (cc, gcc, clang, or the one named by CC); install one, "
        "or ziglang with: pip install ziglang"
    )


def has_ziglang() -> bool:
    """Whether ziglang, which compiles for other platforms too, is installed."""
    return importlib.util.find_spec("ziglang") is not None


def compiler_for(target: str | None) -> tuple[str, ...]:
    """Command that compiles for a platform, as ziglang names it, or for this machine.

    Raises
    ------
    CompilerError
        If there is none; the message says how to get one.
    """
    return _cross_compiler(target) if target else find_compiler()


def _cross_compiler(target: str) -> tuple[str, ...]:
    if not has_ziglang():
        raise CompilerError(
            f"compiling for {target} needs ziglang; install it with: pip install 'brunovsky[zig]', "
            "or build for this machine alone (platform 'host')"
        )
    return (sys.executable, "-m", "ziglang", "cc", "-target", target)


@lru_cache
def compiler_version(command: tuple[str, ...]) -> str:
    """First line of what the compiler says of itself."""
    done = subprocess.run([*command, "--version"], capture_output=True, text=True, check=False)
    return (done.stdout or done.stderr).partition("\n")[0]


def compile_library(
    sources: Sequence[Path],
    output: Path,
    *,
    include: Sequence[Path] = (),
    defines: Mapping[str, str] | None = None,
    target: str | None = None,
) -> None:
    """Compile C sources to one shared library.

    The object file of each source is kept in the cache, so that the runtime, which is the same for all blocks, is
    compiled once. It is found again by the compiler, its flags, and the content of the source and of the headers
    (``*.h``) beside it and in `include`; a source must not include any other file of its own.

    Parameters
    ----------
    sources : sequence of Path
        C99 files.
    output : Path
        The library; written whole or not at all.
    include : sequence of Path
        Folders searched for headers.
    defines : mapping of str to str, optional
        Macros, each ``-DNAME=VALUE``.
    target : str, optional
        Another platform, as ziglang names it (``aarch64-linux-gnu.2.17``); by default this machine.

    Raises
    ------
    CompilerError
        If there is no compiler or it fails; the message has its command and what it printed.
    """
    compiler = compiler_for(target)
    windows = "windows" in target if target else sys.platform == "win32"
    command = [*compiler, *_FLAGS, *(() if windows else ("-fPIC",))]
    if "ziglang" in command:
        command.append("-fno-sanitize=all")
    linking = ["-shared", *(_linking(target, output.name) if target else ())]
    macros = [f"-D{name}={value}" for name, value in (defines or {}).items()]
    key = "\0".join((*command, *macros, compiler_version(compiler)))
    with tempfile.TemporaryDirectory(dir=output.parent) as folder:
        fresh = Path(folder) / output.name

        headers = {place: _headers_digest(place) for place in {*include, *(one.parent for one in sources)}}

        def compiled(source: Path) -> Path:
            seen = [key, *(headers[place] for place in (source.parent, *include))]
            return _object(source, [*command, *macros], "\0".join(seen), include, Path(folder))

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            objects = list(pool.map(compiled, sources))
        _compile([*command, *linking, "-o", str(fresh), *map(str, objects), "-lm"])
        os.replace(fresh, output)


def _linking(target: str, name: str) -> tuple[str, ...]:
    """Options that leave nothing of this machine in a library: no symbols for debuggers, no path."""
    return ("-s", f"-Wl,-install_name,@rpath/{name}") if "macos" in target else ("-s",)


def _object(source: Path, command: Sequence[str], key: str, include: Sequence[Path], folder: Path) -> Path:
    """Object file of a source: the cache's, or compiled in the folder and kept.

    The key says what compiles it, with which headers.
    """
    digest = hashlib.sha256(f"{key}\0{source.name}\0".encode() + source.read_bytes()).hexdigest()
    kept = cache_folder() / "objects" / f"{source.stem}-{digest[:32]}.o"
    with _compiling[kept]:
        if kept.exists():
            return kept
        fresh = folder / f"{source.stem}.o"
        _compile([*command, *(f"-I{path}" for path in include), "-c", "-o", str(fresh), str(source)])
        return kept if keep(kept, fresh.read_bytes()) else fresh


def keep(path: Path, content: bytes) -> bool:
    """Write a file of the cache whole or not at all; false if it can't be written, which costs time only."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=path.parent) as beside:
            fresh = Path(beside) / path.name
            fresh.write_bytes(content)
            os.replace(fresh, path)
    except OSError:
        return False
    return True


def _headers_digest(folder: Path) -> str:
    digest = hashlib.sha256()
    for path in sorted(folder.glob("*.h")):
        digest.update(f"{path.name}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def _compile(line: Sequence[str]) -> None:
    try:
        done = subprocess.run(line, capture_output=True, text=True, check=False)
    except OSError as error:
        raise CompilerError(f"the C compiler could not be started: {error}") from None
    if done.returncode:
        raise CompilerError(f"the C compiler failed: {shlex.join(line)}\n{done.stderr.strip()}")
