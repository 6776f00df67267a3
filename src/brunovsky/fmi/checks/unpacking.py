"""Unpacking a file that may be hostile: everything is judged by the list of contents before anything is written."""

from __future__ import annotations

import os
import stat
import zipfile
import zlib
from collections.abc import Callable, Collection, Sequence
from pathlib import Path

from brunovsky.errors import BrunovskyError

MAX_ENTRIES = 20_000
MAX_BYTES = 1 << 30
"""Of the file, and of all that it unpacks to."""
MAX_RATIO = 200
"""Unpacked to packed size of an entry larger than ``RATIO_FROM``; text and binaries reach some tens."""
RATIO_FROM = 1 << 20
MAX_DEPTH = 32


def unpack_fmu(path: Path, folder: Path) -> None:
    """Unpack an FMU into a folder.

    Parameters
    ----------
    path : Path
        The FMU.
    folder : Path
        Exists and is empty; nothing is written elsewhere.

    Raises
    ------
    BrunovskyError
        If it isn't a zip archive, leaves the folder, is a bomb, or has no description or binaries. Nothing has been
        unpacked then, unless its content contradicts its own list.
    """
    _unpack(path, folder, "an FMU", _problem_of_fmu)


def unpack_ssp(path: Path, folder: Path) -> None:
    """Unpack a system structure package into a folder; the FMUs in it stay packed.

    Parameters and exceptions are those of :func:`unpack_fmu`; it must have a ``SystemStructure.ssd``.
    """
    _unpack(path, folder, "an SSP", _problem_of_ssp)


def _unpack(path: Path, folder: Path, kind: str, missing: Callable[[Collection[str]], str]) -> None:
    if not path.exists():
        raise BrunovskyError(f"{path}: there is no such file; name {kind}")
    if not path.is_file():
        raise BrunovskyError(f"{path}: not a file; name {kind}, not the folder it was unpacked to")
    if path.stat().st_size > MAX_BYTES:
        raise BrunovskyError(f"{path}: refused: larger than {MAX_BYTES >> 20} MiB")
    try:
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
            names = [entry.filename for entry in entries]
            problem = problem_of(entries) or missing({name for name in names if not name.endswith("/")})
            if problem:
                raise BrunovskyError(f"{path}: refused, nothing was unpacked: {problem}")
            for entry in entries:
                archive.extract(entry, folder)
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, UnicodeError, ValueError) as error:
        raise BrunovskyError(f"{path}: not a zip archive that can be read ({error}); build or fetch it again") from None
    except OSError as error:
        raise BrunovskyError(f"{path}: cannot be unpacked: {error.strerror or error}") from None


def problem_of(entries: Sequence[zipfile.ZipInfo]) -> str:
    """Why these entries must not be unpacked, or an empty text."""
    if len(entries) > MAX_ENTRIES:
        return f"it has {len(entries)} entries, more than {MAX_ENTRIES}"
    for entry in entries:
        problem = _problem_of_name(entry.orig_filename) or _problem_of_entry(entry)
        if problem:
            return f"entry {entry.orig_filename[:80]!r} {problem}"
    total = sum(entry.file_size for entry in entries)
    if total > MAX_BYTES:
        return f"it unpacks to {total >> 20} MiB, more than {MAX_BYTES >> 20}"
    return _problem_of_tree([entry.filename for entry in entries])


def _problem_of_name(name: str) -> str:
    parts = name.rstrip("/").split("/")
    if name.startswith("/") or ":" in name:
        return "is an absolute path"
    if "\\" in name:
        return "has a backslash; the standard asks for forward slashes"
    if ".." in parts:
        return "leaves the folder"
    if any(part in ("", ".") for part in parts) or any(ord(letter) < 32 or ord(letter) == 127 for letter in name):
        return "is not a plain path"
    if len(parts) > MAX_DEPTH or any(len(os.fsencode(part)) > 255 for part in parts):
        return "is too long"
    return ""


def _problem_of_entry(entry: zipfile.ZipInfo) -> str:
    if stat.S_IFMT(entry.external_attr >> 16) not in (0, stat.S_IFREG, stat.S_IFDIR):
        return "is a link or device"
    if entry.flag_bits & 1:
        return "is encrypted"
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        return "has a compression that the standard doesn't allow; use deflate"
    if entry.file_size > RATIO_FROM and entry.file_size > MAX_RATIO * max(entry.compress_size, 1):
        return f"unpacks to {entry.file_size / max(entry.compress_size, 1):.0f} times its size, as bombs do"
    return ""


def _problem_of_tree(names: Sequence[str]) -> str:
    files = [name for name in names if not name.endswith("/")]
    known = set(files)
    if len({name.casefold() for name in files}) < len(files):
        return "two entries have the same name, or differ in case alone"
    for name in names:
        parts = name.rstrip("/").split("/")
        if any("/".join(parts[:depth]) in known for depth in range(1, len(parts))) or name.rstrip("/") in known - {
            name
        }:
            return f"entry {name[:80]!r} is both a file and a folder"
    return ""


def _problem_of_fmu(files: Collection[str]) -> str:
    if "modelDescription.xml" not in files:
        return "it has no modelDescription.xml at its top, so that it isn't an FMU"
    if not any(name.startswith("binaries/") and name.count("/") > 1 for name in files):
        return "it has no binaries; compile its sources first, they can't be run as they are"
    return ""


def _problem_of_ssp(files: Collection[str]) -> str:
    if "SystemStructure.ssd" not in files:
        return "it has no SystemStructure.ssd at its top, so that it isn't an SSP"
    return ""
