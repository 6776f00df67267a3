"""Margins of the robot's loop at one actuator or at both at once, along a straight line or a circle."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import expm
from scipy.optimize import brentq

from brunovsky.analysis.linear._frequencies import frequencies
from brunovsky.analysis.robot.actuator_loop import actuator_loop
from brunovsky.analysis.robot.steady_motion import SteadyMotion
from brunovsky.errors import ParameterError

Matrix = NDArray[np.float64]
_DECADES, _POINTS = (
    3.0,
    1200,
)  # around 1 in which gains are looked at; times likewise around the slowest and fastest pole


@dataclass(frozen=True)
class ActuatorMargins:
    """What the robot's loop tolerates at its actuators; see `actuator_margins`.

    Attributes
    ----------
    gain_lower, gain_upper : float
        Factors between which the gain of the actuators, the same for each, may vary; 0 and inf where nothing from
        1/1000 to 1000 limits it.
    delay : float
        Longest delay of these actuators (s).
    lag, two_lags : float
        Largest time constant of one lag of each, and of each of two equal ones (s).
    """

    gain_lower: float
    gain_upper: float
    delay: float
    lag: float
    two_lags: float


def actuator_margins(gain: ArrayLike, motion: SteadyMotion, actuators: Sequence[int] = (1, 2)) -> ActuatorMargins:
    """Gain, delay and lags that the robot's loop tolerates at the actuators named, equal for each; others are ideal.

    At one actuator these are the margins of `actuator_loop_transfer`. At both they are in general not the lesser ones
    of the two: what acts is the loop's matrix, whose channels a circle couples.

    Parameters
    ----------
    gain : array_like, shape (3,) or (2, 3)
        As for `actuator_loop`.
    motion : SteadyMotion
        Straight line or circle.
    actuators : sequence of int
        1 for u1, 2 for u2, or both.

    Returns
    -------
    ActuatorMargins
        The smallest changes at which a pole reaches the imaginary axis; inf where none does.

    Raises
    ------
    ParameterError
        As for `actuator_loop`; if the loop is not stable as it is, or `actuators` are not 1, 2 or both.

    References
    ----------
    The generalised Nyquist criterion: A. G. J. MacFarlane and I. Postlethwaite, "The generalized Nyquist stability
    criterion and multivariable root loci", Int. J. Control 25(1), 81-127, 1977.
    """
    where = "actuator_margins"
    chosen = sorted(set(actuators))
    if not chosen or len(chosen) < len(actuators) or not set(chosen) <= {1, 2}:
        raise ParameterError(f"{where}: actuators = {actuators!r}; pass (1,) for u1, (2,) for u2, or (1, 2)")
    loop = actuator_loop(gain, motion)
    cut = [one - 1 for one in chosen]
    others = [one for one in (0, 1) if one not in cut]
    A = loop.A - loop.B[:, others] @ loop.C[others, :]
    B, C = loop.B[:, cut], loop.C[cut, :]
    closed = np.linalg.eigvals(A - B @ C)
    if _abscissa(A - B @ C) >= 0.0:
        raise ParameterError(f"{where}: the loop with K = {gain!r} is not stable, so it has no margins; pass another K")
    times = np.geomspace(1e-4 / np.max(np.abs(closed)), 1e3 / np.min(np.abs(closed)), _POINTS)
    factors = np.geomspace(1.0, 10.0**_DECADES, _POINTS)
    return ActuatorMargins(
        gain_lower=1.0 / _first(lambda k: _abscissa(A - B @ C / k), factors),
        gain_upper=_first(lambda k: _abscissa(A - k * B @ C), factors),
        delay=_delay(A, B, C, closed),
        lag=_first(lambda tau: _abscissa(_lagging(A, B, C, tau, 1)), times),
        two_lags=_first(lambda tau: _abscissa(_lagging(A, B, C, tau, 2)), times),
    )


def longest_robot_sampling(gain: ArrayLike | Callable[[float], ArrayLike], motion: SteadyMotion) -> float:
    """Sampling period of sensors, law and commands at which the robot's loop loses stability along a steady motion.

    Exact for `brunovsky.blocks.robot_with_hardware` with a period: in the frame of the motion the commands are held,
    the robot is sampled exactly, and the compensator, whose inputs are held as well, is integrated by Euler's rule.

    Parameters
    ----------
    gain : array_like, shape (3,), or function of float
        K of v = -K e for both axes (1/s3, 1/s2, 1/s), or K for a period (s), as of laws that know it.
    motion : SteadyMotion
        Straight line or circle.

    Returns
    -------
    float
        The first period (s) with a pole on the unit circle, of those from 1/1000 to 10 s; inf where there is none.

    Raises
    ------
    ParameterError
        As for `actuator_loop`; if the loop is not stable at the shortest period.

    References
    ----------
    K. J. Åström and B. Wittenmark, *Computer-Controlled Systems*, 3rd ed., 1997.
    """

    def excess(period: float) -> float:
        loop = actuator_loop(gain(period) if callable(gain) else gain, motion)
        n = loop.nstates - 1  # the last state is the compensator's
        moved = expm(period * np.block([[loop.A[:n, :n], loop.B[:n]], [np.zeros((2, n + 2))]]))
        step = np.zeros((n + 1, n + 1))
        step[:n, :n] = moved[:n, :n]
        step[:n] -= moved[:n, n:] @ loop.C
        step[n] = period * loop.A[n]
        step[n, n] += 1.0
        return float(np.max(np.abs(np.linalg.eigvals(step)))) - 1.0

    periods = np.geomspace(1e-3, 10.0, 400)
    if excess(float(periods[0])) >= 0.0:
        raise ParameterError("longest_robot_sampling: the loop is not stable with a period of 1 ms; pass another gain")
    return _first(excess, periods)


def _abscissa(A: Matrix) -> float:
    return float(np.max(np.linalg.eigvals(A).real))


def _first(excess: Callable[[float], float], grid: Matrix) -> float:
    """First number from which the loop is not stable; inf where there is none."""
    for before, after in pairwise(grid):
        if excess(float(after)) > 0.0:
            return float(brentq(excess, before, after, rtol=1e-12)) if excess(float(before)) < 0.0 else float(before)
    return float("inf")


def _lagging(A: Matrix, B: Matrix, C: Matrix, tau: float, lags: int) -> Matrix:
    """Closed loop with equal lags in series at each input."""
    n, m = B.shape
    size = n + lags * m
    found = np.zeros((size, size))
    found[:n, :n], found[:n, size - m :] = A, B  # the last lag drives the plant
    for k in range(lags):
        rows = slice(n + k * m, n + (k + 1) * m)
        found[rows, rows] = -np.eye(m) / tau
        if k == 0:
            found[rows, :n] = -C / tau
        else:
            found[rows, n + (k - 1) * m : n + k * m] = np.eye(m) / tau
    return found


def _delay(A: Matrix, B: Matrix, C: Matrix, closed: NDArray[Any]) -> float:
    """Shortest T for which an eigenvalue of L(j w) exp(-j w T) is -1."""

    def loci(w: ArrayLike) -> NDArray[np.complex128]:
        """Eigenvalues by magnitude, a row for each frequency."""
        shifted = 1j * np.multiply.outer(w, np.eye(len(A))) - A
        found = np.linalg.eigvals(C @ np.linalg.solve(shifted, np.broadcast_to(B, (*shifted.shape[:-2], *B.shape))))
        return np.asarray(np.take_along_axis(found, np.argsort(np.abs(found), axis=-1), axis=-1))

    size = np.abs(closed)
    grid = frequencies(tuple(closed), 1e-3 * float(np.min(size)), 1e3 * float(np.max(size)))
    values = np.log(np.abs(loci(grid)))
    delays = []
    for i in range(B.shape[1]):

        def modulus(w: float, i: int = i) -> float:
            return float(np.log(np.abs(loci(w)[i])))

        for k in np.flatnonzero(np.signbit(values[:-1, i]) != np.signbit(values[1:, i])):
            w = brentq(modulus, grid[k], grid[k + 1], rtol=1e-13)
            delays.append(float(np.mod(np.angle(loci(w)[i]) + np.pi, 2.0 * np.pi)) / w)
    return min(delays, default=float("inf"))
