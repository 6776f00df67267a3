"""Actuators in series: what the first lets through is the command of the next."""

from __future__ import annotations

from itertools import pairwise

from brunovsky.blocks.block import Block
from brunovsky.blocks.diagram import Diagram
from brunovsky.blocks.hardware import command
from brunovsky.errors import ModelError


def actuator_series(*parts: Block, name: str = "actuators") -> Block:
    """Blocks of the same actuators one behind the other, the first one gets the commands.

    Parameters
    ----------
    *parts : Block
        With inputs ``u_command`` and outputs ``u``, such as :func:`actuator_lags` and :func:`actuator_limits`; their
        names differ. One alone is returned as it is.
    name : str
        Of the diagram.

    Returns
    -------
    Block
        Inputs ``u_command`` of the first, outputs ``u`` of the last; parameters of the same name are shared.

    Raises
    ------
    ModelError
        If there is none, names are equal, or one has other actuators than the next.
    """
    names = [one.name for one in parts]
    if not parts or len(set(names)) < len(names):
        raise ModelError(f"{name}: actuators in series {names}; give at least one, and names that differ")
    if len(parts) == 1:
        return parts[0]
    shared: dict[str, list[str]] = {}
    for block in parts:
        for one in block.parameters:
            shared.setdefault(one.name, []).append(f"{block.name}.{one.name}")
    first, last = parts[0], parts[-1]
    return Diagram(
        name,
        "actuators in series: " + ", ".join(names),
        components={one.name: one for one in parts},
        connections={
            f"{after.name}.{command(one).name}": f"{before.name}.{one.name}"
            for before, after in pairwise(parts)
            for one in before.outputs
        },
        inputs={one.name: f"{first.name}.{one.name}" for one in first.inputs},
        outputs={one.name: f"{last.name}.{one.name}" for one in last.outputs},
        parameters=shared,
    )
