"""Which files of a folder a report wrote, so that the next report there removes those that it does not write itself."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from brunovsky.comparison.output import write_bytes, write_text

NAME = "manifest.json"
_FOLDERS = ("traces", "tables")
_ALONE = ("report.html", "report.pdf", "metrics.json", "protocols.json")


class ReportFolder:
    """A folder while a report is written into it.

    Each file is entered in ``manifest.json`` before it is written, beside those of the report before, so that one which
    was interrupted leaves nothing that no later report knows.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._before = _read(folder / NAME)
        self._own: dict[str, str] = {}

    def write(self, path: Path, data: bytes) -> None:
        """Write a file of the folder; whatever goes wrong, it is the old one or the new one."""
        name = path.relative_to(self._folder).as_posix()
        self._own[name] = hashlib.sha256(data).hexdigest()
        known = {one: set(hashes) for one, hashes in self._before.items()}
        known.setdefault(name, set()).add(self._own[name])
        self._before = known
        path.parent.mkdir(parents=True, exist_ok=True)
        self._save(known)
        write_bytes(path, data)

    def finish(self) -> tuple[Path, ...]:
        """Remove what an earlier report wrote and this one did not, unless it was changed since; say what it was."""
        own = {name.casefold() for name in self._own}  # names may differ in case alone where the file is the same
        stale = [name for name in self._before if name.casefold() not in own]
        gone = tuple(path for name in stale if (path := self._untouched(name)) is not None)
        for path in gone:
            path.unlink()
        self._save({name: {digest} for name, digest in self._own.items()})
        return gone

    def _untouched(self, name: str) -> Path | None:
        """Path of a file that is there and has the bytes that a report wrote."""
        path = self._folder / name
        if path.is_symlink() or path.parent.is_symlink() or not path.is_file():
            return None
        return path if hashlib.sha256(path.read_bytes()).hexdigest() in self._before[name] else None

    def _save(self, known: Mapping[str, set[str]]) -> None:
        files = {name: sorted(hashes) for name, hashes in sorted(known.items())}
        text = json.dumps({"written_by": "brunovsky compare", "sha256": files}, indent=1) + "\n"
        write_text(self._folder / NAME, text)


def _read(path: Path) -> dict[str, set[str]]:
    """Files that an earlier report entered; none where there is no manifest, or one that no report wrote."""
    try:
        files = json.loads(path.read_text(encoding="utf-8"))["sha256"]
        return {name: {str(one) for one in hashes} for name, hashes in files.items() if _is_of_a_report(name)}
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return {}


def _is_of_a_report(name: str) -> bool:
    """Whether a report writes files of such a name: nothing outside the folder, nothing deeper in it."""
    parts = PurePosixPath(name).parts
    if name != "/".join(parts) or "\\" in name:
        return False
    return name in _ALONE or (
        len(parts) == 2 and parts[0] in _FOLDERS and PurePosixPath(name).suffix in (".nc", ".csv")
    )
