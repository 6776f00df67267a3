"""Wheeled mobile robot of type (2, 0): the bare plant, and the plant with its linearising inner loop.

Source: the posture model (9), the extension (13) and the chains (12) of the paper "Variable structure control for a
wheeled mobile robot", with its misprints corrected (see the errata page of the documentation). The uncertainty
(``rho``, ``d``) is this project's.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.diagram import Diagram
from brunovsky.blocks.library.actuators import (
    actuator_delays,
    actuator_holds,
    actuator_lags,
    actuator_limits,
    actuator_series,
)
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.library.outer_inputs import outer_inputs
from brunovsky.blocks.library.sensors import sensors
from brunovsky.blocks.linearized import linearized_block, plant_block
from brunovsky.blocks.variables import Parameter, Variable, symbols
from brunovsky.linearization import AffineSystem, Linearization, linearize

_VARIABLES = (
    Variable("x", "m", "position of the centre of mass along x"),
    Variable("y", "m", "position of the centre of mass along y"),
    Variable("theta", "rad", "heading; the robot moves along (-sin theta, cos theta)"),
    Variable("eta[1]", "m/s", "forward velocity"),
    Variable("eta[2]", "rad/s", "yaw rate"),
    Variable("u[1]", "m/s2", "forward acceleration"),
    Variable("u[2]", "rad/s2", "yaw acceleration"),
    Variable("d[1]", "m/s2", "disturbance of the forward acceleration"),
    Variable("d[2]", "rad/s2", "disturbance of the yaw acceleration"),
)
_ACTUATORS = _VARIABLES[5:7]
_LABELS = {one.symbol: one for one in _VARIABLES}
_RHO = (
    Parameter("rho[1]", "1", "ratio of nominal to true mass", 1.0, 0.0, tunable=True),
    Parameter("rho[2]", "1", "ratio of nominal to true inertia", 1.0, 0.0, tunable=True),
)
_ETA_MIN = Parameter("eta_min", "m/s", "abs(eta[1]) below which 1/eta[1] is regularised", 0.05, 0.0, tunable=True)
_STARTS = {_VARIABLES[3].symbol: 1.0}


def robot_system() -> AffineSystem:
    """Posture model (9) with mass and inertia ratios rho and acceleration disturbances d; outputs x and y, in m."""
    x, y, theta, eta1, eta2, u1, u2, d1, d2 = (one.symbol for one in _VARIABLES)
    rho1, rho2 = (one.symbol for one in _RHO)
    return AffineSystem(
        states=(x, y, theta, eta1, eta2),
        inputs=(u1, u2),
        drift=(-eta1 * sp.sin(theta), eta1 * sp.cos(theta), eta2, 0, 0),
        input_matrix=[[0, 0], [0, 0], [0, 0], [rho1, 0], [0, rho2]],
        outputs=(x, y),
        parameters=(rho1, rho2),
        disturbances={d1: (0, 0, 0, 1, 0), d2: (0, 0, 0, 0, 1)},
    )


@lru_cache
def robot_linearization() -> Linearization:
    """Dynamic feedback linearisation of the nominal robot (rho = 1): relative degree (3, 3), full."""
    return linearize(robot_system().with_parameters(dict.fromkeys(symbols("rho[1]", "rho[2]"), 1)))


def robot() -> Block:
    """Bare plant: inputs ``u[1..2]``, ``d[1..2]``; outputs ``x``, ``y``, ``theta``, ``eta[1..2]`` (its states)."""
    return plant_block(
        robot_system(),
        "robot",
        description="wheeled mobile robot of type (2, 0)",
        labels=_LABELS,
        parameters=_RHO,
        starts=_STARTS,
    )


def linearized_robot(*, measured: bool = False) -> Diagram:
    """Robot with its linearising inner loop: jerk ``v[1..2]`` in, two chains of three integrators to ``x`` and ``y``.

    For ``abs(eta[1]) > eta_min`` the chains are exact; nearer to rest 1/eta[1] becomes eta[1]/eta_min**2.

    Parameters
    ----------
    measured : bool
        Whether ``Zi[3]``, the acceleration, is measured, with disturbance and true mass in it, instead of computed from
        the model; the block is then called ``linearized_robot_measured``. A constant ``d[1]`` is matched then, like
        ``d[2]``; its steps are impulses at the level of ``v``.
    """
    return _linearized(
        "linearized_robot_measured" if measured else "linearized_robot",
        "its linearising inner loop" + (", acceleration measured" if measured else ""),
        measured=measured,
    )


def robot_with_lags(lags: ArrayLike = 0.005, *, number: int = 1) -> Diagram:
    """Linearised robot whose actuators lag: between the inner loop's u and the robot's stand first-order lags.

    The inner loop is that of :func:`linearized_robot` and knows nothing of the lags: its compensator's state is the
    commanded forward acceleration, and ``Zi[3]`` is the acceleration in the plane that the commands would give.

    Parameters
    ----------
    lags : float, or sequence of float, shape (2,)
        Defaults of the time constants ``lag[1]`` (forward) and ``lag[2]`` (yaw), in s; an actuator whose lag is 0 has
        none.
    number : int
        How many equal lags each actuator has, in series.

    Returns
    -------
    Diagram
        Inputs and outputs of :func:`linearized_robot`, of which ``u[1..2]`` are what acts, and ``u_command[1..2]``;
        its parameters, ``lag[i]``, and ``u_start[2]``. For :func:`closed_loop` as its ``plant``.

    Raises
    ------
    ModelError
        If `number` is not positive, or `lags` are neither one nor two.
    ParameterError
        If a lag is negative or not finite.

    References
    ----------
    See :func:`actuator_lags`; the loop at these places: :func:`brunovsky.analysis.actuator_loop`.
    """
    return _linearized(
        "robot_with_lags",
        "its linearising inner loop and actuators that lag",
        actuators=actuator_lags(_ACTUATORS, lags, number=number),
    )


def robot_with_hardware(
    *,
    lags: ArrayLike = 0.0,
    number: int = 1,
    delays: ArrayLike = 0.0,
    limits: ArrayLike = np.inf,
    period: float | None = None,
    noisy: bool = False,
    matched: bool = False,
) -> Diagram:
    """Linearised robot behind sensors and actuators that are not ideal; what is not asked for is not there.

    On the way from the robot to the inner loop of :func:`linearized_robot`, and back:

    * each of x, y, theta, eta[1], eta[2] gets additive noise, the inputs ``n[1..5]``;
    * what is measured is sampled and held, and so are v, which the outer loop computes from it, and the commands u:
      a computer that works every ``sampling_period``. Between samples only the compensator goes on, with what is held,
      so that in effect it is integrated by Euler's rule;
    * the inputs ``dv[1..2]`` are added to v: a matched disturbance, where ``d[1]`` is an unmatched one;
    * commands are delayed (:func:`actuator_delays`), then lag (:func:`actuator_lags`), then saturate
      (:func:`actuator_limits`), and act.

    The law knows nothing of all this: its compensator's state is the commanded forward acceleration, ``Zi[k]`` and
    ``singular`` are what it computes from measurements and commands.

    Parameters
    ----------
    lags, number
        As for :func:`robot_with_lags`; 0 for none.
    delays : float, or sequence of float, shape (2,)
        Defaults of the transport delays ``delay[1]`` and ``delay[2]``, s; 0 for none. With `period` a multiple of it,
        or of a whole part of it.
    limits : float, or sequence of float, shape (2,)
        Defaults of the limits ``u1_max`` (m/s2) and ``u2_max`` (rad/s2); infinite for none.
    period : float, optional
        Default of ``sampling_period``, s; without it nothing is sampled. A sampled outer loop has its own parameter, in
        :func:`closed_loop` called ``controller.sampling_period``.
    noisy, matched : bool
        Whether there are the inputs ``n[1..5]``, and ``dv[1..2]`` (m/s3).

    Returns
    -------
    Diagram
        Inputs and outputs of :func:`linearized_robot`: the true x, y, theta, eta, what acts as ``u[1..2]``, what the
        law sees as ``Zi[k]``; and ``u_command[1..2]``. With sensors that are not ideal also ``x_measured``, ...,
        ``eta_measured[1..2]``, with sampling or matched disturbance ``v_acting[1..2]``. Its parameters, and those of
        what is there: ``sampling_period``, ``delay[i]``, ``lag[i]``, ``u_start[2]``, ``u1_max``, ``u2_max``. For
        :func:`closed_loop` as its ``plant``.

    Raises
    ------
    ModelError
        If `number` is not positive, or there are neither one nor two of `lags`, `delays` or `limits`.
    ParameterError
        If a number is negative or not finite (limits may be infinite), or a delay does not fit the period.

    References
    ----------
    Those of :func:`actuator_delays` and :func:`actuator_lags`.
    """
    states, outer = _VARIABLES[:5], matched or period is not None
    actuators = []
    if period is not None:
        actuators.append(actuator_holds(_ACTUATORS, period))
    if np.any(delays):
        actuators.append(actuator_delays(_ACTUATORS, delays, period=period))
    actuators.append(actuator_lags(_ACTUATORS, lags, number=number))
    if not np.all(np.asarray(limits) == np.inf):
        actuators.append(actuator_limits(_ACTUATORS, limits))
    return _linearized(
        "robot_with_hardware",
        "its linearising inner loop behind sensors and actuators",
        sensors=sensors(states, noisy=noisy, period=period) if noisy or period is not None else None,
        inputs=outer_inputs(ROBOT_CHAINS, matched=matched, period=period) if outer else None,
        actuators=actuator_series(*actuators),
    )


def _linearized(name: str, what: str, **parts: Any) -> Diagram:
    return linearized_block(
        robot_linearization(),
        name,
        plant=robot_system(),
        description=f"wheeled mobile robot with {what}",
        labels=_LABELS,
        parameters=_RHO,
        starts=_STARTS,
        guards={_VARIABLES[3].symbol: _ETA_MIN},
        **parts,
    )
