"""From rest to rest with poles in the goal's frame: launch open-loop, track, park."""

from __future__ import annotations

import dataclasses

import numpy as np
import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.diagram import Diagram
from brunovsky.blocks.library.goal_frame.law import goal_frame_law
from brunovsky.blocks.library.heading import direction
from brunovsky.blocks.library.references import set_point
from brunovsky.blocks.library.robot import linearized_robot, robot
from brunovsky.blocks.variables import Mode, Output, Parameter, Transition, described, symbols
from brunovsky.errors import ModelError

_LAUNCH = (
    Parameter("launch_speed", "m/s", "abs(eta[1]) at which the launch ends", 0.3, 1e-6),
    Parameter("launch_acceleration", "m/s2", "abs(u[1]) during the launch", 0.3, 1e-6),
)
_PARK_DISTANCE = Parameter("park_distance", "m", "distance from the goal below which the robot parks", 0.02, 0.0)
_ETA_MIN = 2e-3
_MODE = Mode("mode", "1", "0: at rest, 1: launching, 2: tracking, 3: parking")
_LAUNCHING, _TRACKING, _PARKING = (sp.Eq(_MODE.symbol, k) for k in (1, 2, 3))


def goal_frame_manoeuvre(law: Block | None = None) -> Diagram:
    """Bare robot that drives from rest to a resting goal, its heading included where the law is lucky.

    The linearising law has no value at eta[1] = 0. So the robot is launched open-loop, with a constant forward
    acceleration until it has some speed: forward if it is behind the goal, seen along the goal's heading, else
    backward. Then the law tracks, with the dynamic extension started at the launch's acceleration. Near the goal the
    robot parks, as soon as it is within ``park_distance`` and not faster than ``park_speed``: eta[1] decays at
    ``brake[1]``, by default the law's slow pole, as it would under the law, without the division by eta[1], and eta[2]
    at ``brake[2]``. A robot that starts within ``park_distance`` of the goal parks at once.

    It fails where abs(eta[1]) falls to ``eta_min`` away from the goal, and arrives turned by pi where the launch
    carries it beyond the goal: :func:`brunovsky.analysis.goal_frame_forecast` says so beforehand. An ``eta_min`` above
    the speed at which the robot parks makes the law inexact on the last stretch.

    Parameters
    ----------
    law : Block, optional
        What :func:`goal_frame_law` returns; its default otherwise.

    Returns
    -------
    Diagram
        Inputs ``d[1..2]``; outputs ``x``, ``y``, ``theta``, ``eta[1..2]``, ``u[1..2]``, ``mode`` (0 at rest, 1
        launching, 2 tracking, 3 parking), ``v[1..2]`` and ``S[1..2]``; parameters ``goal[1..2]``, ``goal_heading``,
        starts and ratios of the robot, launch, parking, ``eta_min`` and those of the law.

    Raises
    ------
    ModelError
        If `law` has not the parameters of a goal-frame law.

    References
    ----------
    See :func:`goal_frame_law`; launch, tracking and parking as they are composed here are this project's.
    """
    controller, plant = _controller(law or goal_frame_law()), robot()
    shared = [one.name for one in plant.outputs]
    return Diagram(
        "goal_frame_manoeuvre",
        "rest to rest with poles in the frame of the goal",
        components={"controller": controller, "robot": plant},
        connections={f"controller.{one}": f"robot.{one}" for one in shared}
        | {f"robot.u[{k}]": f"controller.u[{k}]" for k in (1, 2)},
        inputs={f"d[{k}]": f"robot.d[{k}]" for k in (1, 2)},
        outputs={one: f"robot.{one}" for one in shared}
        | {one.name: f"controller.{one.name}" for one in controller.outputs},
        parameters={
            one.name: f"{key}.{one.name}"
            for key, block in (("robot", plant), ("controller", controller))
            for one in block.parameters
        },
        values={"eta_start[1]": 0.0},
    )


