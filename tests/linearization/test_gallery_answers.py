"""What the literature says of the gallery's plants in formulas, typed in from there or derived by hand.

Laws and determinants stand as published; zeros are those of the linearised plant, from its matrices alone; whether
static feedback is enough is decided once more from Lie brackets in floating point.
"""

import itertools

import control
import numpy as np
import pytest
import sympy as sp
from gallery_plants import linearized

from brunovsky.linearization import Linearization, gallery, static_linearizability

LAWS = {
    # Spong, Hutchinson and Vidyasagar, chapter on geometric nonlinear control: u = I J / k (v - a(x))
    "flexible_joint": {
        "tau": "I*J/k*(v1 - w/I*sin(q1)*(p1**2 + w/I*cos(q1) + k/I) - k/I*(q1 - q2)*(k/I + k/J + w/I*cos(q1)))"
    },
    # computed torque, M(q) v + C(q, q') q' with the Christoffel symbols of M
    "manipulator": {
        "tau1": "(a1 + 2*a2*cos(q2))*v1 + (a3 + a2*cos(q2))*v2 - a2*sin(q2)*(2*p1*p2 + p2**2)",
        "tau2": "(a3 + a2*cos(q2))*v1 + a3*v2 + a2*sin(q2)*p1**2",
    },
    # Hauser, Sastry and Meyer 1992
    "pvtol_centre": {
        "u1": "-sin(theta)*v1 + cos(theta)*(v2 + 1)",
        "u2": "(cos(theta)*v1 + sin(theta)*(v2 + 1))/epsilon",
    },
    # Hauser, Sastry and Kokotovic 1992: y''' = B x1 x4^2-terms + 2 B x1 x4 u
    "ball_and_beam": {"u": "(v1 - b*(v*omega**2 - 981/100*omega*cos(alpha)))/(2*b*r*omega)"},
    # collocated partial linearisation, Spong 1994
    "cart_pole": {"F": "(M + m*sin(theta)**2)*v1 + m*sin(theta)*(g*cos(theta) - l*omega**2)"},
    # decoupling of the d axis; on the q axis J omega'' = 3/2 n_p ((psi + (L_d - L_q) i_d) i_q)'
    "pm_motor": {
        "u_d": "R*i_d - n_p*omega*L_q*i_q + L_d*v1",
        "u_q": "R*i_q + n_p*omega*(L_d*i_d + psi) + L_q*(2*J*v2/(3*n_p) - (L_d - L_q)*v1*i_q)/(psi + (L_d - L_q)*i_d)",
    },
    "unicycle": {"omega": "(v2*cos(theta) - v1*sin(theta))/v", "w": "v1*cos(theta) + v2*sin(theta)"},
    # the thrust axis turns: (T e)'' = m (v1, v2) with e = (-sin(phi), cos(phi))
    "vtol": {
        "tau": "-J*(m*(v1*cos(phi) + v2*sin(phi)) + 2*w*q)/T",
        "w_2": "m*(v2*cos(phi) - v1*sin(phi)) + T*q**2",
    },
    "pvtol_flat": {
        "u2": "-(v1*cos(theta) + v2*sin(theta) + 2*w1*q)/u1",
        "w1_2": "v2*cos(theta) - v1*sin(theta) + u1*q**2",
    },
}

DETERMINANTS = {
    # Marino, Peresada and Valigi 1993: singular only without flux
    "induction_motor": "-2*mu*alpha*M*(psi_a**2 + psi_b**2)/sigma**2",
    "pm_motor": "3*n_p*(psi + (L_d - L_q)*i_d)/(2*J*L_d*L_q)",
    "flexible_joint": "k/(I*J)",
    "ball_and_beam": "2*b*r*omega",
    "cart_pole": "1/(M + m*sin(theta)**2)",
    "manipulator": "1/(a3*(a1 + 2*a2*cos(q2)) - (a3 + a2*cos(q2))**2)",
    "unicycle": "-v",
    "car": "-v**2/(L*cos(phi)**2)",
    "trailer": "-v**2/L",
    "vtol": "-T/(J*m**2)",
    "pvtol_centre": "-epsilon",
    "pvtol_flat": "-u1",
    "pvtol_flat_untouched": "epsilon*q**2 - u1",
    "quadrotor": "-T**2*cos(phi)/(m**3*J_x*J_y*J_z*cos(theta))",
}

