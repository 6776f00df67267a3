"""modelDescription.xml of FMI 3.0, from the table of variables and the model structure."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from lxml import etree

from brunovsky.blocks import Block
from brunovsky.fmi.arrays import ArrayVariable, array_variables
from brunovsky.fmi.clocking import clock_priorities
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
from brunovsky.fmi.interfaces import refused_interfaces
from brunovsky.fmi.structure import Unknown, model_structure
from brunovsky.fmi.variables import scalar_variables
from brunovsky.native.output_derivatives import output_derivatives

_TYPES = {"Real": "Float64", "Integer": "Int32"}
_KINDS = ("constant", "fixed", "tunable", "discrete", "dependent")
"""Kinds of dependency, each weaker than those before."""

_COMMON = (
    "canGetAndSetFMUState",
    "canSerializeFMUState",
    "providesDirectionalDerivatives",
    "providesAdjointDerivatives",
    "providesPerElementDependencies",
)
_MODEL_EXCHANGE: tuple[str, ...] = ("needsCompletedIntegratorStep", "providesEvaluateDiscreteStates")
_CO_SIMULATION = (
    "canHandleVariableCommunicationStepSize",
    "providesIntermediateUpdate",
    "mightReturnEarlyFromDoStep",
    "canReturnEarlyAfterIntermediateUpdate",
    "hasEventMode",
    "providesEvaluateDiscreteStates",
)


def model_description(block: Block, token: str, version: str, arrays: bool = False) -> bytes:
    """Text of the modelDescription.xml.

    Parameters
    ----------
    block : Block
        What the FMU runs.
    token : str
        The instantiation token.
    version : str
        Of this package, the generation tool.
    arrays : bool
        Whether elements of one name are merged into array variables.

    Returns
    -------
    bytes
        UTF-8, the same for equal arguments.
    """
    scalars = scalar_variables(block, fmi_version=3)
    variables = array_variables(scalars, arrays)
    root = root_element(block, version, {"fmiVersion": "3.0", "instantiationToken": token})
    _interfaces(root, block)
    add_units(root, scalars)
    if any(one.type == "Enumeration" for one in scalars):
        _solver_type(root)
    add_log_categories(root)
    add_default_experiment(root)
    _variables(root, block, variables)
    _structure(root, block, variables)
    return xml_text(root)


def _interfaces(root: etree._Element, block: Block) -> None:
    flags = {"ModelExchange": _MODEL_EXCHANGE, "CoSimulation": _CO_SIMULATION, "ScheduledExecution": ()}
    refused = refused_interfaces(block)
    for tag, own in flags.items():
        if tag in refused:
            continue
        element = etree.SubElement(root, tag, modelIdentifier=block.name)
        element.set("canBeInstantiatedOnlyOncePerProcess", "false")
        element.attrib.update(dict.fromkeys((*_COMMON, *own), "true"))
        if tag == "CoSimulation":
            element.set("maxOutputDerivativeOrder", str(output_derivatives(block).order))


def _solver_type(root: etree._Element) -> None:
    definitions = etree.SubElement(root, "TypeDefinitions")
    add_solvers(etree.SubElement(definitions, "EnumerationType", name=SOLVER_TYPE, description=SOLVER_DESCRIPTION))


def _variables(root: etree._Element, block: Block, variables: Sequence[ArrayVariable]) -> None:
    parent = etree.SubElement(root, "ModelVariables")
    scalars = [element for one in variables for element in one.elements]
    references = {one.name: one.reference for one in scalars} | {one.name: one.first.reference for one in variables}
    for one in variables:
        first = one.first
        attributes = {"name": one.name, "valueReference": str(first.reference), "description": one.description}
        attributes |= {"causality": first.causality, "variability": first.variability}
        if first.clocks:
            attributes["clocks"] = " ".join(str(references[name]) for name in first.clocks)
        if first.type == "Clock":
            etree.SubElement(parent, "Clock", attributes | _interval(block, first.name))
            continue
        attributes |= _values(one)
        if first.derivative_of:
            attributes["derivative"] = str(references[first.derivative_of])
        element = etree.SubElement(parent, _TYPES.get(first.type, first.type), attributes)
        for size in one.shape:
            etree.SubElement(element, "Dimension", start=str(size))


def _values(one: ArrayVariable) -> dict[str, str]:
    first = one.first
    values: dict[str, str] = {}
    if first.causality in ("input", "output") and first.variability == "continuous":
        values["intermediateUpdate"] = "true"
    if first.type == "Enumeration":
        values["declaredType"] = SOLVER_TYPE
    if first.initial:
        values["initial"] = first.initial
    if first.type == "Real":
        values["unit"] = first.unit
    for key, name in (("min", "minimum"), ("max", "maximum"), ("nominal", "nominal")):
        number = one.common(name)
        if number is not None and (key, number) != ("nominal", 1.0):
            values[key] = number_text(number, first.type)
    starts = [element.start for element in one.elements if element.start is not None]
    if starts:
        values["start"] = " ".join(number_text(number, first.type) for number in starts)
    if any(element.reinit for element in one.elements):
        values["reinit"] = "true"
    return values


def _interval(block: Block, name: str) -> dict[str, str]:
    """Attributes of an input clock: its period is a number, or a parameter that is fixed."""
    period = next(one.period for one in block.clocks if one.name == name)
    defaults = {one.symbol: one.value for one in block.parameters}
    variability, value = ("fixed", defaults[period]) if period in defaults else ("constant", float(period))
    priority = str(clock_priorities(block)[name])
    return {"priority": priority, "intervalVariability": variability, "intervalDecimal": repr(value)}


def _structure(root: etree._Element, block: Block, variables: Sequence[ArrayVariable]) -> None:
    scalars = [element for one in variables for element in one.elements]
    shown = {element.name: one for one in variables for element in one.elements}
    owners = [shown[element.name].first.reference for element in scalars]
    clocked = {index for index, one in enumerate(scalars, 1) if one.clocks}
    structure = model_structure(block, scalars, fmi_version=3)
    parent = etree.SubElement(root, "ModelStructure")
    for tag, unknowns in (
        ("Output", structure.outputs),
        ("ContinuousStateDerivative", structure.derivatives),
        ("InitialUnknown", [one for one in structure.initial_unknowns if one.index not in clocked]),
        ("EventIndicator", structure.event_indicators),
    ):
        for reference, kinds in _merged(unknowns, owners).items():
            etree.SubElement(
                parent,
                tag,
                valueReference=str(reference),
                dependencies=" ".join(map(str, kinds)),
                dependenciesKind=" ".join(kinds.values()),
            )


def _merged(unknowns: Collection[Unknown], owners: Sequence[int]) -> dict[int, dict[int, str]]:
    """Kind of each dependency by value reference: all those of an array's elements, the weakest kind of each."""
    found: dict[int, dict[int, str]] = {}
    for one in unknowns:
        kinds = found.setdefault(owners[one.index - 1], {})
        for known, kind in zip(one.dependencies, one.kinds, strict=True):
            reference = owners[known - 1]
            kinds[reference] = max(kind, kinds.get(reference, kind), key=_KINDS.index)
    return {reference: dict(sorted(kinds.items())) for reference, kinds in found.items()}