def _controller(law: Block) -> Block:
    """The law with launch and parking around it, from the robot's states to ``u[1..2]``."""
    base = _tracking(law)
    x, y, eta1, eta2, heading = symbols("x", "y", "eta[1]", "eta[2]", "goal_heading")
    park = _parking(law)
    speed, acceleration, near, slow, brake1, brake2 = (one.symbol for one in (*_LAUNCH, *park))
    error = sp.Matrix([x, y]) - sp.Matrix(symbols("goal[1]", "goal[2]"))
    ahead = error.dot(direction(heading)) > 0
    is_near = error.dot(error) <= near**2
    resting = sp.Eq(_MODE.symbol, 0)
    (compensator,) = base.states
    tracked = {one.name: one for one in base.outputs}
    commands = {
        "u[1]": ((compensator.symbol, sp.Or(_LAUNCHING, _TRACKING)), (-brake1 * eta1, _PARKING), (0, True)),
        "u[2]": ((tracked["yaw"].expression, _TRACKING), (-brake2 * eta2, _PARKING), (0, True)),
    }
    launched = {_MODE.symbol: sp.S.One, compensator.symbol: sp.Piecewise((-acceleration, ahead), (acceleration, True))}
    return Block(
        "goal_frame_controller",
        "launch, law in the frame of the goal, parking",
        inputs=base.inputs,
        parameters=(
            *(one for one in base.parameters if one.symbol not in compensator.start.free_symbols),
            *(*_LAUNCH, *park),
        ),
        states=(
            dataclasses.replace(
                compensator,
                start=sp.S.Zero,
                derivative=sp.Piecewise((compensator.derivative, _TRACKING), (0, True)),
            ),
        ),
        modes=(_MODE,),
        outputs=(
            *(Output(**described(one), expression=sp.Piecewise(*commands[one.name])) for one in robot().inputs[:2]),
            Output(**described(_MODE), expression=_MODE.symbol),
            *(one for name, one in tracked.items() if name[0] in "vS"),
        ),
        relations=base.relations,
        transitions=(
            Transition("stay", sp.And(resting, is_near), {_MODE.symbol: sp.Integer(3)}),
            Transition("launch", sp.And(resting, sp.Not(is_near)), launched),
            Transition("track", sp.And(_LAUNCHING, sp.Abs(eta1) >= speed), {_MODE.symbol: sp.Integer(2)}),
            Transition("park", sp.And(_TRACKING, is_near, sp.Abs(eta1) <= slow), {_MODE.symbol: sp.Integer(3)}),
        ),
        checks=base.checks,
    )


def _parking(law: Block) -> tuple[Parameter, ...]:
    """Parameters of parking, their defaults those with which the law's slow mode goes on."""
    values = law.parameter_values()
    if missing := [one for one in ("goal_heading", "C1[1]", "C1[2]", "Q[2]") if one not in values]:
        raise ModelError(f"goal_frame_manoeuvre: {law.name} has no {', '.join(missing)}; pass a goal_frame_law")
    slow = float(-np.roots([1.0, values["C1[2]"], values["C1[1]"]]).real.max())
    return (
        _PARK_DISTANCE,
        Parameter(
            "park_speed", "m/s", "abs(eta[1]) below which the robot parks", 1.25 * slow * _PARK_DISTANCE.value, 0.0
        ),
        Parameter("brake[1]", "1/s", "rate at which eta[1] decays while parking", slow, 1e-6),
        Parameter("brake[2]", "1/s", "rate at which eta[2] decays while parking", values["Q[2]"], 1e-6),
    )


def _tracking(law: Block) -> Diagram:
    """Law and inner loop about a goal: the robot's states in, the yaw acceleration out."""
    inner = linearized_robot().components["inner_loop"]
    parts = {"reference": set_point(), "law": law, "inner_loop": inner}
    own = {one.name: f"law.{one.name}" for one in law.parameters}
    return Diagram(
        "goal_frame_tracking",
        "law in the frame of the goal, with the inner loop",
        components=parts,
        connections={f"law.{one.name}": f"reference.{one.name}" for one in set_point().outputs}
        | {"law.Z1": "inner_loop.Z1", "law.Z2": "inner_loop.Z2", "inner_loop.v": "law.v"},
        inputs={one.name: f"inner_loop.{one.name}" for one in inner.inputs if not one.name.startswith("v[")},
        outputs={"compensator": "inner_loop.u[1]", "yaw": "inner_loop.u[2]"}
        | {one.name: f"law.{one.name}" for one in law.outputs},
        parameters={f"goal[{i}]": f"reference.target[{i}]" for i in (1, 2)} | own | {"eta_min": "inner_loop.eta_min"},
        values={"eta_min": _ETA_MIN},
    )
