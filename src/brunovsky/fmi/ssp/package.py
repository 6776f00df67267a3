"""The SSP file of a diagram: descriptions, parameter sets, mapping and FMUs, zipped with the same bytes each time."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from brunovsky.blocks import Diagram
from brunovsky.errors import BrunovskyError, ModelError, ParameterError
from brunovsky.fmi.archive import export_fmus, packed, write_whole
from brunovsky.fmi.ssp.description import MAPPING_FILE, structure_description
from brunovsky.fmi.ssp.elements import FMI_VERSION
from brunovsky.fmi.ssp.parameters import mapping_file, parameter_file
from brunovsky.fmi.ssp.variant import Variant
from brunovsky.fmi.ssp.wiring import wiring

_DEFAULT = Variant("default")


def export_ssp(
    diagram: Diagram,
    path: str | os.PathLike[str],
    *,
    ssp_version: int = 1,
    variants: Sequence[Variant] = (_DEFAULT,),
    platforms: Sequence[str] = ("host",),
    system_connectors: bool = True,
) -> Path:
    """Write a system structure package: one FMU for each component of a diagram, and how they are connected.

    A component that is a diagram itself, such as the linearised robot, is one FMU: what it connects is solved together.
    All parameters of the diagram are bound twice with equal values, as masters differ in what they read: at the system,
    by ``resources/VARIANT.ssv`` under the diagram's names, which ``resources/parameters.ssm`` maps to the components'
    (a shared one to several); and at each component, inline, under the names of its FMU.

    The file is written whole or not at all, and has the same bytes for equal arguments on the same machine.

    Parameters
    ----------
    diagram : Diagram
        Of two components or more.
    path : path
        Of the package; missing folders are made.
    ssp_version : int
        1: SSP 1.0 with FMI 2.0 FMUs; 2: SSP 2.0 with FMI 3.0 FMUs.
    variants : sequence of Variant
        Parameter values and stop times; the first one is ``SystemStructure.ssd``, each other one ``NAME.ssd``.
    platforms : sequence of str
        As those of :func:`export_fmu`.
    system_connectors : bool
        Whether inputs and outputs of the diagram are connectors of the system, connected to those behind them. Without
        them what nothing drives keeps its start value; some masters read connections between components only.

    Returns
    -------
    Path
        Of the package.

    Raises
    ------
    ModelError
        If it is not a diagram or has one component only; for SSP 1.0 of a component with clocks.
    ParameterError
        For a version or platform that cannot be built, variants that are none or share a name, and values that are
        unknown or out of range.
    CompilerError
        If there is no C compiler or it fails.
    BrunovskyError
        If the file cannot be written.

    References
    ----------
    Modelica Association, System Structure and Parameterization, versions 1.0 (2019) and 2.0 (2024),
    https://ssp-standard.org.
    """
    _check(diagram, ssp_version, variants)
    target = Path(path)
    files = _files(diagram, ssp_version, variants, platforms, system_connectors)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        write_whole(target, packed(files))
    except OSError as error:
        raise BrunovskyError(f"the SSP {target} cannot be written: {error.strerror or error}") from None
    return target


def _check(diagram: Diagram, ssp_version: int, variants: Sequence[Variant]) -> None:
    if not isinstance(diagram, Diagram):
        raise ModelError(
            f"export_ssp takes a Diagram, not {diagram!r}; a block that is not made of others is an FMU: export_fmu"
        )
    if len(diagram.components) < 2:
        raise ModelError(f"{diagram.name} has one component only, nothing to connect; export it with export_fmu")
    if ssp_version not in FMI_VERSION:
        raise ParameterError(f"SSP {ssp_version} is not available; use ssp_version=1 or ssp_version=2")
    clocked = [key for key, block in diagram.components.items() if block.clocks]
    if clocked and ssp_version == 1:
        raise ModelError(
            f"{diagram.name}: {', '.join(clocked)} has clocks, which the FMI 2 FMUs of SSP 1.0 do not know; "
            "use ssp_version=2"
        )
    names = [one.name for one in variants]
    if not names or len(set(names)) < len(names):
        raise ParameterError(
            f"{diagram.name}: the variants are {', '.join(names) or 'none'}; give at least one, each under its own name"
        )
    if "SystemStructure" in names[1:]:
        raise ParameterError(f"{diagram.name}: only the first variant can be called SystemStructure; rename the other")


def _files(
    diagram: Diagram, ssp_version: int, variants: Sequence[Variant], platforms: Sequence[str], system_connectors: bool
) -> Mapping[str, bytes]:
    from brunovsky import __version__  # known only when the package is imported whole

    tool = f"brunovsky {__version__}"
    plan = wiring(diagram, FMI_VERSION[ssp_version], system_connectors)
    fmus = {name: f"resources/{re.sub(r'[^A-Za-z0-9_]', '_', name)}.fmu" for name in diagram.components}
    if len(set(fmus.values())) < len(fmus):
        raise ModelError(f"{diagram.name}: the names of two components differ in punctuation only; rename one")
    files = {}
    for number, variant in enumerate(variants):
        ssd = f"{variant.name}.ssd" if number else "SystemStructure.ssd"
        files[ssd] = structure_description(diagram, plan, variant, fmus, ssp_version, tool)
        if plan.parameters:
            files[f"resources/{variant.name}.ssv"] = parameter_file(diagram, variant, ssp_version, tool)
    if plan.parameters:
        files[MAPPING_FILE] = mapping_file(plan, ssp_version, tool)
    with tempfile.TemporaryDirectory(prefix="brunovsky-") as folder:
        parts = ((block, Path(folder, name), FMI_VERSION[ssp_version]) for name, block in diagram.components.items())
        for name, fmu in zip(diagram.components, export_fmus(parts, platforms), strict=True):
            files[fmus[name]] = fmu.read_bytes()
    return files
