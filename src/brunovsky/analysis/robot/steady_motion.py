"""Motions of the robot along which its linearisation doesn't change with time."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from brunovsky.analysis._checks import finite_scalar
from brunovsky.blocks import TIME, Block
from brunovsky.errors import ParameterError
from brunovsky.linearization.numeric import numeric_function

_SPAN, _INSTANTS = 97.3, 1009  # s over which, and instants at which, a reference is looked at
_CONSTANT = 1e-9  # relative change that is taken as rounding


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
    if (
        not {"Z1d[1]", "Z2d[1]"} <= set(outputs)
        or reference.states
        or reference.inputs
        or reference.samples
        or reference.modes
    ):
        raise ParameterError(
            f"{where} is no block that gives Z1d[1] and Z2d[1] as functions of time alone; pass one such as "
            "brunovsky.blocks.circle(), or SteadyMotion(speed, yaw_rate)"
        )
    declared = {one.name: one.symbol for one in reference.parameters}
    values = {declared[name]: float(value) for name, value in reference.parameter_values(parameters).items()}
    position = [sp.sympify(outputs[f"Z{i}d[1]"]).subs(values) for i in (1, 2)]
    others = sorted(str(one) for one in sp.Matrix(position).free_symbols - {TIME})
    if others:
        raise ParameterError(
            f"{where} depends on {', '.join(others)} besides time; pass a smooth function of time without switching"
        )
    speeds, turning, heading = _sampled(position)
    if not np.all(np.isfinite([speeds, turning])):
        raise ParameterError(
            f"{where} stands still at some instant, or is not finite; where the speed is zero the law is singular "
            "(det G = -eta1), so give it a speed"
        )
    for name, found in (("speed", speeds), ("yaw rate", turning)):
        if np.ptp(found) > _CONSTANT * np.max(np.abs(found)):
            raise ParameterError(
                f"{where} has a {name} that changes with time, so the linearisation along it does too and there is no "
                "transfer function at u; pass a straight line or a circle at constant speed, look at the loop at v, "
                "which is the same everywhere (loop_transfer), or simulate"
            )
    return SteadyMotion(float(speeds[0]), float(turning[0]), heading)


def _sampled(position: list[sp.Expr]) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Speed and yaw rate at many instants (nan where it stands still), and the heading at t = 0."""
    expressions = [one.diff(TIME, k) for k in (1, 2) for one in position]
    derivatives = numeric_function([TIME], expressions)
    instants = np.linspace(0.0, _SPAN, _INSTANTS)
    with np.errstate(all="ignore"):
        rows = [np.broadcast_to(np.asarray(row, dtype=np.float64), instants.shape) for row in derivatives(instants)]
        (dx, dy), (ddx, ddy) = rows[:2], rows[2:]
        speeds = np.hypot(dx, dy)
        turning = np.where(speeds > 0.0, (dx * ddy - dy * ddx) / speeds**2, np.nan)
        straight = np.abs(turning) <= _CONSTANT * np.hypot(ddx, ddy) / speeds
    return speeds, np.where(straight, 0.0, turning), float(np.arctan2(-dx[0], dy[0]))  # along (-sin, cos) of it
