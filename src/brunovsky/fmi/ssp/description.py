"""SystemStructureDescription: components with connectors, connections, bindings, default experiment and geometry."""

from __future__ import annotations

from collections.abc import Mapping

from lxml import etree

from brunovsky.blocks import Diagram
from brunovsky.fmi.definitions import xml_text
from brunovsky.fmi.ssp.elements import FORMAT, TYPES, add_units, child, number, root
from brunovsky.fmi.ssp.geometry import Geometry, geometry
from brunovsky.fmi.ssp.parameters import component_set
from brunovsky.fmi.ssp.variant import Variant
from brunovsky.fmi.ssp.wiring import SYSTEM, Wiring
from brunovsky.fmi.variables import ScalarVariable

MAPPING_FILE = "resources/parameters.ssm"


def structure_description(
    diagram: Diagram, plan: Wiring, variant: Variant, files: Mapping[str, str], ssp_version: int, tool: str
) -> bytes:
    """Text of an SSD file.

    Parameters
    ----------
    diagram : Diagram
        What it describes.
    plan : Wiring
        Of the diagram.
    variant : Variant
        Parameter set and default experiment.
    files : mapping of str to str
        Path of each component's FMU in the package.
    ssp_version : int
        1 or 2.
    tool : str
        Generation tool.

    Returns
    -------
    bytes
        UTF-8, the same for equal arguments.
    """
    drawing = geometry(plan)
    title = f"{diagram.name}, {variant.name}"
    about = variant.description or diagram.description or diagram.name
    top = root(
        "ssd:SystemStructureDescription",
        {"version": FORMAT[ssp_version], "name": title, "description": about, "generationTool": tool},
    )
    about_system = diagram.description or diagram.name
    system = child(top, "ssd:System", {"name": diagram.name, "description": about_system})
    _connectors(system, SYSTEM, plan, drawing, ssp_version)
    if plan.parameters:
        binding = _binding(system, {"source": f"resources/{variant.name}.ssv"})
        child(binding, "ssd:ParameterMapping", {"source": MAPPING_FILE})
    elements = child(system, "ssd:Elements")
    for name, block in diagram.components.items():
        attributes = {"name": name, "source": files[name], "implementation": "CoSimulation"}
        component = child(elements, "ssd:Component", attributes | {"description": block.description or block.name})
        _connectors(component, name, plan, drawing, ssp_version)
        _corners(component, "ssd:ElementGeometry", drawing.boxes[name])
        values = component_set(diagram, plan, name, variant, ssp_version)
        if values is not None:
            child(_binding(component), "ssd:ParameterValues").append(values)
    _connections(system, plan, drawing)
    _corners(system, "ssd:SystemGeometry", drawing.canvas)
    add_units(
        top, "ssd", (one.unit for variables in plan.connectors.values() for one in variables if one.type == "Real")
    )
    child(top, "ssd:DefaultExperiment", {"startTime": "0.0", "stopTime": number(variant.stop_time)})
    etree.cleanup_namespaces(top, keep_ns_prefixes=["ssd", "ssc", "ssv"])
    return xml_text(top)


def _binding(parent: etree._Element, attributes: Mapping[str, str] | None = None) -> etree._Element:
    return child(child(parent, "ssd:ParameterBindings"), "ssd:ParameterBinding", attributes)


def _connectors(parent: etree._Element, name: str, plan: Wiring, drawing: Geometry, ssp_version: int) -> None:
    variables = plan.connectors.get(name, ())
    if not variables:
        return
    group = child(parent, "ssd:Connectors")
    for one in variables:
        attributes = {"name": one.name, "kind": one.causality, "description": one.description}
        connector = child(group, "ssd:Connector", attributes)
        _type(connector, one, ssp_version)
        x, y = drawing.connectors[name, one.name]
        child(connector, "ssd:ConnectorGeometry", {"x": number(x), "y": number(y)})


def _type(connector: etree._Element, one: ScalarVariable, ssp_version: int) -> None:
    kind = TYPES[ssp_version].get(one.type, one.type)
    child(connector, f"ssc:{kind}", {"unit": one.unit} if one.type == "Real" else {})


def _connections(system: etree._Element, plan: Wiring, drawing: Geometry) -> None:
    if not plan.wires:
        return
    group = child(system, "ssd:Connections")
    for wire, points in zip(plan.wires, drawing.routes, strict=True):
        attributes = {}
        for side, (component, connector) in (("start", wire.source), ("end", wire.target)):
            if component != SYSTEM:
                attributes[f"{side}Element"] = component
            attributes[f"{side}Connector"] = connector
        connection = child(group, "ssd:Connection", attributes)
        if points:
            x, y = (" ".join(number(one[axis]) for one in points) for axis in (0, 1))
            child(connection, "ssd:ConnectionGeometry", {"pointsX": x, "pointsY": y})


def _corners(parent: etree._Element, name: str, box: tuple[float, float, float, float]) -> None:
    child(parent, name, {key: number(value) for key, value in zip(("x1", "y1", "x2", "y2"), box, strict=True)})
