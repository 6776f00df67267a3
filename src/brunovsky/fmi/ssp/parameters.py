"""Parameter sets (SSV) and the mapping (SSM) from a diagram's names to those of its components."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from lxml import etree

from brunovsky.blocks import Diagram, Parameter
from brunovsky.fmi.definitions import xml_text
from brunovsky.fmi.ssp.elements import FORMAT, TYPES, add_units, child, root
from brunovsky.fmi.ssp.variant import Variant
from brunovsky.fmi.ssp.wiring import Wiring


def parameter_file(diagram: Diagram, variant: Variant, ssp_version: int, tool: str) -> bytes:
    """Text of an SSV file: every parameter of the diagram under its own name."""
    attributes = {"generationTool": tool, **({"description": variant.description} if variant.description else {})}
    values = diagram.parameter_values(variant.parameters)
    return xml_text(_parameter_set(variant.name, diagram.parameters, values, ssp_version, attributes))


def mapping_file(plan: Wiring, ssp_version: int, tool: str) -> bytes:
    """Text of the SSM file: the names of the diagram to ``component.parameter``, one to several where they share it."""
    mapping = root("ssm:ParameterMapping", {"version": FORMAT[ssp_version], "generationTool": tool})
    for source, ports in plan.parameters.items():
        for component, variable in ports:
            child(mapping, "ssm:MappingEntry", {"source": source, "target": f"{component}.{variable}"})
    return xml_text(mapping)


def component_set(
    diagram: Diagram, plan: Wiring, component: str, variant: Variant, ssp_version: int
) -> etree._Element | None:
    """Parameter set of one component under the names of its FMU, None if it has no parameters."""
    values = diagram.parameter_values(variant.parameters)
    own = {
        variable: values[name]
        for name, ports in plan.parameters.items()
        for part, variable in ports
        if part == component
    }
    parameters = [one for one in diagram.components[component].parameters if one.name in own]
    return _parameter_set(variant.name, parameters, own, ssp_version, {}) if parameters else None


def _parameter_set(
    name: str,
    parameters: Iterable[Parameter],
    values: Mapping[str, float],
    ssp_version: int,
    attributes: Mapping[str, str],
) -> etree._Element:
    rows = list(parameters)
    top = root("ssv:ParameterSet", {"version": FORMAT[ssp_version], "name": name, **attributes})
    listed = child(top, "ssv:Parameters")
    kind = TYPES[ssp_version].get("Real", "Real")
    for one in rows:
        element = child(listed, "ssv:Parameter", {"name": one.name, "description": one.description or one.name})
        child(element, f"ssv:{kind}", {"value": repr(float(values[one.name])), "unit": one.unit})
    add_units(top, "ssv", (one.unit for one in rows))
    return top
