"""Plants of the tests, typed in from the references that the tests name."""

import sympy as sp
from sympy import cos, sin

from brunovsky.linearization import AffineSystem

X, Y, THETA, ETA1, ETA2 = sp.symbols("x y theta eta1 eta2", real=True)
U1, U2, W1, V1, V2 = sp.symbols("u1 u2 w1 v1 v2", real=True)
RHO1, RHO2, D1, D2 = sp.symbols("rho1 rho2 d1 d2", real=True)


def robot() -> AffineSystem:
    """Wheeled robot of type (2, 0), the paper's (9) with mass and inertia ratios and acceleration disturbances."""
    return AffineSystem(
        states=(X, Y, THETA, ETA1, ETA2),
        inputs=(U1, U2),
        drift=[-ETA1 * sin(THETA), ETA1 * cos(THETA), ETA2, 0, 0],
        input_matrix=[[0, 0], [0, 0], [0, 0], [RHO1, 0], [0, RHO2]],
        outputs=(X, Y),
        parameters=(RHO1, RHO2),
        disturbances={D1: [0, 0, 0, 1, 0], D2: [0, 0, 0, 0, 1]},
    )


def nominal_robot() -> AffineSystem:
    return robot().with_parameters({"rho1": 1, "rho2": 1})


def pendulum() -> AffineSystem:
    angle, rate, torque, g, length = sp.symbols("angle rate torque g l", real=True)
    return AffineSystem((angle, rate), (torque,), [rate, -g / length * sin(angle)], [0, 1], (angle,), (g, length))


def chain(length: int) -> AffineSystem:
    """A SISO chain with a nonlinear last link: x_i' = x_{i+1}, x_n' = x_1^2 + exp(x_2) u."""
    states = sp.symbols(f"x1:{length + 1}", real=True)
    (u,) = sp.symbols("u,", real=True)
    return AffineSystem(
        states, (u,), [*states[1:], states[0] ** 2], [0] * (length - 1) + [sp.exp(states[1])], (states[0],)
    )


def three_inputs() -> AffineSystem:
    """Outputs 2 and 3 conflict over u2 alone, although every column of the decoupling matrix is occupied."""
    a, b, c, d = sp.symbols("a b c d", real=True)
    u1, u2, u3 = sp.symbols("u1 u2 u3", real=True)
    gains = [[1, 0, 1], [0, 1, 0], [0, 2, 0], [0, 0, 1]]
    return AffineSystem((a, b, c, d), (u1, u2, u3), [0, 0, d, 0], gains, (a, b, c))
