"""Where the files beside the Python code are: in the wheel's data folder, or in a source checkout."""

from pathlib import Path

from brunovsky.errors import BrunovskyError

_PACKAGE = Path(__file__).parent


def resource(*parts: str) -> Path:
    """Path of a file or folder that ships with the package, such as ``resource("fmu", "runtime")``."""
    for root in (_PACKAGE.parents[1], _PACKAGE / "_data"):
        path = root.joinpath(*parts)
        if path.exists() and (root / "fmu" / "runtime").is_dir():
            return path
    raise BrunovskyError(f"{'/'.join(parts)} is missing from this installation; reinstall the package")


def runtime_folder() -> Path:
    """Folder with the C runtime that the native simulation and the FMUs share."""
    return resource("fmu", "runtime")
