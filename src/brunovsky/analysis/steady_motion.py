"""Motions of the robot along which its linearisation doesn't change with time."""

from collections.abc import Mapping
from dataclasses import dataclass

import sympy as sp

from brunovsky.analysis._checks import finite_scalar
from brunovsky.blocks import TIME, Block
from brunovsky.errors import ParameterError


@dataclass(frozen=True)
class SteadyMotion:
    """Straight line (yaw rate 0) or circle, at constant speed.

    Parameters
    ----------
    speed : float
        Forward velocity eta1, in m/s, of either sign but not zero.
    yaw_rate : float
        eta2, in rad/s; the radius is abs(speed/yaw_rate).
    heading : float
        theta, in rad, of a straight line; on a circle that at t = 0, which changes nothing.

    Raises
    ------
    ParameterError
        If a number isn't finite or the speed is zero.
    """

    speed: float
    yaw_rate: float = 0.0
    heading: float = 0.0

    def __post_init__(self) -> None:
        for name in ("speed", "yaw_rate", "heading"):
            object.__setattr__(self, name, finite_scalar(getattr(self, name), name, "SteadyMotion"))
        if self.speed == 0.0:
            raise ParameterError(
                "SteadyMotion: speed = 0, where the law is singular (det G = -eta1) and has no linearisation; pass a "
                "speed that isn't zero"
            )


def steady_motion(reference: Block, parameters: Mapping[str, float] | None = None) -> SteadyMotion:
    """Find the steady motion that a reference asks of the robot, or say why it is none.

    Parameters
    ----------
    reference : Block
        Block without inputs and states, with outputs ``Z1d[1]`` and ``Z2d[1]`` (m) that are expressions in time, such
        as `brunovsky.blocks.circle`.
    parameters : mapping of str to float, optional
        Values that replace its defaults.

    Returns
    -------
    SteadyMotion
        With positive speed, and the heading at t = 0.

    Raises
    ------
    ParameterError
        If the reference stands still, or its speed or yaw rate changes: the linearisation along it varies with time,
        and there is no transfer function at u. Also for unknown or unsuitable parameters.
    """
    where = f"steady_motion: the reference {getattr(reference, 'name', reference)!r}"
    outputs = {one.name: one.expression for one in reference.outputs} if isinstance(reference, Block) else {}
    if not {"Z1d[1]", "Z2d[1]"} <= set(outputs) or reference.states or reference.inputs or reference.samples:
        raise ParameterError(
            f"{where} is no block that gives Z1d[1] and Z2d[1] as functions of time alone; pass one such as "
            "brunovsky.blocks.circle(), or SteadyMotion(speed, yaw_rate)"
        )
    declared = {one.name: one.symbol for one in reference.parameters}
    values = {
        declared[name]: sp.Rational(float(value)) for name, value in reference.parameter_values(parameters).items()
    }
    position = sp.Matrix([sp.sympify(outputs[f"Z{i}d[1]"]).subs(values) for i in (1, 2)])
    velocity, acceleration = position.diff(TIME), position.diff(TIME, 2)
    square = sp.simplify(velocity.dot(velocity))
    if square == 0:
        raise ParameterError(f"{where} stands still, where the law is singular (det G = -eta1); give it a speed")
    turning = sp.simplify((velocity[0] * acceleration[1] - velocity[1] * acceleration[0]) / square)
    for name, value in (("speed", square), ("yaw rate", turning)):
        if not sp.simplify(value.diff(TIME)).is_zero:
            raise ParameterError(
                f"{where} has a {name} that changes with time, so the linearisation along it does too and there is no "
                "transfer function at u; pass a straight line or a circle at constant speed, look at the loop at v, "
                "which is the same everywhere (loop_transfer), or simulate"
            )
    start = velocity.subs(TIME, 0)
    heading = sp.atan2(-start[0], start[1])  # velocity along (-sin theta, cos theta)
    return SteadyMotion(float(sp.sqrt(square)), float(turning), float(heading))
