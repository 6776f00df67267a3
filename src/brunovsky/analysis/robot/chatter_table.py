"""Chatter of the robot whose actuators lag: predictions and simulation side by side, a row for each heading."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brunovsky.analysis._checks import finite_scalar, finite_vector
from brunovsky.analysis.chatter.limit_cycles import LimitCycle
from brunovsky.analysis.chatter.measured import MeasuredChatter, measured_chatter
from brunovsky.analysis.chatter.relay_locus import relay_cycles
from brunovsky.analysis.chatter.switching_loop import SwitchingLoop
from brunovsky.analysis.linear.design import surface_poles
from brunovsky.analysis.robot.chatter import (
    SPEED,
    RobotChatter,
    predicted_robot_chatter,
    require_lags,
    require_sign,
)
from brunovsky.blocks import Block, closed_loop, line, robot_with_lags, sliding_mode
from brunovsky.errors import ParameterError
from brunovsky.native import simulate

_STEPS = 250  # in a lag
_PERIODS = 40
_STEADY = 1.2  # largest period over the mean, up to which a measured oscillation is steady
_LONGEST = 2_000_000  # steps of a simulation


@dataclass(frozen=True)
class RobotChatterRow:
    """Chatter on a straight line: predicted at v for one chain, at u for the robot, and simulated on the robot.

    Attributes
    ----------
    lag_s : float
        Time constant of each lag (s).
    lags : int
        Number of lags in series at each actuator.
    heading_rad : float
        Of the line (rad).
    at_v : LimitCycle or None
        Of one chain with these lags at v, exact: the smallest stable one of `relay_cycles`.
    at_u : RobotChatter or None
        Of `predicted_robot_chatter`; None where there is none.
    measured : tuple of MeasuredChatter or None, shape (2,)
        Of S[1] and S[2] of the simulated robot.
    axis : int
        Which of them has the larger amplitude, 1 or 2; the errors are those of this axis.
    amplitude_error, frequency_error : float or None
        at_v over what is measured, less 1; None where either is missing, or what is measured still grows or dies out
        (its largest period is above 1.2 times the mean).
    """

    lag_s: float
    lags: int
    heading_rad: float
    at_v: LimitCycle | None
    at_u: RobotChatter | None
    measured: tuple[MeasuredChatter | None, MeasuredChatter | None]
    axis: int
    amplitude_error: float | None
    frequency_error: float | None


def robot_chatter_table(
    loops: Iterable[SwitchingLoop], headings: ArrayLike = (0.0,), step_size: float | None = None
) -> tuple[RobotChatterRow, ...]:
    """Predict and simulate the robot's chatter with lags at its actuators, on straight lines.

    Parameters
    ----------
    loops : iterable of SwitchingLoop
        As for `predicted_robot_chatter`.
    headings : array_like, shape (N,)
        Of the lines (rad).
    step_size : float, optional
        Of the simulation (s); by default a 250th of the lag. sign(S) is frozen over a step, which delays it by half of
        one on average.

    Returns
    -------
    tuple of RobotChatterRow
        For each loop, each heading. Measured over forty periods as predicted, after fifteen time constants of the
        slowest mode; of an axis that slides, amplitude and frequency are those of the step.

    Raises
    ------
    ParameterError
        If a loop is another one, a number not finite or out of range, or a simulation longer than two million steps.
    SimulationError
        If the robot diverges so far that a step is not finite.

    References
    ----------
    See `relay_cycles` and `predicted_robot_chatter`.
    """
    where = "robot_chatter_table"
    angles = finite_vector(headings, "headings", where)
    step = None if step_size is None else finite_scalar(step_size, "step_size", where, minimum=0.0, strict=True)
    return tuple(row for loop in loops for row in _rows(loop, angles, step))


def _rows(loop: SwitchingLoop, headings: NDArray[np.float64], step: float | None) -> Iterable[RobotChatterRow]:
    require_lags(loop, "robot_chatter_table")
    require_sign(loop, "robot_chatter_table")
    at_v = next((one for one in relay_cycles(loop) if one.stable), None)
    for heading in headings.tolist():
        measured = _simulated(loop, heading, step, at_v)
        sizes = [one.amplitude if one else 0.0 for one in measured]
        axis = 1 + int(np.argmax(sizes))
        seen = measured[axis - 1]
        errors = (
            (at_v.amplitude / seen.amplitude - 1.0, at_v.frequency / seen.frequency - 1.0)
            if at_v and seen and seen.largest < _STEADY * seen.amplitude
            else (None, None)
        )
        at_u = predicted_robot_chatter(loop, heading)
        yield RobotChatterRow(loop.lags[0], len(loop.lags), heading, at_v, at_u, measured, axis, *errors)


def _simulated(
    loop: SwitchingLoop, heading: float, step: float | None, expected: LimitCycle | None
) -> tuple[MeasuredChatter | None, MeasuredChatter | None]:
    frequency = expected.frequency if expected else 1.0 / loop.lags[0]
    size = expected.amplitude if expected else loop.switching_gain * loop.lags[0]
    rates = np.abs([one.real for one in surface_poles(loop.surface)] + [loop.reaching_rate or np.inf])
    settled = 15.0 / float(np.min(rates))
    duration = settled + _PERIODS * 2.0 * np.pi / frequency
    step_size = step or loop.lags[0] / _STEPS
    if not duration / step_size <= _LONGEST:
        raise ParameterError(
            f"robot_chatter_table: {duration:.3g} s until the chatter is steady are, in steps of {step_size:.3g} s, "
            f"more than {_LONGEST} steps; pass a longer step_size, or a surface or lags that are not as far apart"
        )
    offset = 0.1 * size / abs(loop.surface[0])
    values = {
        **{f"C[{k}]": one for k, one in enumerate(loop.surface, 1)},
        **{"Q": loop.reaching_rate, "P": loop.switching_gain, "phi": 0.0},
        **{"lag[1]": loop.lags[0], "lag[2]": loop.lags[0]},
        **{"heading": heading, "theta_start": heading, "speed": SPEED, "eta_start[1]": SPEED},
        **{"x_start": offset, "y_start": 0.5 * offset},
    }
    data = simulate(
        _robot_on_a_line(len(loop.lags)),
        duration,
        step_size=step_size,
        parameters=values,
        record=["S[1]", "S[2]"],
    )
    return measured_chatter(data, "S[1]", settled), measured_chatter(data, "S[2]", settled)


@lru_cache
def _robot_on_a_line(number: int) -> Block:
    return closed_loop(sliding_mode(), plant=robot_with_lags(number=number), reference=line())
