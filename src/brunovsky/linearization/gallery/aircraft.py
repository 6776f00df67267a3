"""Aircraft that hover: planar ones and the quadrotor."""

import sympy as sp
from sympy import cos, sin, tan

from brunovsky.linearization.affine import AffineSystem
from brunovsky.linearization.gallery._gravity import GRAVITY


def vtol() -> AffineSystem:
    """Planar vertical take-off aircraft without coupling of roll and lift.

    Outputs are the position; relative degree (4, 4) after two integrators on T, one after the other, full, singular at
    T = 0.

    References
    ----------
    J. Hauser, S. Sastry, G. Meyer, "Nonlinear control design for slightly non-minimum phase systems: application to
    V/STOL aircraft", Automatica 28(4), 665-679, 1992, doi:10.1016/0005-1098(92)90029-F (there epsilon = 0).
    """
    x, z, phi, vx, vz, q, thrust, moment = sp.symbols("x z phi vx vz q T tau", real=True)
    mass, inertia = sp.symbols("m J", positive=True)
    gains = [[0, 0], [0, 0], [0, 0], [-sin(phi) / mass, 0], [cos(phi) / mass, 0], [0, 1 / inertia]]
    drift = [vx, vz, q, 0, -GRAVITY, 0]
    return AffineSystem((x, z, phi, vx, vz, q), (thrust, moment), drift, gains, (x, z), (mass, inertia))


def _pvtol(outputs: str, thrust_offset: bool) -> AffineSystem:
    x, y, theta, vx, vy, q, u1, u2 = sp.symbols("x y theta vx vy q u1 u2", real=True)
    eps = sp.Symbol("epsilon", positive=True)
    thrust = eps * q**2 if thrust_offset else 0
    drift = [vx, vy, q, -sin(theta) * thrust, cos(theta) * thrust - 1, 0]
    gains = [[0, 0], [0, 0], [0, 0], [-sin(theta), eps * cos(theta)], [cos(theta), eps * sin(theta)], [0, 1]]
    flat = (x - eps * sin(theta), y + eps * cos(theta))
    chosen = flat if outputs == "flat" else (x, y)
    return AffineSystem((x, y, theta, vx, vy, q), (u1, u2), drift, gains, chosen, (eps,))


def pvtol_centre() -> AffineSystem:
    """Planar vertical take-off aircraft with coupling, outputs at the centre of mass.

    Relative degree (2, 2) without an integrator and det G = -epsilon, but not full: the zero dynamics are those of an
    inverted pendulum, epsilon theta'' = sin(theta), with eigenvalues +-1/sqrt(epsilon) at hover: not minimum phase.

    References
    ----------
    J. Hauser, S. Sastry, G. Meyer, "Nonlinear control design for slightly non-minimum phase systems: application to
    V/STOL aircraft", Automatica 28(4), 665-679, 1992, doi:10.1016/0005-1098(92)90029-F.
    """
    return _pvtol("centre", thrust_offset=False)


def pvtol_flat() -> AffineSystem:
    """Planar vertical take-off aircraft with coupling, flat outputs, thrust shifted by epsilon q^2.

    Outputs are the position of the centre of oscillation; u1 is the thrust less epsilon q^2. Relative degree (4, 4)
    after two integrators on u1, full, singular at u1 = 0.

    References
    ----------
    P. Martin, S. Devasia, B. Paden, "A different look at output tracking: control of a VTOL aircraft", Automatica
    32(1), 101-107, 1996, doi:10.1016/0005-1098(95)00099-2.
    """
    return _pvtol("flat", thrust_offset=True)


def pvtol_flat_untouched() -> AffineSystem:
    """Planar vertical take-off aircraft with coupling, flat outputs, thrust as it is.

    Outputs are the position of the centre of oscillation; the substitution of :func:`pvtol_flat` has to be found.
    Relative degree (4, 4) after one integrator on u1 and one on a combination of the inputs, full, singular at
    u1 = epsilon q^2.

    References
    ----------
    P. Martin, S. Devasia, B. Paden, "A different look at output tracking: control of a VTOL aircraft", Automatica
    32(1), 101-107, 1996, doi:10.1016/0005-1098(95)00099-2.
    """
    return _pvtol("flat", thrust_offset=False)


def quadrotor() -> AffineSystem:
    """Quadrotor with roll, pitch and yaw.

    Outputs are the position and the yaw; relative degree (4, 4, 4, 2) after two integrators on T, full with fourteen
    states, singular at T cos(phi) = 0; the angles are not defined at cos(theta) = 0.

    References
    ----------
    V. Mistler, A. Benallegue, N. K. M'Sirdi, "Exact linearization and noninteracting control of a 4 rotors helicopter
    via dynamic feedback", Proc. 10th IEEE Int. Workshop on Robot and Human Interactive Communication (ROMAN), 2001.
    """
    x, y, z, phi, theta, psi, vx, vy, vz, p, q, r = sp.symbols("x y z phi theta psi vx vy vz p q r", real=True)
    thrust, t1, t2, t3 = sp.symbols("T tau1 tau2 tau3", real=True)
    mass, jx, jy, jz = sp.symbols("m J_x J_y J_z", positive=True)
    turn = q * sin(phi) + r * cos(phi)
    drift = [
        *(vx, vy, vz),
        *(p + turn * tan(theta), q * cos(phi) - r * sin(phi), turn / cos(theta)),
        *(0, 0, -GRAVITY),
        *((jy - jz) / jx * q * r, (jz - jx) / jy * p * r, (jx - jy) / jz * p * q),
    ]
    direction = [
        cos(phi) * sin(theta) * cos(psi) + sin(phi) * sin(psi),
        cos(phi) * sin(theta) * sin(psi) - sin(phi) * cos(psi),
        cos(phi) * cos(theta),
    ]
    gains = sp.zeros(12, 4)
    for i, entry in enumerate(direction):
        gains[6 + i, 0] = entry / mass
    for i, inertia in enumerate((jx, jy, jz)):
        gains[9 + i, 1 + i] = 1 / inertia
    states = (x, y, z, phi, theta, psi, vx, vy, vz, p, q, r)
    return AffineSystem(states, (thrust, t1, t2, t3), drift, gains, (x, y, z, psi), (mass, jx, jy, jz))
