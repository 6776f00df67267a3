"""Wheeled vehicles that roll without slipping."""

import sympy as sp
from sympy import cos, sin, tan

from brunovsky.linearization.affine import AffineSystem


def unicycle() -> AffineSystem:
    """Kinematic unicycle: driven by its speed and its turn rate.

    Outputs are the position; relative degree (2, 2) after one integrator on v, full, singular at v = 0.

    References
    ----------
    B. d'Andréa-Novel, G. Campion, G. Bastin, "Control of nonholonomic wheeled mobile robots by state feedback
    linearization", Int. J. Robotics Research 14(6), 543-559, 1995.
    """
    x, y, heading, speed, turn = sp.symbols("x y theta v omega", real=True)
    return AffineSystem(
        (x, y, heading), (speed, turn), [0, 0, 0], [[cos(heading), 0], [sin(heading), 0], [0, 1]], (x, y)
    )


def car() -> AffineSystem:
    """Kinematic car: driven by its speed and its steering rate.

    Outputs are the position of the rear axle; relative degree (3, 3) after two integrators on v, full, singular at
    v = 0.

    References
    ----------
    M. Fliess, J. Lévine, P. Martin, P. Rouchon, "Flatness and defect of non-linear systems: introductory theory and
    examples", Int. J. Control 61(6), 1327-1361, 1995, doi:10.1080/00207179508921959.
    """
    x, y, heading, steering, speed, rate = sp.symbols("x y theta phi v omega", real=True)
    length = sp.Symbol("L", positive=True)
    forward = [cos(heading), sin(heading), tan(steering) / length, 0]
    gains = sp.Matrix([forward, [0, 0, 0, 1]]).T
    return AffineSystem((x, y, heading, steering), (speed, rate), [0, 0, 0, 0], gains, (x, y), (length,))


def trailer() -> AffineSystem:
    """Unicycle that pulls a trailer.

    Outputs are the position of the trailer's axle; relative degree (3, 3) after one integrator on v and one on a
    combination of the inputs, full, singular at v cos(phi - theta) = 0.

    References
    ----------
    P. Rouchon, M. Fliess, J. Lévine, P. Martin, "Flatness, motion planning and trailer systems", Proc. 32nd IEEE
    Conf. Decision and Control, 1993.
    """
    x, y, heading, pulled, speed, turn = sp.symbols("x y theta phi v omega", real=True)
    length = sp.Symbol("L", positive=True)
    bend = heading - pulled
    forward = [cos(bend) * cos(pulled), cos(bend) * sin(pulled), 0, sin(bend) / length]
    gains = sp.Matrix([forward, [0, 0, 1, 0]]).T
    return AffineSystem((x, y, heading, pulled), (speed, turn), [0, 0, 0, 0], gains, (x, y), (length,))
