"""What laws on the accelerations of the bare robot share: posture, reference, and derivatives along the motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.library.heading import direction, turned
from brunovsky.blocks.library.robot import robot, robot_system
from brunovsky.blocks.variables import TIME, Input, Output, Parameter, symbols

REFERENCE = tuple(one for one in ROBOT_CHAINS.inputs if one not in ROBOT_CHAINS.states)
"""Inputs ``Z1d[1..3]``, ``Z2d[1..3]``, ``zd3[1..2]``: the flat outputs to be tracked, with their derivatives."""

POSITION, VELOCITY, ACCELERATION = (sp.Matrix(symbols(f"Z1d[{k}]", f"Z2d[{k}]")) for k in (1, 2, 3))
"""Of the reference, shape (2, 1)."""


REST = (
    Parameter("v_min", "m/s", "speed up to which the reference counts as resting", 0.01, 1e-6),
    Parameter("rest_heading", "rad", "heading of a resting reference, about which it swings"),
    Parameter("swing", "rad", "amplitude of the swing of a resting reference", 1.0),
    Parameter("swing_rate", "rad/s", "angular frequency of the swing of a resting reference", 2.0),
)
"""Parameters of what a reference does at rest, where its flat outputs say nothing of its heading."""


@dataclass(frozen=True)
class PostureReference:
    """Posture, speeds and accelerations behind the flat outputs of a reference that drives forward or rests."""

    direction: sp.Matrix
    speed: sp.Expr
    yaw_rate: sp.Expr
    forward_acceleration: sp.Expr
    yaw_acceleration: sp.Expr


@lru_cache
def _rates() -> Mapping[sp.Symbol, sp.Expr]:
    """Derivatives of the robot's states, of the nominal model without disturbances, and of the reference's."""
    nominal = robot_system().with_parameters(dict.fromkeys(robot_system().parameters, 1))
    undisturbed = dict.fromkeys(nominal.disturbances, 0)
    states = zip(nominal.states, nominal.dynamics.xreplace(undisturbed), strict=True)
    derivatives = (symbols(*(f"Z{i}d[{k}]" for k in (1, 2, 3)), f"zd3[{i}]") for i in ROBOT_CHAINS.numbers)
    reference = (pair for chain in derivatives for pair in pairwise(chain))
    return dict([*states, *reference, (TIME, sp.S.One)])


def derivative(expression: sp.Expr) -> sp.Expr:
    """Derivative in time along the nominal robot and the reference; may contain ``u[1..2]`` and ``zd3[1..2]``."""
    return sp.Add(*(sp.diff(expression, one) * rate for one, rate in _rates().items()))


def reference_posture() -> PostureReference:
    """Posture reference of the inputs :data:`REFERENCE` and the parameters :data:`REST`.

    With the velocity V and the acceleration A of a moving reference: speed abs(V), direction V/abs(V), yaw rate
    V x A/abs(V)^2, and the derivatives of speed and yaw rate, which take the third derivatives of the flat outputs.
    A resting one has speed 0 and swings about its heading.
    """
    limit, heading, swing, rate = (one.symbol for one in REST)
    square = VELOCITY.dot(VELOCITY)
    angle = heading + swing * sp.sin(rate * TIME)

    def where_moving(moving: sp.Expr, resting: sp.Expr) -> sp.Expr:
        return sp.Piecewise((moving, square > limit**2), (resting, True))

    speed = where_moving(sp.sqrt(square), sp.S.Zero)
    yaw_rate = where_moving(turned(VELOCITY).dot(ACCELERATION) / square, derivative(angle))
    along = [where_moving(one / sp.sqrt(square), rest) for one, rest in zip(VELOCITY, direction(angle), strict=True)]
    return PostureReference(sp.Matrix(along), speed, yaw_rate, derivative(speed), derivative(yaw_rate))


def posture_inputs() -> tuple[Input, ...]:
    """Inputs of a law on the bare robot: its states, as they are named there, and the reference."""
    return (*(Input(one.name, one.unit, one.description) for one in robot().states), *REFERENCE)


def acceleration_outputs(law: Mapping[str, sp.Expr]) -> tuple[Output, ...]:
    """Outputs ``u[1..2]`` of a law."""
    commands = {one.name: one for one in robot().inputs}
    return tuple(Output(name, commands[name].unit, commands[name].description, law[name]) for name in law)


def posture_reference() -> Block:
    """Flat outputs to posture: what the laws on the accelerations ``u`` derive from a reference, for recording.

    Inputs ``Z1d[1..3]``, ``Z2d[1..3]``, ``zd3[1..2]``; outputs the unit vector ``direction[1..2]`` along which the
    reference drives, its forward velocity ``eta_d[1]`` >= 0 in m/s, yaw rate ``eta_d[2]`` in rad/s, and their
    derivatives ``u_d[1..2]`` in m/s2, rad/s2. The flat outputs of a resting reference (speed up to ``v_min``) say
    nothing of its heading: it is ``rest_heading + swing sin(swing_rate t)`` then, since the laws need a reference that
    keeps on moving or turning. Where a reference comes to rest its heading jumps, unless it arrives with that one.

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
        parameters=REST,
        outputs=tuple(Output(f"{name}[{k}]", unit, what, one) for name, k, unit, what, one in values),
    )
