"""The FMUs that ship, as ``fmu/manifest.toml`` lists them."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping

from brunovsky._resources import resource
from brunovsky.blocks import Block, library
from brunovsky.errors import ParameterError
from brunovsky.fmi.contents import FMI_VERSIONS


def shipped_fmus(fmi_version: int | None = None) -> Mapping[str, str]:
    """Description of each FMU that ships, by the name of its block, in the order of the manifest.

    Parameters
    ----------
    fmi_version : {2, 3}, optional
        Only those that there are for this version of the standard.
    """
    listed = tomllib.loads(resource("fmu", "manifest.toml").read_text(encoding="utf-8"))["fmu"]
    chosen = (one for one in listed if fmi_version is None or fmi_version in one.get("fmi", FMI_VERSIONS))
    return {one["block"]: one["description"] for one in chosen}


def shipped_block(name: str) -> Block:
    """Block of an FMU that ships.

    Raises
    ------
    ParameterError
        If the manifest doesn't list it.
    """
    names = shipped_fmus()
    if name not in names:
        raise ParameterError(f"there is no FMU '{name}' in the manifest; there are {', '.join(names)}")
    block: Block = getattr(library, name)()
    return block
