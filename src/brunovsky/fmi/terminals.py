"""terminalsAndIcons.xml of FMI 3.0, which FMI 2.0.4 took over as it is: bundles of variables that belong together.

A plant with chains, an outer loop and a reference meet in three bundles, each of which a master connects as one:
``chains``, the elements ``Zi[k]``; ``reference``, their references ``Zid[k]`` and the derivatives ``zdr[i]``;
``command``, the inputs ``v[i]`` of the chains.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from lxml import etree

from brunovsky.blocks import Block
from brunovsky.fmi.definitions import xml_text

_KINDS = {
    "chains": (r"Z\d+(\[\d+\])?", "state of the chains of integrators"),
    "reference": (r"(Z\d+d|zd\d+)(\[\d+\])?", "reference of the chains and its highest derivatives"),
    "command": (r"v(\[\d+\])?", "inputs of the chains"),
}
_KIND = "brunovsky."


def terminals(block: Block, names: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Variables of each terminal that a block has, in the order of declaration.

    Parameters
    ----------
    block : Block
        Its inputs and outputs are looked at.
    names : sequence of str
        Names that the description shows: those of the elements, or those of arrays.
    """
    shown = {one.name for one in (*block.inputs, *block.outputs)}
    shown |= {one.partition("[")[0] for one in shown}
    ports = [one for one in names if one in shown]
    found = {kind: tuple(one for one in ports if re.fullmatch(form, one)) for kind, (form, _) in _KINDS.items()}
    return {kind: members for kind, members in found.items() if members}


def terminals_and_icons(block: Block, names: Sequence[str]) -> bytes:
    """Text of the terminalsAndIcons.xml.

    Terminals fit by the rule ``plug``: two connect where they have the same members.

    Returns
    -------
    bytes
        UTF-8, the same for equal arguments.
    """
    root = etree.Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    graphics = etree.SubElement(root, "GraphicalRepresentation")
    corners = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
    etree.SubElement(graphics, "CoordinateSystem", corners, suggestedScalingFactorTo_mm="0.1")
    etree.SubElement(graphics, "Icon", corners)
    found = terminals(block, names)
    if found:
        parent = etree.SubElement(root, "Terminals")
        for kind, members in found.items():
            terminal = etree.SubElement(
                parent,
                "Terminal",
                name=kind,
                matchingRule="plug",
                terminalKind=_KIND + kind,
                description=_KINDS[kind][1],
            )
            for name in members:
                etree.SubElement(
                    terminal, "TerminalMemberVariable", variableName=name, memberName=name, variableKind="signal"
                )
    return xml_text(root)
