"""What stands between a law and its plant, and how it is wired: sensors, actuators, and what acts on the outer input.

By their names: a sensor shows ``x`` as ``x_measured``, an actuator turns ``u_command`` into ``u``, and what acts of the
outer loop's ``v`` is ``v_acting``.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Sequence

from brunovsky.blocks.block import Block
from brunovsky.blocks.diagram import Diagram
from brunovsky.blocks.variables import Parameter, Variable
from brunovsky.errors import ModelError


def with_suffix(one: Variable, suffix: str, what: str) -> Variable:
    """Variable of the same quantity elsewhere: ``eta_measured[1]`` for ``eta[1]``."""
    stem, bracket, indices = one.name.partition("[")
    return dataclasses.replace(one, name=f"{stem}_{suffix}{bracket}{indices}", description=f"{one.description}, {what}")


def command(one: Variable) -> Variable:
    """What is commanded of an actuator, where that is not what acts: ``u_command[1]`` for ``u[1]``."""
    return with_suffix(one, "command", "as commanded")


def measured(one: Variable) -> Variable:
    """What a sensor shows of a state: ``eta_measured[1]`` for ``eta[1]``."""
    return with_suffix(one, "measured", "as measured")


def acting(one: Variable) -> Variable:
    """What acts of an outer input, where that is not what the outer loop gives: ``v_acting[1]`` for ``v[1]``."""
    return with_suffix(one, "acting", "as it acts on the inner loop")


def computed(one: Variable) -> Variable:
    """What a computer that samples found for an output: ``S_computed[1]`` for ``S[1]``."""
    return with_suffix(one, "computed", "as computed at the last sample")


def wired(
    name: str,
    description: str,
    plant: Block,
    loop: Block,
    *,
    sensors: Block | None = None,
    inputs: Block | None = None,
    actuators: Block | None = None,
) -> Diagram:
    """Plant and inner loop as a diagram, directly or through what stands between them.

    Parameters
    ----------
    name, description : str
        Of the diagram.
    plant, loop : Block
        The plant, whose outputs are its states, and the inner loop with inputs of their names and ``v[i]``.
    sensors, inputs, actuators : Block, optional
        As for ``linearized_block``.

    Raises
    ------
    ModelError
        If one of them is no block or has not the variables that it needs.
    """
    states = [one for one in plant.outputs if any(one.name == other.name for other in loop.inputs)]
    outer = [one for one in loop.inputs if one.name.startswith("v[")]
    commands = [one for one in plant.inputs if any(one.name == other.name for other in loop.outputs)]
    parts: dict[str, Block] = {"plant": plant, "inner_loop": loop}
    outputs = {one.name: f"plant.{one.name}" for one in plant.outputs}
    outputs |= {one.name: f"inner_loop.{one.name}" for one in loop.outputs}
    wires = {f"inner_loop.{one.name}": f"plant.{one.name}" for one in states}
    if actuators is None:
        wires |= {f"plant.{one.name}": f"inner_loop.{one.name}" for one in commands}
    else:
        _check(name, "actuators", actuators, [command(one) for one in commands], commands)
        parts["actuators"] = actuators
        wires |= {f"actuators.{command(one).name}": f"inner_loop.{one.name}" for one in commands}
        wires |= {f"plant.{one.name}": f"actuators.{one.name}" for one in commands}
        outputs |= {one.name: f"actuators.{one.name}" for one in commands}
        outputs |= {command(one).name: f"inner_loop.{one.name}" for one in commands}
    if sensors is not None:
        shown = [measured(one) for one in states]
        _check(name, "sensors", sensors, states, shown)
        parts["sensors"] = sensors
        wires |= {f"sensors.{one.name}": f"plant.{one.name}" for one in states}
        wires |= {f"inner_loop.{one.name}": f"sensors.{measured(one).name}" for one in states}
        outputs |= {one.name: f"sensors.{one.name}" for one in shown}
    if inputs is not None:
        acts = [acting(one) for one in outer]
        _check(name, "inputs", inputs, outer, acts)
        parts["inputs"] = inputs
        wires |= {f"inner_loop.{one.name}": f"inputs.{acting(one).name}" for one in outer}
        outputs |= {one.name: f"inputs.{one.name}" for one in acts}
    return Diagram(
        name,
        description,
        components=parts,
        connections=wires,
        inputs=_free_inputs(parts, wires),
        outputs=outputs,
        parameters=_shared_parameters(parts),
    )


def _free_inputs(parts: dict[str, Block], wires: dict[str, str]) -> dict[str, list[str]]:
    free: dict[str, list[str]] = {}
    for key in ("inputs", "inner_loop", "plant", "actuators", "sensors"):
        for one in parts[key].inputs if key in parts else ():
            if f"{key}.{one.name}" not in wires:
                free.setdefault(one.name, []).append(f"{key}.{one.name}")
    return free


def _shared_parameters(parts: dict[str, Block]) -> dict[str, list[str]]:
    """Parameters under their own names, shared by the parts that have them; start values first."""
    shared: dict[str, list[str]] = {}
    declarations = [one for block in parts.values() for one in block.parameters]
    for one in sorted(declarations, key=lambda one: not _is_start(one, parts.values())):
        having = (key for key, block in parts.items() if any(one.name == other.name for other in block.parameters))
        shared[one.name] = [f"{key}.{one.name}" for key in having]
    return shared


def _check(name: str, kind: str, block: Block, inputs: Sequence[Variable], outputs: Sequence[Variable]) -> None:
    example = {"actuators": "actuator_lags", "sensors": "sensors", "inputs": "outer_inputs"}[kind]
    rule = {
        "actuators": "a command is an input u_command, what acts an output u, for each input u of the plant",
        "sensors": "a state x is an input, what is measured of it an output x_measured",
        "inputs": "the outer loop's v[i] are inputs, what acts of them outputs v_acting[i]",
    }[kind]
    if not isinstance(block, Block):
        raise ModelError(f"{name}: {kind} = {block!r} is no block; give {example}(...) or one of your own")
    for group, needed in (("inputs", inputs), ("outputs", outputs)):
        there = [one.name for one in getattr(block, group)]
        if missing := [one.name for one in needed if one.name not in there]:
            raise ModelError(f"{name}: {kind} {block.name}: no {group[:-1]} {', '.join(missing)}; {rule}")


def _is_start(parameter: Parameter, blocks: Iterable[Block]) -> bool:
    starts = (one.start for block in blocks for group in (block.states, block.samples) for one in group)
    return any(parameter.symbol in start.free_symbols for start in starts)
