"""Plants of the literature with known answers, in their least form."""

from functools import cache

import sympy as sp
from linearization_plants import manipulator, nominal_robot, unicycle, vtol
from sympy import cos, sin, tan

from brunovsky.linearization import AffineSystem, Linearization, linearize

GRAVITY = sp.Rational(981, 100)


def car() -> AffineSystem:
    """Kinematic car, outputs at the rear axle (Fliess, Lévine, Martin, Rouchon 1995, 10.1080/00207179508921959)."""
    x, y, heading, steering, speed, rate = sp.symbols("x y theta phi v omega", real=True)
    length = sp.Symbol("L", positive=True)
    forward = [cos(heading), sin(heading), tan(steering) / length, 0]
    gains = sp.Matrix([forward, [0, 0, 0, 1]]).T
    return AffineSystem((x, y, heading, steering), (speed, rate), [0, 0, 0, 0], gains, (x, y), (length,))


def trailer() -> AffineSystem:
    """Unicycle that pulls a trailer, outputs at the trailer's axle (Rouchon, Fliess, Lévine, Martin, CDC 1993)."""
    x, y, heading, pulled, speed, turn = sp.symbols("x y theta phi v omega", real=True)
    length = sp.Symbol("L", positive=True)
    bend = heading - pulled
    forward = [cos(bend) * cos(pulled), cos(bend) * sin(pulled), 0, sin(bend) / length]
    gains = sp.Matrix([forward, [0, 0, 1, 0]]).T
    return AffineSystem((x, y, heading, pulled), (speed, turn), [0, 0, 0, 0], gains, (x, y), (length,))


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
    """PVTOL with coupling, outputs at the centre of mass (Hauser, Sastry, Meyer 1992, 10.1016/0005-1098(92)90029-F)."""
    return _pvtol("centre", thrust_offset=False)


def pvtol_flat() -> AffineSystem:
    """PVTOL, flat output, after u1 - eps theta'^2 (Martin, Devasia, Paden 1996, 10.1016/0005-1098(95)00099-2)."""
    return _pvtol("flat", thrust_offset=True)


def pvtol_flat_untouched() -> AffineSystem:
    """The same without the substitution: the transformation of the inputs has to be found."""
    return _pvtol("flat", thrust_offset=False)


def quadrotor() -> AffineSystem:
    """Quadrotor with roll, pitch, yaw (Mistler, Benallegue, M'Sirdi, ROMAN 2001)."""
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


def flexible_joint() -> AffineSystem:
    """One link behind a spring (Spong 1987, 10.1115/1.3143860)."""
    q1, q2, p1, p2, torque = sp.symbols("q1 q2 p1 p2 tau", real=True)
    link, rotor, weight, stiffness = sp.symbols("I J w k", positive=True)
    spring = stiffness * (q1 - q2)
    drift = [p1, p2, -(weight * sin(q1) + spring) / link, spring / rotor]
    return AffineSystem(
        (q1, q2, p1, p2), (torque,), drift, [0, 0, 0, 1 / rotor], (q1,), (link, rotor, weight, stiffness)
    )


def ball_and_beam() -> AffineSystem:
    """Hauser, Sastry, Kokotovic 1992, 10.1109/9.119645: y''' = b (r' a'^2 - g a' cos a) + 2 b r a' u."""
    r, speed, angle, rate, u = sp.symbols("r v alpha omega u", real=True)
    b = sp.Symbol("b", positive=True)
    drift = [speed, b * (r * rate**2 - GRAVITY * sin(angle)), rate, 0]
    return AffineSystem((r, speed, angle, rate), (u,), drift, [0, 0, 0, 1], (r,), (b,))


def cart_pole() -> AffineSystem:
    """Inverted pendulum (theta = 0 is upright) on a cart, output the cart's position."""
    s, theta, v, omega, force = sp.symbols("s theta v omega F", real=True)
    cart, bob, length, g = sp.symbols("M m l g", positive=True)
    total = cart + bob * sin(theta) ** 2
    acceleration = bob * sin(theta) * (length * omega**2 - g * cos(theta)) / total
    turning = ((cart + bob) * g * sin(theta) - bob * length * omega**2 * sin(theta) * cos(theta)) / (length * total)
    gains = [0, 0, 1 / total, -cos(theta) / (length * total)]
    return AffineSystem(
        (s, theta, v, omega), (force,), [v, omega, acceleration, turning], gains, (s,), (cart, bob, length, g)
    )


