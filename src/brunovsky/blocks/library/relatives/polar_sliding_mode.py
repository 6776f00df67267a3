"""Sliding mode in polar coordinates, on the accelerations of the bare robot."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.heading import direction, turned
from brunovsky.blocks.library.outer_loops import saturation
from brunovsky.blocks.library.relatives.posture import (
    POSITION,
    REST,
    VELOCITY,
    acceleration_outputs,
    derivative,
    posture_inputs,
    reference_posture,
)
from brunovsky.blocks.variables import Check, Output, Parameter, symbols

_POLE = (
    Parameter("pole[1]", "m", "origin of the polar coordinates, x"),
    Parameter("pole[2]", "m", "origin of the polar coordinates, y"),
)
_K = (
    Parameter("k[1]", "1/s", "gain of the radial error", 2.0, 0.0, tunable=True),
    Parameter("k[2]", "1/s", "gain of the polar angle's error", 2.0, 0.0, tunable=True),
    Parameter("k[3]", "1/s", "gain of the heading error", 2.0, 0.0, tunable=True),
)
_G = Parameter("g", "rad/m", "yaw rate for a lateral velocity that is wanted", 1.0, 0.0, tunable=True)
_Q = (
    Parameter("Q[1]", "1/s", "exponential reaching gain, forward velocity", 5.0, 0.0, tunable=True),
    Parameter("Q[2]", "1/s", "exponential reaching gain, yaw rate", 5.0, 0.0, tunable=True),
)
_P = (
    Parameter("P[1]", "m/s2", "switching reaching gain, forward velocity", 0.5, 0.0, tunable=True),
    Parameter("P[2]", "rad/s2", "switching reaching gain, yaw rate", 0.5, 0.0, tunable=True),
)
_PHI = (
    Parameter("phi[1]", "m/s", "half-width of the boundary layer, forward velocity; 0: sign", 0.01, 0.0, tunable=True),
    Parameter("phi[2]", "rad/s", "half-width of the boundary layer, yaw rate; 0: sign", 0.01, 0.0, tunable=True),
)


def polar_sliding_mode() -> Block:
    """Sliding mode in polar coordinates r, a around ``pole``: u = (eta*)' - Q S - P sat(S/phi) with S = eta - eta*.

    The wanted velocity W has the polar components r_d' - k1 (r - r_d) and r (a_d' - k2 sin(a - a_d)); with h the
    robot's direction and n the normal to its left,
    eta*_1 = W h and eta*_2 = yaw rate of the reference - k3 sin(theta - theta_d) + g W n.
    S' = -Q S - P sat(S/phi) + d holds exactly on the nominal robot: disturbances d[k] are matched, and rejected up to
    P[k]. No dynamic extension and no division by eta[1]: the law starts from rest. On S = 0, behind a reference that
    moves at v_d on a circle about the pole, small errors have the eigenvalues -k2 and the roots of
    s^2 + (k3 + g v_d) s + g k1 v_d, all on the left; nothing is claimed globally.

    Needs robot and reference away from ``pole`` (a step there fails and says so), and a reference that moves forward,
    or rests and swings as ``posture_reference`` says: the turning is what brings the robot to a set point sideways. So
    it tracks, and regulates the position, while the heading goes on swinging about ``rest_heading``.

    Source: D. Chwa, Sliding-mode tracking control of nonholonomic wheeled mobile robots in polar coordinates, IEEE
    Trans. Control Syst. Technol. 12 (2004) 637-644, taken to be reference [28] of the paper. Its text could not be
    had, so this is not its exact law: the coordinates q = (r, a, theta), the kinematics q' = J(q) eta, the sliding
    variable S = pinv(J) (q' - q_d' + K (q - q_d)) and the reaching law are those that a public reproduction of it
    states. Different here: sines of the angle errors, so that no angle wraps; its terms k_0 sgn(q - q_d) abs(s_theta)
    in S, whose derivative cannot be solved for u everywhere if k_0 > 1, and its second law for a reference at rest
    are left out; g (1 rad/m there) is a parameter; saturations instead of signs.
    """
    x, y, theta, eta1, eta2 = symbols("x", "y", "theta", "eta[1]", "eta[2]")
    pole, (k1, k2, k3), g = sp.Matrix([one.symbol for one in _POLE]), (one.symbol for one in _K), _G.symbol
    reference, heading = reference_posture(), direction(theta)
    arm, arm_d = sp.Matrix([x, y]) - pole, POSITION - pole
    radius, radius_d = sp.sqrt(arm.dot(arm)), sp.sqrt(arm_d.dot(arm_d))
    radial = arm_d.dot(VELOCITY) / radius_d - k1 * (radius - radius_d)
    angular = turned(arm_d).dot(VELOCITY) / radius_d**2 - k2 * turned(arm_d).dot(arm) / (radius * radius_d)
    wanted = radial * arm / radius + angular * turned(arm)
    sine = turned(reference.direction).dot(heading)
    targets = (wanted.dot(heading), reference.yaw_rate - k3 * sine + g * wanted.dot(turned(heading)))
    surface = [eta - target for eta, target in zip((eta1, eta2), targets, strict=True)]
    law = {
        f"u[{k}]": derivative(target) - q.symbol * s - p.symbol * saturation(s, phi.symbol)
        for k, (target, s, q, p, phi) in enumerate(zip(targets, surface, _Q, _P, _PHI, strict=True), 1)
    }
    return Block(
        "polar_sliding_mode",
        "sliding mode in polar coordinates",
        inputs=posture_inputs(),
        parameters=(*_POLE, *_K, _G, *_Q, *_P, *_PHI, *REST),
        outputs=(
            *acceleration_outputs(law),
            Output("S[1]", "m/s", "sliding variable of the forward velocity", surface[0]),
            Output("S[2]", "rad/s", "sliding variable of the yaw rate", surface[1]),
        ),
        checks=(
            Check(
                "sign function",
                sp.And(*(sp.Or(phi.symbol > 0, sp.Eq(p.symbol, 0)) for p, phi in zip(_P, _PHI, strict=True))),
                "phi[k] = 0 (sign function) has no end of events in model exchange; set phi[k] > 0, or P[k] = 0, "
                "or use co-simulation, which samples it once an internal step",
                when="model exchange",
            ),
            Check(
                "pole",
                sp.And(arm.dot(arm) > 0, arm_d.dot(arm_d) > 0),
                "polar_sliding_mode is undefined at its pole; set pole[1..2] to a point that neither the robot nor the "
                "reference passes",
                when="failure",
            ),
        ),
    )
