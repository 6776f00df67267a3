"""modelDescription.xml of FMI 2.0, from the table of variables and the model structure."""

from __future__ import annotations

from collections.abc import Sequence

from lxml import etree

from brunovsky.blocks import Block
from brunovsky.fmi.definitions import (
    SOLVER_DESCRIPTION,
    SOLVER_TYPE,
    add_default_experiment,
    add_log_categories,
    add_solvers,
    add_units,
    number_text,
    root_element,
    xml_text,
)
from brunovsky.fmi.indicators import indicators
from brunovsky.fmi.interfaces import refused_interfaces
from brunovsky.fmi.structure import Unknown, model_structure
from brunovsky.fmi.variables import ScalarVariable, scalar_variables
from brunovsky.native.output_derivatives import output_derivatives


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
    own = {"fmiVersion": "2.0", "guid": token, "numberOfEventIndicators": str(len(indicators(block)))}
    root = root_element(block, version, own)
    _interfaces(root, block, source_files)
    add_units(root, variables)
    if any(one.type == "Enumeration" for one in variables):
        _solver_type(root)
    add_log_categories(root)
    add_default_experiment(root)
    _variables(root, variables)
    _structure(root, block, variables)
    return xml_text(root)


def _interfaces(root: etree._Element, block: Block, source_files: Sequence[str]) -> None:
    common = {
        "modelIdentifier": block.name,
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canNotUseMemoryManagementFunctions": "true",
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
        "providesDirectionalDerivative": "true",
    }
    flags = {
        "ModelExchange": {"completedIntegratorStepNotNeeded": "false"},
        "CoSimulation": {
            "canHandleVariableCommunicationStepSize": "true",
            "canInterpolateInputs": "true",
            "maxOutputDerivativeOrder": str(output_derivatives(block).order),
        },
    }
    refused = refused_interfaces(block)
    for tag, own in flags.items():
        if tag in refused:
            continue
        files = etree.SubElement(etree.SubElement(root, tag, common | own), "SourceFiles")
        for file in source_files:
            etree.SubElement(files, "File", name=file)


def _solver_type(root: etree._Element) -> None:
    definitions = etree.SubElement(root, "TypeDefinitions")
    simple = etree.SubElement(definitions, "SimpleType", name=SOLVER_TYPE, description=SOLVER_DESCRIPTION)
    add_solvers(etree.SubElement(simple, "Enumeration"))


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
            value["declaredType"] = SOLVER_TYPE
        if one.derivative_of:
            value["derivative"] = str(indices[one.derivative_of])
        if one.reinit:
            value["reinit"] = "true"
        numbers = {"min": one.minimum, "max": one.maximum, "nominal": one.nominal if one.nominal != 1 else None}
        for key, number in (numbers | {"start": one.start}).items():
            if number is not None:
                value[key] = number_text(number, one.type)
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
