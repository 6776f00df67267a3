"""The robot's loop cut at its actuators, along a steady motion: a straight line or a circle at constant speed.

There is a transfer function at u only where the linearisation along the motion doesn't change with time. In a frame
that moves with the reference (forward, left) this is so for constant speed and yaw rate, provided both axes have the
same gains, so that the outer loop looks the same from each heading; on a straight line the frame doesn't turn, and the
gains may differ.

Where the loop is cut: u2 between the law's output and the yaw actuator; u1 between the compensator's state, which is
part of the controller, and the forward actuator. The controller computes the chains from measured x, y, theta, eta and
its own u1. The linearisation holds where the law isn't guarded, abs(eta1) > eta_min.
"""

from collections.abc import Callable
from functools import lru_cache

import control
import numpy as np
import sympy as sp
from numpy.typing import ArrayLike, NDArray

from brunovsky.analysis.robot.opened_loop import opened_loop
from brunovsky.analysis.robot.steady_motion import SteadyMotion
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.errors import ParameterError

ACTUATORS = ("u[1]", "u[2]")


def actuator_loop(gain: ArrayLike, motion: SteadyMotion) -> control.StateSpace:
    """Loop transfer matrix of the robot cut at both actuators, along a straight line or a circle.

    Parameters
    ----------
    gain : array_like, shape (3,) or (2, 3)
        K of v = -K e for both axes (1/s3, 1/s2, 1/s), or a row for each, which a circle doesn't allow.
    motion : SteadyMotion
        Speed and yaw rate; the heading matters only where the gains differ.

    Returns
    -------
    control.StateSpace
        L with the sign of negative feedback: inputs ``u[1]``, ``u[2]`` as the actuators apply them (m/s2, rad/s2),
        outputs minus the commands; the closed loop has (I + L)^-1. States: deviations forward and left (m), of heading,
        speed, yaw rate and compensator. `return_difference` and `disk_margin` take it; for one loop at a time see
        `actuator_loop_transfer`.

    Raises
    ------
    ParameterError
        If the gain has another shape, isn't finite, or differs between the axes on a circle.

    References
    ----------
    The paper's eqs. (9), (12)-(16), corrected, and (19).
    """
    A, B, C = _evaluated()(*_values(gain, motion, "actuator_loop").values())
    states = ["forward", "left", "theta", "eta[1]", "eta[2]", "u[1]"]
    returned = [f"{one}_return" for one in ACTUATORS]
    return control.ss(A, B, -C, 0, inputs=list(ACTUATORS), outputs=returned, states=states, name="L_u")


def actuator_loop_transfer(gain: ArrayLike, motion: SteadyMotion, actuator: int) -> control.TransferFunction:
    """Loop transfer function of the robot cut at one actuator, the other one working.

    On a straight line the loop at u2 is that at v, whatever the speed; at u1 it is (k2 s + k1) / (s^2 (s + k3)), since
    the compensator's integrator lies on the controller's side of the cut. Speed drops out on a circle as well: only its
    yaw rate matters.

    Parameters
    ----------
    gain : array_like, shape (3,) or (2, 3)
        K of v = -K e for both axes (1/s3, 1/s2, 1/s), or a row for each, which a circle doesn't allow.
    motion : SteadyMotion
        Speed and yaw rate; the heading matters only where the gains differ.
    actuator : int
        1 for u1, forward; 2 for u2, yaw.

    Returns
    -------
    control.TransferFunction
        L with the sign of negative feedback, without common factors (found in exact arithmetic); for `loop_margins`,
        `disk_margin`, `control.bode_plot` and so on.

    Raises
    ------
    ParameterError
        If the gain has another shape, isn't finite, or differs between the axes on a circle, or there is no such
        actuator.

    References
    ----------
    The paper's eqs. (9), (12)-(16), corrected, and (19).
    """
    where = "actuator_loop_transfer"
    if isinstance(actuator, bool) or actuator not in (1, 2):
        raise ParameterError(f"{where}: actuator = {actuator!r}; pass 1 for u1 (forward) or 2 for u2 (yaw)")
    loop = opened_loop()
    exact = {one: sp.Rational(number) for one, number in _values(gain, motion, where).items()}
    A, B, C = (part.subs(exact) for part in (loop.A, loop.B, loop.C))
    cut, other = actuator - 1, 2 - actuator
    s = sp.Symbol("s")
    working = A + B[:, other] * C[other, :]
    opened = working.charpoly(s).as_expr(s)
    closed = (working + B[:, cut] * C[cut, :]).charpoly(s).as_expr(s)  # 1 + L = closed/opened
    top, bottom = (sp.Poly(one, s) for one in sp.fraction(sp.cancel((closed - opened) / opened)))
    leading = bottom.LC()
    numbers = [[float(one / leading) for one in part.all_coeffs()] for part in (top, bottom)]
    name = ACTUATORS[cut]
    return control.tf(*numbers, inputs=[name], outputs=[f"{name}_return"], name=f"L_{name}")


