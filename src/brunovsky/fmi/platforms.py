"""Platforms that FMUs are built for: their names in both versions of the standard, and what compiles for them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import fmpy

from brunovsky.errors import ParameterError

HOST = "host"
ALL = "all"


@dataclass(frozen=True)
class Platform:
    """A platform with a folder of its own in ``binaries``.

    Parameters
    ----------
    name : str
        Platform tuple of FMI 3.0 (and of FMI 2.0.4 where this has no older name).
    fmi2 : str
        Folder in FMI 2.
    suffix : str
        File name ending of its shared libraries.
    target : str
        What ziglang calls it; empty where only this machine's own compiler can compile.
    """

    name: str
    fmi2: str
    suffix: str
    target: str = ""

    def folder(self, fmi_version: int) -> str:
        """Folder in ``binaries``."""
        return self.fmi2 if fmi_version == 2 else self.name


PLATFORMS = (
    Platform("x86_64-linux", "linux64", ".so", "x86_64-linux-gnu.2.17"),
    Platform("aarch64-linux", "aarch64-linux", ".so", "aarch64-linux-gnu.2.17"),
    Platform("x86_64-windows", "win64", ".dll", "x86_64-windows-gnu"),
    Platform("x86_64-darwin", "darwin64", ".dylib", "x86_64-macos"),
    Platform("aarch64-darwin", "aarch64-darwin", ".dylib", "aarch64-macos"),
)
"""All that ziglang compiles for from any machine; glibc 2.17 is of 2012."""

UNIVERSAL = "darwin64"
"""Folder of FMI 2 for macOS, whose library runs on both processors where both are built."""

NAMES = tuple(one.name for one in PLATFORMS)


def host_platform() -> Platform:
    """The machine that runs this, with its own compiler."""
    name = str(fmpy.platform_tuple)
    folders = {one.name: one.fmi2 for one in PLATFORMS}
    return Platform(name, folders.get(name, str(fmpy.platform)), str(fmpy.sharedLibraryExtension))


def chosen_platforms(names: Iterable[str], fmi_version: int) -> tuple[Platform, ...]:
    """Platforms by ``"host"``, ``"all"``, platform tuple or folder of FMI 2, each once.

    Raises
    ------
    ParameterError
        If none is named, or one is unknown.
    """
    known = {one.name: (one,) for one in PLATFORMS} | {HOST: (host_platform(),), ALL: PLATFORMS}
    if fmi_version == 2:
        known |= {one.fmi2: (one,) for one in PLATFORMS} | {UNIVERSAL: PLATFORMS[3:]}
    found: dict[str, Platform] = {}
    for name in names:
        if name not in known:
            raise ParameterError(
                f"platform '{name}' is not available in FMI {fmi_version}; there are {', '.join(known)}. "
                "The FMU has its sources: compile them on any other machine"
            )
        found |= {one.name: one for one in known[name]}
    if not found:
        raise ParameterError(f"no platform was named; name '{HOST}' ({host_platform().name}) or '{ALL}'")
    return tuple(found.values())
