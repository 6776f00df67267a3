"""Electrical machines."""

import sympy as sp

from brunovsky.linearization.affine import AffineSystem


def pm_motor() -> AffineSystem:
    """Permanent-magnet synchronous motor in rotor coordinates.

    Outputs are i_d and the speed; relative degree (1, 2) without an integrator, full, singular at
    psi + (L_d - L_q) i_d = 0.

    References
    ----------
    P. Pillay, R. Krishnan, "Modeling, simulation, and analysis of permanent-magnet motor drives, part I", IEEE Trans.
    Ind. Appl. 25(2), 265-273, 1989, doi:10.1109/28.25541.
    """
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
    """Fifth-order induction motor in stator coordinates.

    Outputs are the speed and the flux squared; relative degree (2, 2) without an integrator, singular without flux,
    not full: the angle of the flux is left.

    References
    ----------
    R. Marino, S. Peresada, P. Valigi, "Adaptive input-output linearizing control of induction motors", IEEE Trans.
    Autom. Control 38(2), 208-221, 1993.
    """
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
