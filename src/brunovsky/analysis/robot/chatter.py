"""Chatter of the robot whose actuators lag, predicted along a straight line at any heading.

A lag at u2 is one at v, for the part of the motion across the heading; a lag at u1 is not, for the part along it: the
compensator's state, which the sliding variable contains, is the command, so S answers the relay at once and slides.
The relays switch S[1] and S[2] of axes that don't turn with the robot, which couples the two parts.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import control
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from brunovsky.analysis._checks import finite_scalar, finite_vector
from brunovsky.analysis.chatter.limit_cycles import require_switching
from brunovsky.analysis.chatter.switching_loop import SwitchingLoop
from brunovsky.analysis.system import to_control
from brunovsky.blocks import robot_with_lags
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.errors import ParameterError

SPEED = 0.5  # m/s; the chatter doesn't depend on it


@dataclass(frozen=True)
class RobotChatter:
    """Chatter of the robot along a straight line with lags at its actuators, by describing function.

    Attributes
    ----------
    axis : int
        Whose relay oscillates, 1 for x and 2 for y: the one that is more across the heading than along it.
    amplitude, frequency : float
        Of its S (m/s2; rad/s).
    other : float
        Amplitude of the equivalent control of the other axis in units of P. Below 1 that axis slides, as was assumed;
        above, the prediction does not hold.
    """

    axis: int
    amplitude: float
    frequency: float
    other: float


def actuated_response(loop: SwitchingLoop, frequency: ArrayLike, heading: float = 0.0) -> NDArray[np.complex128]:
    """W(j w) of the robot with the loop's lags at both actuators: (S[1], S[2]) = -W (f1, f2), along a straight line.

    Parameters
    ----------
    loop : SwitchingLoop
        Continuous, with chains of three, at least one lag, all equal, no delay and no hysteresis.
    frequency : array_like, shape (N,)
        w > 0 (rad/s).
    heading : float
        Of the line (rad).

    Returns
    -------
    ndarray of complex, shape (N, 2, 2)
        Linearisation of `brunovsky.blocks.robot_with_lags`, with the linear part of the law closed (m/s2). Across the
        heading it is `SwitchingLoop.frequency_response`; along it, it falls with P/(j w) however large the lag. The
        speed drops out.

    Raises
    ------
    ParameterError
        If the loop is another one, or a number not finite.

    References
    ----------
    The paper's eqs. (9), (12)-(16), corrected, and (20)-(23).
    """
    where = "actuated_response"
    require_lags(loop, where)
    theta = finite_scalar(heading, "heading", where)
    w = finite_vector(frequency, "frequency", where)
    if np.any(w <= 0.0):
        raise ParameterError(f"{where}: frequency = {w.min():g} is not positive; pass frequencies above 0 rad/s")
    system = _lagging_robot(len(loop.lags))
    point = np.zeros(system.nstates)
    point[system.state_index["theta"]], point[system.state_index["eta[1]"]] = theta, SPEED
    constants = system.params | {"lag[1]": loop.lags[0], "lag[2]": loop.lags[0]}
    found = control.linearize(system, point, np.zeros(system.ninputs), params=constants, copy_names=True)
    chains = [f"Z{i}[{k}]" for i in (1, 2) for k in (1, 2, 3)]
    Z = found[chains, ["v[1]", "v[2]"]](1j * w, squeeze=False).transpose(2, 0, 1)
    gain, surface = (np.kron(np.eye(2), row) for row in (loop.gain, loop.surface))
    closed = Z @ np.linalg.inv(np.eye(2) + gain @ Z)
    return np.asarray(loop.switching_gain / loop.surface[-1] * surface @ closed, dtype=np.complex128)


def predicted_robot_chatter(loop: SwitchingLoop, heading: float = 0.0) -> RobotChatter | None:
    """Chatter of the robot along a straight line with the loop's lags at both actuators, by describing function.

    One axis oscillates, the other slides and follows with its equivalent control, so that the relay of the first sees
    1/(W^-1)_ii of `actuated_response`.

    Parameters
    ----------
    loop : SwitchingLoop
        As for `actuated_response`, with P > 0 and no boundary layer.
    heading : float
        Of the line (rad).

    Returns
    -------
    RobotChatter or None
        The crossing of the negative real axis with the highest frequency; None where there is none. See its ``other``.

    Raises
    ------
    ParameterError
        If the loop is another one, or the heading not finite.

    References
    ----------
    A. Gelb and W. E. Vander Velde, *Multiple-Input Describing Functions and Nonlinear System Design*, McGraw-Hill,
    1968; V. I. Utkin, "Variable structure systems with sliding modes", IEEE Trans. Autom. Control 22(2), 212-222,
    1977, doi:10.1109/TAC.1977.1101446, on equivalent control.
    """
    where = "predicted_robot_chatter"
    require_lags(loop, where)
    require_sign(loop, where)
    axis = _across(finite_scalar(heading, "heading", where))
    own, other = axis - 1, 2 - axis

    def inverse(w: ArrayLike) -> NDArray[np.complex128]:
        return np.asarray(np.linalg.inv(actuated_response(loop, np.atleast_1d(w), heading)), dtype=np.complex128)

    grid = loop.frequencies()
    seen = 1.0 / inverse(grid)[:, own, own]
    crossings = np.flatnonzero((seen.imag[:-1] < 0.0) & (seen.imag[1:] >= 0.0) & (seen.real[:-1] < 0.0))
    if crossings.size == 0:
        return None
    cell = grid[crossings[-1] : crossings[-1] + 2]
    frequency = float(brentq(lambda w: float(inverse(w)[0, own, own].imag), *cell, rtol=1e-9))
    matrix = inverse(frequency)[0]
    amplitude = 4.0 / np.pi / abs(matrix[own, own])
    return RobotChatter(
        axis, float(amplitude), frequency, float(4.0 / np.pi * abs(matrix[other, own] / matrix[own, own]))
    )


@lru_cache
def _lagging_robot(number: int) -> control.NonlinearIOSystem:
    return to_control(robot_with_lags(number=number))


def _across(heading: float) -> int:
    """Axis that is more across a heading, along (-sin, cos), than along it."""
    return 1 if abs(np.cos(heading)) >= abs(np.sin(heading)) else 2


def require_lags(loop: SwitchingLoop, where: str) -> None:
    """Raise ParameterError where the loop has anything but equal lags, or chains that are not the robot's."""
    delayed = loop.delay > 0.0 or loop.sampling is not None or loop.hysteresis > 0.0
    if loop.order != ROBOT_CHAINS.orders[0] or not loop.lags or len(set(loop.lags)) > 1 or delayed:
        raise ParameterError(
            f"{where}: the robot's actuators have equal lags and nothing else, and its chains three integrators; pass "
            "SwitchingLoop([c1, c2, c3], Q, P, lags=[tau]) or lags=[tau, tau]"
        )


def require_sign(loop: SwitchingLoop, where: str) -> None:
    """Raise ParameterError where nothing switches or the element is no relay."""
    require_switching(loop, where)
    if loop.boundary_layer > 0.0:
        raise ParameterError(f"{where}: a boundary layer phi = {loop.boundary_layer:g} is no relay; pass phi = 0")
