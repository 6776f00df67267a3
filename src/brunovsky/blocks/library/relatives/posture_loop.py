"""The closed loop of laws that act on the accelerations of the bare robot, wired as a diagram."""

from __future__ import annotations

from brunovsky.blocks.block import Block
from brunovsky.blocks.diagram import Diagram
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.library.closed_loop import FIGURE_6_OUTSIDE, closed_loop
from brunovsky.blocks.library.relatives.backstepping import backstepping
from brunovsky.blocks.library.robot import robot, robot_linearization
from brunovsky.blocks.variables import Input, Output, symbol


def posture_loop(
    controller: Block | None = None,
    *,
    reference: Block | None = None,
    name: str = "posture_loop",
) -> Diagram:
    """Reference -> law on the accelerations -> bare robot: ``closed_loop`` for laws that need no inner loop.

    Parameters
    ----------
    controller : Block, optional
        From ``x``, ``y``, ``theta``, ``eta[1..2]`` and the reference to ``u[1..2]``; the default is
        :func:`backstepping`.
    reference : Block, optional
        The default is :func:`circle`.
    name : str
        Of the diagram.

    Returns
    -------
    Diagram
        Inputs the disturbances ``d[1..2]``; outputs ``x``, ``y``, ``theta``, ``eta[1..2]``, the chains ``Z1[1..3]``,
        ``Z2[1..3]`` of the nominal model, the errors ``e1[1..3]``, ``e2[1..3]``, what else the law shows, and
        ``u[1..2]``; parameters of all under their own names. Defaults: figure 6 of the paper from outside the circle.

    Raises
    ------
    ModelError
        If units differ.
    """
    return closed_loop(controller or backstepping(), plant=_robot_with_chains(), reference=reference, name=name)


def _robot_with_chains() -> Diagram:
    """The bare robot, and beside it what ``closed_loop`` records: the chains, of the nominal model."""
    parts = {"plant": robot(), "chains": _chains()}
    states = [one.name for one in parts["plant"].outputs]
    taken = [one.name for one in parts["chains"].inputs]
    return Diagram(
        "robot_with_chains",
        "bare robot with its chains recorded",
        components=parts,
        connections={f"chains.{one}": f"plant.{one}" for one in taken if one in states},
        inputs={
            one.name: [f"{key}.{one.name}" for key, block in parts.items() if one in block.inputs]
            for one in parts["plant"].inputs
        },
        outputs={one.name: f"{key}.{one.name}" for key, block in parts.items() for one in block.outputs},
        parameters={one.name: f"plant.{one.name}" for one in parts["plant"].parameters},
        values=FIGURE_6_OUTSIDE,
    )


def _chains() -> Block:
    """Chains of the nominal robot, from its states and the forward acceleration."""
    linearization, plant = robot_linearization(), robot()
    known = [Input(one.name, one.unit, one.description) for one in (*plant.states, *plant.inputs)]
    expressions = [one for chain in linearization.chains for one in chain]
    used = {symbol(str(one)) for expression in expressions for one in expression.free_symbols}
    return Block(
        "chains",
        "chains of the nominal robot",
        inputs=tuple(one for one in known if one.symbol in used),
        outputs=tuple(
            Output(one.name, one.unit, one.description, expression)
            for one, expression in zip(ROBOT_CHAINS.states, expressions, strict=True)
        ),
    )
