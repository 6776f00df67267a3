"""Backstepping with time-varying feedback, on the accelerations of the bare robot."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.heading import direction, turned
from brunovsky.blocks.library.relatives.posture import (
    POSITION,
    REST,
    acceleration_outputs,
    derivative,
    posture_inputs,
    reference_posture,
)
from brunovsky.blocks.variables import Output, Parameter, symbols

_TINY = 1e-6
_K = (
    Parameter("k[1]", "1/s", "gain of the longitudinal error", 2.0, _TINY, tunable=True),
    Parameter("k[2]", "1/s", "gain of the heading error", 2.0, _TINY, tunable=True),
    Parameter("k[3]", "1/s", "gain of the forward velocity's error", 5.0, _TINY, tunable=True),
    Parameter("k[4]", "1/s", "gain of the yaw rate's error", 5.0, _TINY, tunable=True),
)
_GAMMA = Parameter("gamma", "1/m2", "weight of the lateral error in the yaw rate", 4.0, _TINY, tunable=True)
_G = (
    Parameter("g[1]", "1/s2", "weight of the longitudinal error in the acceleration", 1.0, _TINY, tunable=True),
    Parameter("g[2]", "1/s2", "weight of the heading error in the yaw acceleration", 1.0, _TINY, tunable=True),
)


def backstepping() -> Block:
    """Time-varying tracking law by backstepping from the kinematics into the accelerations.

    In the robot's frame the reference is at (X, Y) with the heading error T = theta_d - theta, and drives with
    v_d(t), w_d(t). Step one: eta*_1 = v_d cos T + k1 X, eta*_2 = w_d + gamma v_d Y + k2 sin T. Step two: with
    S = eta - eta*, u_1 = (eta*_1)' - k3 S_1 + g1 X and u_2 = (eta*_2)' - k4 S_2 + g2 sin T. Then

    V = (X^2 + Y^2)/2 + (1 - cos T)/gamma + S_1^2/(2 g1) + S_2^2/(2 gamma g2),
    V' = -k1 X^2 - (k2/gamma) sin^2 T - (k3/g1) S_1^2 - k4/(gamma g2) S_2^2 <= 0

    exactly, on the nominal robot. X, S and sin T vanish, and so does (v_d^2 + w_d^2) Y^2: the error vanishes if v_d
    or w_d does not, from all starts but those that end with opposite headings, which is unstable. No division by
    eta[1]: the law starts from rest. There is no switching; disturbances leave an error.

    Needs a reference that moves forward, or rests and swings as ``posture_reference`` says: a set point is no more than
    that, since no law of this form stabilises it without w_d. So it tracks, and regulates the position, while the
    heading goes on swinging about ``rest_heading``.

    Source: Z.-P. Jiang and H. Nijmeijer, Tracking control of mobile robots: a case study in backstepping, Automatica 33
    (1997) 1393-1399, doi:10.1016/S0005-1098(97)00055-1, its global law for kinematics and simplified dynamics,
    rederived here, with 1 - cos T for T^2/2, so that no angle wraps, as in Y. Kanayama, Y. Kimura, F. Miyazaki and
    T. Noguchi, A stable tracking control method for an autonomous mobile robot, Proc. IEEE Int. Conf. Robotics and
    Automation 1990, 384-389. Stands for reference [25] of the paper, whose unknown parameters are not estimated here.
    """
    x, y, theta, eta1, eta2 = symbols("x", "y", "theta", "eta[1]", "eta[2]")
    (k1, k2, k3, k4), gamma, (g1, g2) = (one.symbol for one in _K), _GAMMA.symbol, (one.symbol for one in _G)
    reference, heading = reference_posture(), direction(theta)
    gap = POSITION - sp.Matrix([x, y])
    ahead, left = gap.dot(heading), gap.dot(turned(heading))
    sine, cosine = reference.direction.dot(turned(heading)), reference.direction.dot(heading)
    targets = (
        reference.speed * cosine + k1 * ahead,
        reference.yaw_rate + gamma * reference.speed * left + k2 * sine,
    )
    surface = [eta - target for eta, target in zip((eta1, eta2), targets, strict=True)]
    law = {
        "u[1]": derivative(targets[0]) - k3 * surface[0] + g1 * ahead,
        "u[2]": derivative(targets[1]) - k4 * surface[1] + g2 * sine,
    }
    lyapunov = (ahead**2 + left**2) / 2 + (1 - cosine) / gamma + surface[0] ** 2 / (2 * g1)
    return Block(
        "backstepping",
        "backstepping with time-varying feedback",
        inputs=posture_inputs(),
        parameters=(*_K, _GAMMA, *_G, *REST),
        outputs=(
            *acceleration_outputs(law),
            Output("S[1]", "m/s", "error of the forward velocity", surface[0]),
            Output("S[2]", "rad/s", "error of the yaw rate", surface[1]),
            Output("V", "m2", "Lyapunov function", lyapunov + surface[1] ** 2 / (2 * gamma * g2)),
        ),
    )
