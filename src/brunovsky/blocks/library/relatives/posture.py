"""What laws on the accelerations of the bare robot share: posture, reference, and derivatives along the motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.outer_loop import CHAINS, INPUTS, ORDER
from brunovsky.blocks.library.robot import robot, robot_system
from brunovsky.blocks.variables import Check, Input, Output, symbol, symbols

REFERENCE = tuple(one for one in INPUTS if one.name.startswith(("Z1d", "Z2d", "zd3")))
"""Inputs ``Z1d[1..3]``, ``Z2d[1..3]``, ``zd3[1..2]``: the flat outputs to be tracked, with their derivatives."""

POSITION, VELOCITY, ACCELERATION = (sp.Matrix(symbols(*(f"Z{i}d[{k}]" for i in CHAINS))) for k in range(1, ORDER + 1))
"""Of the reference, shape (2, 1)."""


@dataclass(frozen=True)
class PostureReference:
    """Posture, speeds and accelerations behind the flat outputs of a reference that drives forward."""

    direction: sp.Matrix
    speed: sp.Expr
    yaw_rate: sp.Expr
    forward_acceleration: sp.Expr
    yaw_acceleration: sp.Expr


def turned(vector: sp.Matrix) -> sp.Matrix:
    """Vector of the plane, turned by a right angle to the left."""
    return sp.Matrix([-vector[1], vector[0]])


@lru_cache
def _rates() -> Mapping[sp.Symbol, sp.Expr]:
    """Derivatives of the robot's states, of the nominal model without disturbances, and of the reference's."""
    nominal = robot_system().with_parameters(dict.fromkeys(robot_system().parameters, 1))
    undisturbed = dict.fromkeys(nominal.disturbances, 0)
    states = zip(nominal.states, nominal.dynamics.xreplace(undisturbed), strict=True)
    chains = {i: [*(f"Z{i}d[{k}]" for k in range(1, ORDER + 1)), f"zd3[{i}]"] for i in CHAINS}
    reference = ((symbol(low), symbol(high)) for one in chains.values() for low, high in pairwise(one))
    return dict([*states, *reference])


def derivative(expression: sp.Expr) -> sp.Expr:
    """Derivative in time along the nominal robot and the reference; may contain ``u[1..2]`` and ``zd3[1..2]``."""
    return sp.Add(*(sp.diff(expression, one) * rate for one, rate in _rates().items()))


def robot_direction() -> sp.Matrix:
    """Unit vector along which the robot drives, (-sin theta, cos theta)."""
    return sp.Matrix([_rates()[one] for one in symbols("x", "y")]).diff(symbol("eta[1]"))


def reference_posture() -> PostureReference:
    """Posture reference of the inputs :data:`REFERENCE`; needs a speed above 0.

    With the velocity V and the acceleration A: speed |V|, direction V/|V|, yaw rate (V x A)/|V|^2, and the derivatives
    of speed and yaw rate, which take the third derivatives of the flat outputs.
    """
    speed = sp.sqrt(VELOCITY.dot(VELOCITY))
    yaw_rate = turned(VELOCITY).dot(ACCELERATION) / VELOCITY.dot(VELOCITY)
    return PostureReference(VELOCITY / speed, speed, yaw_rate, derivative(speed), derivative(yaw_rate))


def posture_inputs() -> tuple[Input, ...]:
    """Inputs of a law on the bare robot: its states, as they are named there, and the reference."""
    return (*(Input(one.name, one.unit, one.description) for one in robot().states), *REFERENCE)


def acceleration_outputs(law: Mapping[str, sp.Expr]) -> tuple[Output, ...]:
    """Outputs ``u[1..2]`` of a law."""
    commands = {one.name: one for one in robot().inputs}
    return tuple(Output(name, commands[name].unit, commands[name].description, law[name]) for name in law)


def moving_reference(name: str) -> Check:
    """What explains a step that fails because the reference is at rest."""
    return Check(
        "reference at rest",
        VELOCITY.dot(VELOCITY) > 0,
        f"{name} tracks moving references only: where the reference is at rest its heading is undefined; "
        "let it move, or regulate with an outer loop on v",
        when="failure",
    )


def posture_reference() -> Block:
    """Flat outputs to posture: what the laws on the accelerations ``u`` derive from a reference, for recording.

    Inputs ``Z1d[1..3]``, ``Z2d[1..3]``, ``zd3[1..2]``; outputs the unit vector ``direction[1..2]`` along which the
    reference drives, its forward velocity ``eta_d[1]`` >= 0 in m/s, yaw rate ``eta_d[2]`` in rad/s, and their
    derivatives ``u_d[1..2]`` in m/s2, rad/s2. Undefined where the reference is at rest: a step there fails and says so.

    Source: the flat outputs (x, y) of the unicycle, M. Fliess, J. Lévine, P. Martin and P. Rouchon, Int. J. Control 61
    (1995) 1327-1361, doi:10.1080/00207179508921959; driving forward is this project's choice of the two solutions.
    """
    d = reference_posture()
    values = (
        *(("direction", k, "1", "direction of the reference", one) for k, one in enumerate(d.direction, 1)),
        ("eta_d", 1, "m/s", "forward velocity of the reference", d.speed),
        ("eta_d", 2, "rad/s", "yaw rate of the reference", d.yaw_rate),
        ("u_d", 1, "m/s2", "forward acceleration of the reference", d.forward_acceleration),
        ("u_d", 2, "rad/s2", "yaw acceleration of the reference", d.yaw_acceleration),
    )
    return Block(
        "posture_reference",
        "posture and speeds of a flat reference",
        inputs=REFERENCE,
        outputs=tuple(Output(f"{name}[{k}]", unit, what, one) for name, k, unit, what, one in values),
        checks=(moving_reference("posture_reference"),),
    )
