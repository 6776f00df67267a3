"""What all files of a package share: namespaces, types and units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from lxml import etree

from brunovsky.blocks.units import BASE_UNITS, unit_exponents

FMI_VERSION = {1: 2, 2: 3}
"""Version of the FMUs in a package, by the version of SSP."""

FORMAT = {1: "1.0", 2: "2.0"}
"""Version that the files of a package name."""

NAMESPACES = {
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssc": "http://ssp-standard.org/SSP1/SystemStructureCommon",
    "ssv": "http://ssp-standard.org/SSP1/SystemStructureParameterValues",
    "ssm": "http://ssp-standard.org/SSP1/SystemStructureParameterMapping",
}
"""Of both versions; the standard kept them for SSP 2.0."""

TYPES: Mapping[int, Mapping[str, str]] = {1: {}, 2: {"Real": "Float64", "Integer": "Int32"}}
"""Names of types where they are not those of FMI 2."""


def root(name: str, attributes: Mapping[str, str]) -> etree._Element:
    """Root element of a file; ``name`` is written ``ssd:SystemStructureDescription``."""
    return etree.Element(tag(name), attributes, nsmap=NAMESPACES)


def tag(name: str) -> str:
    """Qualified name of ``prefix:Name``."""
    prefix, _, local = name.partition(":")
    return f"{{{NAMESPACES[prefix]}}}{local}"


def child(parent: etree._Element, name: str, attributes: Mapping[str, str] | None = None) -> etree._Element:
    """New element below a parent."""
    return etree.SubElement(parent, tag(name), attributes or {})


def add_units(parent: etree._Element, prefix: str, units: Iterable[str]) -> None:
    """Definitions of units, by their exponents of base units, as element ``Units`` of this namespace."""
    names = sorted(set(units))
    if not names:
        return
    definitions = child(parent, f"{prefix}:Units")
    for name in names:
        exponents = zip(BASE_UNITS, unit_exponents(name), strict=True)
        element = child(definitions, "ssc:Unit", {"name": name})
        child(element, "ssc:BaseUnit", {base: str(value) for base, value in exponents if value})


def number(value: float) -> str:
    """A coordinate or time: the shortest text that reads back the same."""
    return repr(round(float(value), 6) + 0.0)
