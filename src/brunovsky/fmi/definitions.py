"""What the modelDescription.xml of both versions defines alike: units, types, log categories, default experiment."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from lxml import etree

from brunovsky.blocks import Block
from brunovsky.blocks.units import BASE_UNITS, unit_exponents
from brunovsky.fmi.variables import SOLVERS, ScalarVariable

LOG_CATEGORIES = {
    "logEvents": "changes of states, samples and modes at events",
    "logSingularity": "singular becomes true or false",
    "logStatusWarning": "warnings",
    "logStatusDiscard": "calls with the status Discard",
    "logStatusError": "calls with the status Error; always logged",
    "logAll": "all of these",
}
STOP_TIME, COMMUNICATION_STEP, TOLERANCE = 10.0, 0.01, 1e-6
SOLVER_TYPE = "Solver"
SOLVER_DESCRIPTION = "integration method"


def root_element(block: Block, version: str, attributes: Mapping[str, str]) -> etree._Element:
    """Root of a modelDescription.xml: the model, the tool of this version, and these attributes of the standard's."""
    return etree.Element(
        "fmiModelDescription",
        {
            "fmiVersion": attributes["fmiVersion"],
            "modelName": block.name,
            **{key: value for key, value in attributes.items() if key != "fmiVersion"},
            "description": block.description or block.name,
            "generationTool": f"brunovsky {version}",
            "variableNamingConvention": "structured",
        },
    )


def add_units(root: etree._Element, variables: Iterable[ScalarVariable]) -> None:
    """Definitions of the units of all real variables, by their exponents of base units."""
    definitions = etree.SubElement(root, "UnitDefinitions")
    for unit in sorted({one.unit for one in variables if one.type == "Real"}):
        exponents = zip(BASE_UNITS, unit_exponents(unit), strict=True)
        element = etree.SubElement(definitions, "Unit", name=unit)
        etree.SubElement(element, "BaseUnit", {name: str(value) for name, value in exponents if value})


def add_solvers(parent: etree._Element) -> None:
    """Items of the enumeration of solvers."""
    for value, (name, description) in enumerate(SOLVERS.items(), 1):
        etree.SubElement(parent, "Item", name=name, value=str(value), description=description)


def add_log_categories(root: etree._Element) -> None:
    """Log categories, in the order in which the runtime knows them."""
    categories = etree.SubElement(root, "LogCategories")
    for name, description in LOG_CATEGORIES.items():
        etree.SubElement(categories, "Category", name=name, description=description)


def add_default_experiment(root: etree._Element) -> None:
    """Default experiment."""
    etree.SubElement(
        root,
        "DefaultExperiment",
        startTime="0.0",
        stopTime=repr(STOP_TIME),
        tolerance=repr(TOLERANCE),
        stepSize=repr(COMMUNICATION_STEP),
    )


def number_text(value: float, kind: str) -> str:
    """A number of a variable of this type, as the standard writes it."""
    return repr(float(value)) if kind == "Real" else str(int(value))


def xml_text(root: etree._Element) -> bytes:
    """UTF-8 text of a file, the same for equal trees."""
    return bytes(etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True))
