"""modelDescription.xml of FMI 2.0, from the table of variables and the model structure."""

from __future__ import annotations

from collections.abc import Sequence

from lxml import etree

from brunovsky.blocks import Block
from brunovsky.blocks.units import BASE_UNITS, unit_exponents
from brunovsky.fmi.structure import Unknown, model_structure
from brunovsky.fmi.variables import SOLVERS, ScalarVariable, scalar_variables
from brunovsky.native.output_derivatives import output_derivatives

LOG_CATEGORIES = {
    "logEvents": "changes of states, samples and modes at events",
    "logSingularity": "singular becomes true or false",
    "logStatusWarning": "warnings; always logged",
    "logStatusDiscard": "calls with status fmi2Discard; always logged",
    "logStatusError": "calls with status fmi2Error; always logged",
    "logAll": "all of these",
}
STOP_TIME, COMMUNICATION_STEP, TOLERANCE = 10.0, 0.01, 1e-6
_SOLVER_TYPE = "Solver"


def model_description(block: Block, token: str, source_files: Sequence[str], version: str) -> bytes:
    """Text of the modelDescription.xml.

    Parameters
    ----------
    block : Block
        What the FMU runs.
    token : str
        The guid.
    source_files : sequence of str
        C files in ``sources`` that make up the binary.
    version : str
        Of this package, the generation tool.

    Returns
    -------
    bytes
        UTF-8, the same for equal arguments.
    """
    variables = scalar_variables(block)
    root = etree.Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=block.name,
        guid=token,
        description=block.description or block.name,
        generationTool=f"brunovsky {version}",
        variableNamingConvention="structured",
        numberOfEventIndicators=str(len(block.indicators)),
    )
    _interfaces(root, block, source_files)
    _units(root, variables)
    if any(one.type == "Enumeration" for one in variables):
        _solver_type(root)
    categories = etree.SubElement(root, "LogCategories")
    for name, description in LOG_CATEGORIES.items():
        etree.SubElement(categories, "Category", name=name, description=description)
    etree.SubElement(
        root,
        "DefaultExperiment",
        startTime="0.0",
        stopTime=repr(STOP_TIME),
        tolerance=repr(TOLERANCE),
        stepSize=repr(COMMUNICATION_STEP),
    )
    _variables(root, variables)
    _structure(root, block, variables)
    return bytes(etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True))


def _interfaces(root: etree._Element, block: Block, source_files: Sequence[str]) -> None:
    common = {
        "modelIdentifier": block.name,
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
        "providesDirectionalDerivative": "true",
    }
    for tag, own in (
        ("ModelExchange", {"completedIntegratorStepNotNeeded": "false"}),
        ("CoSimulation", {"canHandleVariableCommunicationStepSize": "true", "canInterpolateInputs": "true",
                          "maxOutputDerivativeOrder": str(output_derivatives(block).order)}),
    ):  # fmt: skip
        files = etree.SubElement(etree.SubElement(root, tag, common | own), "SourceFiles")
        for file in source_files:
            etree.SubElement(files, "File", name=file)


def _units(root: etree._Element, variables: Sequence[ScalarVariable]) -> None:
    definitions = etree.SubElement(root, "UnitDefinitions")
    for unit in sorted({one.unit for one in variables if one.type == "Real"}):
        exponents = zip(BASE_UNITS, unit_exponents(unit), strict=True)
        element = etree.SubElement(definitions, "Unit", name=unit)
        etree.SubElement(element, "BaseUnit", {name: str(value) for name, value in exponents if value})


def _solver_type(root: etree._Element) -> None:
    definitions = etree.SubElement(root, "TypeDefinitions")
    simple = etree.SubElement(definitions, "SimpleType", name=_SOLVER_TYPE, description="integration method")
    items = etree.SubElement(simple, "Enumeration")
    for value, (name, description) in enumerate(SOLVERS.items(), 1):
        etree.SubElement(items, "Item", name=name, value=str(value), description=description)


def _variables(root: etree._Element, variables: Sequence[ScalarVariable]) -> None:
    parent = etree.SubElement(root, "ModelVariables")
    indices = {one.name: index for index, one in enumerate(variables, 1)}
    for one in variables:
        attributes = {"name": one.name, "valueReference": str(one.reference), "description": one.description}
        attributes |= {"causality": one.causality, "variability": one.variability}
        if one.initial:
            attributes["initial"] = one.initial
        element = etree.SubElement(parent, "ScalarVariable", attributes)
        value: dict[str, str] = {}
        if one.type == "Real":
            value["unit"] = one.unit
        if one.type == "Enumeration":
            value["declaredType"] = _SOLVER_TYPE
        if one.derivative_of:
            value["derivative"] = str(indices[one.derivative_of])
        if one.reinit:
            value["reinit"] = "true"
        for key, number in (("min", one.minimum), ("max", one.maximum), ("start", one.start)):
            if number is not None:
                value[key] = repr(float(number)) if one.type == "Real" else str(int(number))
        etree.SubElement(element, one.type, value)


def _structure(root: etree._Element, block: Block, variables: Sequence[ScalarVariable]) -> None:
    structure = model_structure(block, variables)
    parent = etree.SubElement(root, "ModelStructure")
    for tag, unknowns in (
        ("Outputs", structure.outputs),
        ("Derivatives", structure.derivatives),
        ("InitialUnknowns", structure.initial_unknowns),
    ):
        if unknowns:
            _unknowns(etree.SubElement(parent, tag), unknowns)


def _unknowns(parent: etree._Element, unknowns: Sequence[Unknown]) -> None:
    for one in unknowns:
        etree.SubElement(
            parent,
            "Unknown",
            index=str(one.index),
            dependencies=" ".join(map(str, one.dependencies)),
            dependenciesKind=" ".join(one.kinds),
        )
