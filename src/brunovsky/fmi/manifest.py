"""The FMUs that ship, as ``fmu/manifest.toml`` lists them."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from typing import Any

from brunovsky._resources import resource
from brunovsky.blocks import Block, library
from brunovsky.errors import ParameterError
from brunovsky.fmi.contents import FMI_VERSIONS


def shipped_fmus() -> Mapping[str, str]:
    """Description of each FMU that ships, by the name of its block, in the order of the manifest."""
    return {one["block"]: one["description"] for one in _listed()}


def shipped_block(name: str) -> Block:
    """Block of an FMU that ships.

    Raises
    ------
    ParameterError
        If the manifest doesn't list it.
    """
    _entry(name)
    block: Block = getattr(library, name)()
    return block


def shipped_versions(name: str) -> tuple[int, ...]:
    """Versions of FMI in which an FMU ships: both, unless its manifest entry has a list ``fmi``.

    Raises
    ------
    ParameterError
        If the manifest doesn't list it.
    """
    return tuple(_entry(name).get("fmi", FMI_VERSIONS))


def _listed() -> list[dict[str, Any]]:
    listed: list[dict[str, Any]] = tomllib.loads(resource("fmu", "manifest.toml").read_text(encoding="utf-8"))["fmu"]
    return listed


def _entry(name: str) -> dict[str, Any]:
    entries = {one["block"]: one for one in _listed()}
    if name not in entries:
        raise ParameterError(f"there is no FMU '{name}' in the manifest; there are {', '.join(entries)}")
    return entries[name]
