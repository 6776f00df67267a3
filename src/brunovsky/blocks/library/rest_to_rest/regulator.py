"""The regulator of the bare robot from rest to rest, and its closed loop with it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from brunovsky.blocks.block import Block
from brunovsky.blocks.diagram import Diagram
from brunovsky.blocks.library.outer_loops import sliding_mode
from brunovsky.blocks.library.rest_to_rest.supervisor import COMMANDS, GOAL, ROBOT, supervisor
from brunovsky.blocks.library.robot import robot
from brunovsky.blocks.variables import Output, Parameter, described

SURFACE = (16.0, 8.0, 1.0)
"""C: both poles on the surface at -4 1/s."""
_GOAL, _STATE, _COMMANDS = (tuple(one.name for one in group) for group in (GOAL, ROBOT, COMMANDS))


def regulator(law: Block | None = None) -> Diagram:
    """Controller of the bare robot that drives it from rest to a goal with heading, and holds it there.

    A supervisor plans from where the robot rests: the quickest of paths forward or backward with zero curvature at
    both ends, of a path with one reversal where it is shorter by much, and of turns in place with a straight drive
    where these are much shorter still. The path is driven from rest to rest with the speed of minimum jerk, scaled in
    time to the limits; the chains follow it under the outer loop. ``mode`` is 0 at rest, 1 moving, 2 braking; it
    brakes, and plans anew, where the goal changes, the error leaves a tube, or the robot moves without a plan.

    Near rest, where the linearising law is singular, the yaw acceleration is that of the path with a law for the
    heading, into which the linearising law fades; velocities that follow the commanded accelerations, as an observer
    of constant disturbances makes them, keep the chains exact.

    Parameters
    ----------
    law : Block, optional
        Outer loop of the robot's chains without states; :func:`sliding_mode` with all poles at -4 1/s and ``P = 0``
        by default, which is pole placement; ``P > 0`` makes it a sliding mode.

    Returns
    -------
    Diagram
        Inputs ``goal[1..2]`` (m), ``goal_heading`` (rad) and the robot's ``x``, ``y``, ``theta``, ``eta[1..2]``;
        outputs ``u[1..2]`` (m/s2, rad/s2) and ``mode``. Parameters: the limits ``speed_limit`` (m/s) and
        ``u_limit[1..2]`` (m/s2, rad/s2), those of the law and of the supervisor.

    Raises
    ------
    ModelError
        If `law` is not for the robot's chains.
    ParameterError
        At the start, where no plan can keep the limits, or other parameters keep the robot from resting; the message
        has the reason.

    References
    ----------
    Minimum jerk: T. Flash and N. Hogan, "The coordination of arm movements: an experimentally confirmed mathematical
    model", J. Neurosci. 5(7), 1688-1703, 1985, doi:10.1523/JNEUROSCI.05-07-01688.1985.
    """
    return Diagram(
        "regulator",
        "regulator of the bare robot from rest to rest, with heading: planner, supervisor, outer and inner loop",
        inputs={one: f"supervisor.{one}" for one in (*_GOAL, *_STATE)},
        outputs={one: f"supervisor.{one}" for one in (*_COMMANDS, "mode")},
        **with_outer_loop(supervisor(), law),
    )


def with_outer_loop(head: Block, law: Block | None) -> dict[str, Any]:
    """Components, connections and parameters of a supervisor with its outer loop."""
    outer = law or sliding_mode(surface=SURFACE, Q=4.0, P=0.0)
    provided = {one.name for one in head.outputs}
    connections = {f"law.{one.name}": f"supervisor.{one.name}" for one in outer.inputs if one.name in provided}
    connections |= {f"supervisor.v[{i}]": f"law.v[{i}]" for i in (1, 2)}
    return {
        "components": {"supervisor": head, "law": outer},
        "connections": connections,
        "parameters": {one.name: f"{key}.{one.name}" for key, part in (("supervisor", head), ("law", outer))
                       for one in part.parameters},
    }  # fmt: skip


def rest_to_rest(regulator_block: Block | None = None) -> Diagram:
    """Closed loop of :func:`regulator` and the bare robot.

    Parameters
    ----------
    regulator_block : Block, optional
        A regulator with another law; :func:`regulator` by default.

    Returns
    -------
    Diagram
        Inputs ``d[1..2]``; outputs ``x``, ``y``, ``theta``, ``eta[1..2]``, ``u[1..2]``, ``mode``. Parameters
        ``x_start``, ``y_start``, ``theta_start``, ``eta_start[1..2]``, the tunable ``goal[1..2]`` and
        ``goal_heading``, those of the regulator, and ``rho[1..2]``.
    """
    control, target = regulator_block or regulator(), _goal()
    return Diagram(
        "rest_to_rest",
        "robot that starts, arrives and stops at a goal with heading",
        **bare_robot_loop("regulator", control, ("mode",), {"goal": target},
                          {f"regulator.{one}": f"goal.target.{one}" for one in _GOAL}),
    )  # fmt: skip


def bare_robot_loop(
    name: str, control: Block, shown: Sequence[str], before: Mapping[str, Block], connections: Mapping[str, str]
) -> dict[str, Any]:
    """Parts of the diagram of a controller, by its name, and the bare robot, at rest by default.

    ``shown`` are outputs of the controller beside its commands, ``before`` and ``connections`` what feeds it.
    """
    plant = robot()
    wires = dict(connections) | {f"{name}.{one}": f"robot.{one}" for one in _STATE}
    wires |= {f"robot.{one}": f"{name}.{one}" for one in _COMMANDS}
    parts = {"robot": plant, **before, name: control}
    return {
        "components": {**before, name: control, "robot": plant},
        "connections": wires,
        "inputs": {f"d[{i}]": f"robot.d[{i}]" for i in (1, 2)},
        "outputs": {one: f"robot.{one}" for one in _STATE} | {one: f"{name}.{one}" for one in (*_COMMANDS, *shown)},
        "parameters": {one.name: f"{key}.{one.name}" for key, part in parts.items() for one in part.parameters},
        "values": {"eta_start[1]": 0.0},
    }


def _goal() -> Block:
    """The goal as tunable parameters."""
    parameters = tuple(
        Parameter(**described(one), value=value, tunable=True) for one, value in zip(GOAL, (2.0, 1.0, 0.0), strict=True)
    )
    outputs = tuple(Output(f"target.{one.name}", one.unit, one.description, one.symbol) for one in parameters)
    return Block("goal", "goal that may change", parameters=parameters, outputs=outputs)
