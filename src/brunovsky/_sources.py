"""What the running code was loaded from, so that what is kept on disk can be told from what other code made."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Iterable
from functools import lru_cache
from pathlib import Path

_LOADED = time.time()
_GRANULARITY = 2.0
"""Seconds by which the times of files may be off: FAT counts in twos."""


@lru_cache(maxsize=1)
def package_digest() -> str | None:
    """Hash of the package's Python files, which are read once; see :func:`loaded_digest`."""
    return loaded_digest(Path(__file__).parent, _LOADED)


def loaded_digest(folder: Path, loaded: float) -> str | None:
    """Hash of the Python files of a package that was loaded at a time.

    Parameters
    ----------
    folder : Path
        Of the package.
    loaded : float
        When, in s as the times of files.

    Returns
    -------
    str or None
        None where it can't be known that these files are what runs: there are none, or one has changed since.
    """
    files = sorted(folder.rglob("*.py"))
    try:
        digest = files_digest(files, folder)
        changed = [max(one.st_mtime, one.st_ctime) for one in map(Path.stat, files)]
    except OSError:
        return None
    return digest if changed and max(changed) < loaded - _GRANULARITY else None


def files_digest(files: Iterable[Path], folder: Path) -> str:
    """Hash of names, relative to a folder, and contents; may raise ``OSError``."""
    digest = hashlib.sha256()
    for one in files:
        digest.update(f"{one.relative_to(folder).as_posix()}\0".encode() + hashlib.sha256(one.read_bytes()).digest())
    return digest.hexdigest()
