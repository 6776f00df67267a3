"""The robot with its loops cut at both actuators, linearised along a steady motion, in SymPy."""

from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from brunovsky.blocks import robot_linearization
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.linearization.simplify import tidy


@dataclass(frozen=True)
class OpenedLoop:
    """Linearisation x' = A x + B a, u = C x of the robot with actuators a cut from commands u, in SymPy.

    Attributes
    ----------
    A, B, C : sympy.ImmutableDenseMatrix, shapes (6, 6), (6, 2), (2, 6)
        In the frame of the reference: forward and left deviation, then heading, speed, yaw rate and compensator u1.
    speed, yaw_rate : sympy.Symbol
        Of the motion.
    gains : tuple of sympy.ImmutableDenseMatrix, shapes (2, 2)
        Gain of the error, its first and second derivative, in the same frame (in v = -sum K_k e^(k)).
    """

    A: sp.ImmutableDenseMatrix
    B: sp.ImmutableDenseMatrix
    C: sp.ImmutableDenseMatrix
    speed: sp.Symbol
    yaw_rate: sp.Symbol
    gains: tuple[sp.ImmutableDenseMatrix, ...]


@lru_cache
def opened_loop(heading: sp.Expr = sp.S.Zero) -> OpenedLoop:
    """Linearise the robot, its inner loop and a linear outer loop along a steady motion, with both actuators cut.

    Parameters
    ----------
    heading : sympy.Expr
        Heading at which to do so, in rad; the result doesn't depend on it (a test says so with a symbol), which is the
        time-invariance that the transfer functions rest on.

    Returns
    -------
    OpenedLoop
        Derived from `brunovsky.blocks.robot_linearization`.

    References
    ----------
    The paper's eqs. (9), (12)-(16), corrected, and (19).
    """
    linearization = robot_linearization()
    plant, extended = linearization.system, linearization.extended_system
    speed, yaw_rate = sp.symbols("V omega", real=True)
    orders = range(ROBOT_CHAINS.orders[0])
    gains = tuple(sp.ImmutableDenseMatrix(2, 2, sp.symbols(f"k{k}(1:3)(1:3)", real=True)) for k in orders)
    actuators = sp.symbols("a1 a2", real=True)
    law = dict(linearization.law)
    slopes = dict(zip(extended.states, extended.dynamics, strict=True))
    compensator = extended.states[len(plant.states) :]
    field = sp.Matrix(
        [
            *(plant.drift + plant.input_matrix * sp.Matrix(actuators)),
            *(slopes[one].xreplace(law) for one in compensator),
        ]
    )
    command = sp.Matrix([linearization.input_map[one].xreplace(law) for one in plant.inputs])
    states, outer = sp.Matrix(extended.states), sp.Matrix(linearization.outer_inputs)
    theta, eta1, eta2 = plant.states[2:]
    along = {theta: heading, eta1: speed, eta2: yaw_rate, **dict.fromkeys(compensator, sp.S.Zero)}
    along |= dict(zip(outer, linearization.drift_term.subs(along), strict=True))  # zd''', where u2 = w1 = 0
    to_body = sp.Matrix([[-sp.sin(heading), sp.cos(heading)], [-sp.cos(heading), -sp.sin(heading)]])
    outer_law = sp.zeros(2, len(states))
    for k, gain in enumerate(gains):
        derivative = sp.Matrix([chain[k] for chain in linearization.chains])
        outer_law -= to_body.T * gain * to_body * derivative.jacobian(states)

    def total(function: sp.Matrix) -> sp.Matrix:
        return (function.jacobian(states) + function.jacobian(outer) * outer_law).subs(along)

    frame, turning = sp.eye(len(states)), sp.zeros(len(states))
    frame[:2, :2] = to_body
    turning[0, 1], turning[1, 0] = yaw_rate, -yaw_rate  # frame' = turning frame
    parts = (
        frame * total(field) * frame.T + turning,
        frame * field.jacobian(actuators).subs(along),
        total(command) * frame.T,
    )
    A, B, C = (sp.ImmutableDenseMatrix(part.applyfunc(tidy)) for part in parts)
    return OpenedLoop(A, B, C, speed, yaw_rate, gains)
