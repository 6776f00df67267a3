"""Robot arms: two stiff links, and one link behind a spring."""

import sympy as sp
from sympy import cos, sin

from brunovsky.linearization.affine import AffineSystem


def manipulator() -> AffineSystem:
    """Two-link arm in joint coordinates, with the usual three inertia parameters.

    M(q) q'' + c(q, q') = tau without gravity. Outputs are the joint angles; relative degree (2, 2) without an
    integrator, full, nowhere singular; the law is computed torque.

    References
    ----------
    M. W. Spong, S. Hutchinson, M. Vidyasagar, *Robot Modeling and Control*, Wiley, 2006.
    """
    q1, q2, p1, p2, t1, t2 = sp.symbols("q1 q2 p1 p2 tau1 tau2", real=True)
    a1, a2, a3 = sp.symbols("a1 a2 a3", positive=True)
    inertia = sp.Matrix([[a1 + 2 * a2 * cos(q2), a3 + a2 * cos(q2)], [a3 + a2 * cos(q2), a3]])
    coriolis = a2 * sin(q2) * sp.Matrix([-(2 * p1 * p2 + p2**2), p1**2])
    inverse = inertia.inv()
    return AffineSystem(
        (q1, q2, p1, p2),
        (t1, t2),
        sp.Matrix([p1, p2]).col_join(-inverse * coriolis),
        sp.zeros(2, 2).col_join(inverse),
        (q1, q2),
        (a1, a2, a3),
    )


def flexible_joint() -> AffineSystem:
    """One link behind a spring, driven at the rotor.

    Output is the link's angle; relative degree 4 without an integrator, full, nowhere singular.

    References
    ----------
    M. W. Spong, "Modeling and control of elastic joint robots", J. Dyn. Sys., Meas., Control 109(4), 310-319, 1987,
    doi:10.1115/1.3143860.
    """
    q1, q2, p1, p2, torque = sp.symbols("q1 q2 p1 p2 tau", real=True)
    link, rotor, weight, stiffness = sp.symbols("I J w k", positive=True)
    spring = stiffness * (q1 - q2)
    drift = [p1, p2, -(weight * sin(q1) + spring) / link, spring / rotor]
    return AffineSystem(
        (q1, q2, p1, p2), (torque,), drift, [0, 0, 0, 1 / rotor], (q1,), (link, rotor, weight, stiffness)
    )
