"""Things to be balanced: a ball on a beam, a pole on a cart."""

import sympy as sp
from sympy import cos, sin

from brunovsky.linearization.affine import AffineSystem
from brunovsky.linearization.gallery._gravity import GRAVITY


def ball_and_beam() -> AffineSystem:
    """Ball that rolls on a beam whose angular acceleration is the input.

    Output is the ball's position; y''' = b (r' a'^2 - g a' cos a) + 2 b r a' u, so the relative degree is 3 where
    r omega is not 0 and not defined at rest; not full.

    References
    ----------
    J. Hauser, S. Sastry, P. Kokotovic, "Nonlinear control via approximate input-output linearization: the ball and
    beam example", IEEE Trans. Autom. Control 37(3), 392-398, 1992, doi:10.1109/9.119645.
    """
    r, speed, angle, rate, u = sp.symbols("r v alpha omega u", real=True)
    b = sp.Symbol("b", positive=True)
    drift = [speed, b * (r * rate**2 - GRAVITY * sin(angle)), rate, 0]
    return AffineSystem((r, speed, angle, rate), (u,), drift, [0, 0, 0, 1], (r,), (b,))


def cart_pole() -> AffineSystem:
    """Inverted pendulum on a cart; theta = 0 is upright.

    Output is the cart's position; relative degree 2 without an integrator, nowhere singular, not full: the pendulum is
    left, l theta'' = g sin(theta), with eigenvalues +-sqrt(g/l) upright: not minimum phase.

    References
    ----------
    M. W. Spong, "Partial feedback linearization of underactuated mechanical systems", Proc. IEEE/RSJ Int. Conf.
    Intelligent Robots and Systems (IROS), 314-321, 1994, doi:10.1109/IROS.1994.407375.
    """
    s, theta, v, omega, force = sp.symbols("s theta v omega F", real=True)
    cart, bob, length, g = sp.symbols("M m l g", positive=True)
    total = cart + bob * sin(theta) ** 2
    acceleration = bob * sin(theta) * (length * omega**2 - g * cos(theta)) / total
    turning = ((cart + bob) * g * sin(theta) - bob * length * omega**2 * sin(theta) * cos(theta)) / (length * total)
    gains = [0, 0, 1 / total, -cos(theta) / (length * total)]
    return AffineSystem(
        (s, theta, v, omega), (force,), [v, omega, acceleration, turning], gains, (s,), (cart, bob, length, g)
    )