# An angle that the outputs show, as (p, q) with p cos(angle) = q sin(angle): what makes these plants flat.
# y11 is the first derivative of output 1; curvatures are those of the paths of the axles.
ANGLES = {
    "unicycle": ("theta", "y21", "y11"),
    "car": ("phi", "L*(y11*y22 - y21*y12)", "v*(y11**2 + y21**2)"),
    "trailer": ("theta - phi", "L*(y11*y22 - y21*y12)*cos(theta - phi)", "v*cos(theta - phi)**2*(y11**2 + y21**2)"),
    "vtol": ("phi", "-y12", "y22 + 981/100"),
    "pvtol_flat": ("theta", "-y12", "y22 + 1"),
    "pvtol_flat_untouched": ("theta", "-y12", "y22 + 1"),
}

# Equilibria with the eigenvalues of the zero dynamics there.
PVTOL = dict.fromkeys(["x", "y", "theta", "vx", "vy", "q"], 0.0) | {"epsilon": 0.16}
CART = dict.fromkeys(["s", "theta", "v", "omega"], 0.0) | {"M": 2.0, "m": 1.0, "l": 0.4, "g": 10.0}
MOTOR = {"omega": 0.0, "psi_a": 0.6, "psi_b": 0.8, "i_a": 0.3, "i_b": 0.4, "M": 2.0} | dict.fromkeys(
    ["mu", "alpha", "beta", "gamma", "sigma", "n_p"], 1.5
)
ZEROS = [
    ("pvtol_centre", PVTOL, {"u1": 1.0, "u2": 0.0}, [2.5, -2.5]),  # epsilon theta'' = sin(theta): 1/sqrt(epsilon)
    ("cart_pole", CART, {"F": 0.0}, [5, -5]),  # l theta'' = g sin(theta): sqrt(g/l)
    ("cart_pole", CART | {"theta": np.pi}, {"F": 0.0}, [-5j, 5j]),
    ("induction_motor", MOTOR, {"u_a": -1.35, "u_b": -1.8}, [0]),  # the angle of the flux turns with n_p omega
]

# Static feedback is enough for these alone: the outputs have a full relative degree without an integrator (elastic
# joint: Spong 1987). Without drift there is but G_0, so that as many inputs as states would be needed (unicycle, car,
# trailer). V/STOL and quadrotor: to turn the thrust pushes sideways, as no input and no ad_f g does. Ball and beam:
# Hauser, Sastry and Kokotovic 1992, induction motor: Marino, Peresada and Valigi 1993, by a bracket that leaves G_1.
STATIC = {"flexible_joint", "manipulator", "pm_motor"}


def parsed(text: str, result: Linearization) -> sp.Expr:
    extended = result.extended_system
    known = {s.name: s for s in (*extended.parameters, *result.system.inputs, *result.outer_inputs, *extended.states)}
    known |= {f"y{i}{k}": part for i, chain in enumerate(result.chains, 1) for k, part in enumerate(chain) if k}
    return sp.sympify(text, locals=known)


@pytest.mark.parametrize("name", LAWS)
def test_laws(name: str) -> None:
    result = linearized(name)
    assert {symbol.name for symbol in result.law} == set(LAWS[name])
    for symbol, law in result.law.items():
        assert sp.simplify(law - parsed(LAWS[name][symbol.name], result)) == 0


@pytest.mark.parametrize("name", gallery.__all__)
def test_determinants(name: str) -> None:
    result = linearized(name)
    assert sp.simplify(result.determinant - parsed(DETERMINANTS[name], result)) == 0


@pytest.mark.parametrize("name", ANGLES)
def test_flat_outputs_show_the_angle(name: str) -> None:
    angle, sine, cosine = (parsed(text, linearized(name)) for text in ANGLES[name])
    assert sp.simplify((sine * sp.cos(angle) - cosine * sp.sin(angle)).rewrite(sp.cos).expand(trig=True)) == 0
    assert linearized(name).is_full