def pm_motor() -> AffineSystem:
    """Permanent-magnet synchronous motor in rotor coordinates, outputs i_d and the speed."""
    i_d, i_q, omega, u_d, u_q = sp.symbols("i_d i_q omega u_d u_q", real=True)
    resistance, l_d, l_q, magnet, inertia, pairs = sp.symbols("R L_d L_q psi J n_p", positive=True)
    torque = sp.Rational(3, 2) * pairs * (magnet * i_q + (l_d - l_q) * i_d * i_q)
    drift = [
        (-resistance * i_d + pairs * omega * l_q * i_q) / l_d,
        (-resistance * i_q - pairs * omega * (l_d * i_d + magnet)) / l_q,
        torque / inertia,
    ]
    gains = [[1 / l_d, 0], [0, 1 / l_q], [0, 0]]
    parameters = (resistance, l_d, l_q, magnet, inertia, pairs)
    return AffineSystem((i_d, i_q, omega), (u_d, u_q), drift, gains, (i_d, omega), parameters)


def induction_motor() -> AffineSystem:
    """Fifth-order induction motor, outputs speed and flux squared (Marino, Peresada, Valigi 1993, 10.1109/9.250510)."""
    omega, a, b, i_a, i_b, u_a, u_b = sp.symbols("omega psi_a psi_b i_a i_b u_a u_b", real=True)
    mu, alpha, mutual, beta, gamma, sigma, pairs = sp.symbols("mu alpha M beta gamma sigma n_p", positive=True)
    drift = [
        mu * (a * i_b - b * i_a),
        -alpha * a - pairs * omega * b + alpha * mutual * i_a,
        -alpha * b + pairs * omega * a + alpha * mutual * i_b,
        alpha * beta * a + pairs * beta * omega * b - gamma * i_a,
        alpha * beta * b - pairs * beta * omega * a - gamma * i_b,
    ]
    gains = [[0, 0], [0, 0], [0, 0], [1 / sigma, 0], [0, 1 / sigma]]
    parameters = (mu, alpha, mutual, beta, gamma, sigma, pairs)
    return AffineSystem((omega, a, b, i_a, i_b), (u_a, u_b), drift, gains, (omega, a**2 + b**2), parameters)


def mixed_inputs() -> AffineSystem:
    """Not from the literature: u1 + c u2 moves both outputs, so u1 is replaced before the first extension."""
    a, b, c, d, u1, u2 = sp.symbols("a b c d u1 u2", real=True)
    gains = [[1, c], [d, c * d], [0, 1], [0, 1]]
    return AffineSystem((a, b, c, d), (u1, u2), [0, 0, -c, 0], gains, (a, b))


def three_mixed_inputs() -> AffineSystem:
    """Not from the literature: three outputs move through two combinations of three inputs."""
    a, b, c, d, e, f, u1, u2, u3 = sp.symbols("a b c d e f u1 u2 u3", real=True)
    gains = [[1, 0, d], [0, 1, e], [f, 1, d * f + e], [0, 0, 0], [0, 0, 0], [0, 0, 1]]
    drift = [0, 0, 0, -d, -e, -f]
    return AffineSystem((a, b, c, d, e, f), (u1, u2, u3), drift, gains, (a, b, c))


GALLERY = {
    plant.__name__: plant
    for plant in (
        *(car, trailer, pvtol_centre, pvtol_flat, pvtol_flat_untouched, quadrotor, flexible_joint, ball_and_beam),
        *(
            cart_pole,
            pm_motor,
            induction_motor,
            mixed_inputs,
            three_mixed_inputs,
            nominal_robot,
            unicycle,
            manipulator,
            vtol,
        ),
    )
}


@cache
def linearized(name: str) -> Linearization:
    return linearize(GALLERY[name]())
