"""What a diagram looks like from outside its components: parts with connectors, and the wires between them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from brunovsky.blocks import Block, Diagram
from brunovsky.fmi.variables import ScalarVariable, scalar_variables

SYSTEM = ""
"""Name of the system itself where a wire begins or ends at one of its own connectors."""

Port = tuple[str, str]


@dataclass(frozen=True)
class Wire:
    """A connection from an output to an input, each as component and variable.

    ``direct``: the output follows an input of its own component without a state between, or the component has none.
    """

    source: Port
    target: Port
    direct: bool = True


@dataclass(frozen=True)
class Wiring:
    """Connectors of each component and of the system, and the wires.

    Parameters
    ----------
    connectors : mapping of str to tuple of ScalarVariable
        Outputs, and the inputs that something drives, by component, in the order of the FMU; those of the system under
        :data:`SYSTEM`. The others are left out, since fmpy gives an input without a connection the value of another;
        and so are clocks, which tick as the FMU describes them.
    wires : tuple of Wire
        Connections of the diagram; those to and from the system's own connectors come last.
    parameters : mapping of str to tuple of Port
        Component and variable behind each parameter of the diagram.
    """

    connectors: Mapping[str, tuple[ScalarVariable, ...]]
    wires: tuple[Wire, ...]
    parameters: Mapping[str, tuple[Port, ...]]


def wiring(diagram: Diagram, fmi_version: int, system_connectors: bool) -> Wiring:
    """Wiring of a diagram whose components are FMUs of this version; with or without connectors of the system."""
    connectors = {key: _connectors(block, fmi_version) for key, block in diagram.components.items()}
    wires = []
    for target, source in diagram.connections.items():
        component, variable = _port(diagram, source)
        block = diagram.components[component]
        direct = bool(block.feedthrough[variable]) or not block.inputs
        wires.append(Wire((component, variable), _port(diagram, target), direct))
    if system_connectors:
        connectors[SYSTEM] = _connectors(diagram, fmi_version)
        for one in diagram.inputs:
            wires += [Wire((SYSTEM, one.name), _port(diagram, behind)) for behind in _behind(diagram, one.name)]
        for output in diagram.outputs:
            wires += [Wire(_port(diagram, behind), (SYSTEM, output.name)) for behind in _behind(diagram, output.name)]
    driven = {one.target for one in wires}
    for key in diagram.components:
        connectors[key] = tuple(
            one for one in connectors[key] if one.causality == "output" or (key, one.name) in driven
        )
    parameters = {
        one.name: tuple(_port(diagram, behind) for behind in _behind(diagram, one.name)) for one in diagram.parameters
    }
    return Wiring(connectors, tuple(wires), parameters)


def _connectors(block: Block, fmi_version: int) -> tuple[ScalarVariable, ...]:
    table = scalar_variables(block, fmi_version)
    return tuple(one for one in table if one.causality in ("input", "output") and one.type != "Clock")


def _behind(diagram: Diagram, name: str) -> tuple[str, ...]:
    """Flattened names behind a name of the diagram; what isn't exported has one already."""
    return diagram.exports.get(name, (name,))


def _port(diagram: Diagram, flattened: str) -> Port:
    component = max((key for key in diagram.components if flattened.startswith(f"{key}.")), key=len)
    return component, flattened.removeprefix(f"{component}.")