def test_third_derivative_of_ball_and_beam() -> None:
    result = linearized("ball_and_beam")
    assert sp.expand(result.drift_term[0] - parsed("b*(v*omega**2 - 981/100*omega*cos(alpha))", result)) == 0


def test_the_quadrotor_s_torques_tilt_its_thrust() -> None:
    """In the fourth derivatives the body axes R e_1, R e_2, R e_3 stand behind tau2, tau1 and T''."""
    result = linearized("quadrotor")
    thrust, m, j_x, j_y, j_z = (parsed(name, result) for name in ("T", "m", "J_x", "J_y", "J_z"))
    phi, theta, psi = (parsed(name, result) for name in ("phi", "theta", "psi"))
    # R of yaw, pitch and roll; SymPy's rotations are those of the coordinates, so that they are transposed
    rotation = sp.rot_axis3(psi).T * sp.rot_axis2(theta).T * sp.rot_axis1(phi).T
    e_1, e_2, e_3 = (rotation.col(k) for k in range(3))
    wanted = sp.Matrix.hstack(-thrust / (m * j_x) * e_2, thrust / (m * j_y) * e_1, sp.zeros(3, 1), e_3 / m)
    yaw = sp.Matrix([[0, sp.sin(phi) / (j_y * sp.cos(theta)), sp.cos(phi) / (j_z * sp.cos(theta)), 0]])
    assert sp.simplify(result.decoupling_matrix - wanted.col_join(yaw)) == sp.zeros(4, 4)


@pytest.mark.parametrize(("name", "point", "inputs", "expected"), ZEROS)
def test_zeros(name: str, point: dict[str, float], inputs: dict[str, float], expected: list[complex]) -> None:
    result = linearized(name)
    system = result.system
    values = {s: point[s.name] for s in (*system.states, *system.parameters)}
    values |= {s: inputs[s.name] for s in system.inputs}
    matrices = (
        system.dynamics.jacobian(system.states),
        system.input_matrix,
        sp.Matrix(system.outputs).jacobian(system.states),
    )
    plant = control.ss(*(np.array(matrix.subs(values), dtype=float) for matrix in matrices), 0)
    assert np.max(np.abs(np.array(system.dynamics.subs(values), dtype=float))) < 1e-12
    for found in (result.zero_dynamics.eigenvalues(point), plant.zeros()):
        np.testing.assert_allclose(sorted(found, key=lambda s: (-s.real, s.imag)), expected, atol=1e-6)
    assert not result.is_minimum_phase(point)


def _spans(columns: list[np.ndarray], vector: np.ndarray) -> bool:
    return bool(np.linalg.matrix_rank(np.column_stack([*columns, vector]), tol=1e-8) == len(columns))


@pytest.mark.parametrize("name", gallery.__all__)
def test_whether_static_feedback_is_enough(name: str) -> None:
    system = getattr(gallery, name)()
    x = sp.Matrix(system.states)
    fields = [system.input_matrix.col(j) for j in range(len(system.inputs))]
    newest = list(fields)
    generator = np.random.default_rng(3)
    symbols = (*system.states, *system.parameters)
    point = dict(zip(symbols, generator.uniform(0.5, 1.2, len(symbols)), strict=True))

    def bracket(one: sp.Matrix, other: sp.Matrix) -> sp.Matrix:
        return other.jacobian(x) * one - one.jacobian(x) * other

    def at(field: sp.Matrix) -> np.ndarray:
        return np.array(field.evalf(30, subs=point), dtype=float)[:, 0]

    answer = None
    while answer is None:
        basis: list[sp.Matrix] = []
        for field in fields:
            if not _spans([at(one) for one in basis], at(field)):
                basis.append(field)
        columns = [at(one) for one in basis]
        if len(basis) == len(x):
            answer = True
        elif not all(_spans(columns, at(bracket(*pair))) for pair in itertools.combinations(basis, 2)):
            answer = False
        else:
            newest = [bracket(system.drift, field) for field in newest]
            fields = [*basis, *newest]
            assert not all(_spans(columns, at(field)) for field in newest)
    assert answer == static_linearizability(system).answer == (name in STATIC)