def return_difference(loop: control.StateSpace) -> control.StateSpace:
    """Return difference I + L of a loop with several channels, for `control.singular_values_response` and its plot.

    Parameters
    ----------
    loop : control.StateSpace
        L with m inputs and outputs and the sign of negative feedback, from `actuator_loop`.

    Returns
    -------
    control.StateSpace
        I + L. Its smallest singular value over frequency is the distance to singularity: an additive change of L below
        it leaves the loop stable. It depends on the units of the channels, which `disk_margin` doesn't.

    Raises
    ------
    ParameterError
        If `loop` is not a square state-space system.

    References
    ----------
    K. J. Åström and R. M. Murray, *Feedback Systems*, 2008, doi:10.1515/9781400828739 (for m = 1, abs(1 + L)).
    """
    if not isinstance(loop, control.StateSpace) or loop.ninputs != loop.noutputs:
        raise ParameterError("return_difference: the loop is no square control.StateSpace; pass one from actuator_loop")
    names = {"inputs": loop.input_labels, "outputs": loop.output_labels, "states": loop.state_labels}
    return control.ss(loop.A, loop.B, loop.C, loop.D + np.eye(loop.ninputs), name="I + L", **names)


@lru_cache
def _evaluated() -> Callable[..., tuple[NDArray[np.float64], ...]]:
    """A, B and C of the opened loop as a function of speed, yaw rate and gains."""
    loop = opened_loop()
    symbols = [loop.speed, loop.yaw_rate, *(one for gain in loop.gains for one in gain)]
    found: Callable[..., tuple[NDArray[np.float64], ...]] = sp.lambdify(symbols, (loop.A, loop.B, loop.C))
    return found


def _values(gain: ArrayLike, motion: SteadyMotion, where: str) -> dict[sp.Symbol, float]:
    """What the symbols of the opened loop stand for: speed, yaw rate, then the gains in the frame of the motion."""
    if not isinstance(motion, SteadyMotion):
        raise ParameterError(
            f"{where}: motion = {motion!r} is no SteadyMotion; pass SteadyMotion(speed, yaw_rate), or "
            "steady_motion(reference) for a reference block"
        )
    rows = _axis_gains(gain, where)
    if motion.yaw_rate != 0.0 and not np.array_equal(rows[0], rows[1]):
        raise ParameterError(
            f"{where}: the axes have different gains {rows.tolist()}, so that on a circle (yaw rate "
            f"{motion.yaw_rate:g} rad/s) the loop changes with the heading: it is periodic in time and has no transfer "
            "function; pass the same gain for both axes, or a straight line"
        )
    loop = opened_loop()
    cosine, sine = (round(float(one), 15) for one in (np.cos(motion.heading), np.sin(motion.heading)))
    to_body = np.array([[-sine, cosine], [-cosine, -sine]])
    values = {loop.speed: float(motion.speed), loop.yaw_rate: float(motion.yaw_rate)}
    for k, symbols in enumerate(loop.gains):
        same = rows[0, k] == rows[1, k]
        value = rows[0, k] * np.eye(2) if same else to_body @ np.diag(rows[:, k]) @ to_body.T
        values |= dict(zip(symbols, map(float, value.flat), strict=True))
    return values


def _axis_gains(gain: ArrayLike, where: str) -> NDArray[np.float64]:
    try:
        rows = np.asarray(gain, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"{where}: K = {gain!r} is not made of real numbers; pass K = [k1, k2, k3]") from error
    if rows.shape not in ((ROBOT_CHAINS.orders[0],), (2, ROBOT_CHAINS.orders[0])):
        raise ParameterError(f"{where}: K has shape {rows.shape}; pass K = [k1, k2, k3], or one such row for each axis")
    if not np.all(np.isfinite(rows)):
        raise ParameterError(f"{where}: K = {rows.tolist()} is not finite; pass finite gains")
    return np.broadcast_to(rows, (2, ROBOT_CHAINS.orders[0]))
