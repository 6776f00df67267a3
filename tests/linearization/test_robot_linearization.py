"""The flagship robot: everything comes out of the package and is compared with equations typed in here."""

import pickle

import pytest
import sympy as sp
from linearization_plants import D1, D2, ETA1, ETA2, RHO1, RHO2, THETA, U1, U2, V1, V2, W1, X, Y, nominal_robot, robot
from sympy import cos, sin

from brunovsky.errors import LinearizationError, ParameterError
from brunovsky.linearization import (
    Linearization,
    add_integrators,
    decoupling_matrix,
    lie_derivative,
    linearize,
    vector_relative_degree,
)

F = sp.Matrix(
    [
        ETA2**2 * ETA1 * sin(THETA) - 2 * ETA2 * U1 * cos(THETA),
        -(ETA2**2) * ETA1 * cos(THETA) - 2 * ETA2 * U1 * sin(THETA),
    ]
)
G = sp.Matrix([[-ETA1 * cos(THETA), -sin(THETA)], [-ETA1 * sin(THETA), cos(THETA)]])
HEADING = sp.Matrix([-sin(THETA), cos(THETA)])
HEADING_RATE = sp.Matrix([-cos(THETA), -sin(THETA)])


@pytest.fixture(scope="module")
def linearization() -> Linearization:
    return linearize(nominal_robot())


def zero(expressions: object) -> bool:
    return all(sp.simplify(entry) == 0 for entry in sp.Matrix([expressions]))


def test_before_the_extension_the_decoupling_matrix_is_singular() -> None:
    assert vector_relative_degree(nominal_robot()) == (2, 2)
    assert decoupling_matrix(nominal_robot()) == sp.Matrix([[-sin(THETA), 0], [cos(THETA), 0]])


def test_the_extension_is_one_integrator_on_the_first_input(linearization: Linearization) -> None:
    extension, extended = linearization.extension, linearization.extended_system
    assert dict(extension.integrators) == {U1: 1}
    assert (extension.states, extension.inputs) == ((U1,), (W1,))
    assert extended.states == (X, Y, THETA, ETA1, ETA2, U1)
    assert extended.inputs == (U2, W1)
    assert extended.dynamics == sp.Matrix([-ETA1 * sin(THETA), ETA1 * cos(THETA), ETA2, U1 + D1, U2 + D2, W1])
    (step,) = extension.steps
    assert (step.rank, step.outputs, step.delayed) == (1, (0, 1), (U1,))


def test_drift_term_decoupling_matrix_and_determinant(linearization: Linearization) -> None:
    assert linearization.relative_degree == (3, 3)
    assert zero(linearization.drift_term - F)
    assert zero(linearization.decoupling_matrix - G)
    assert linearization.determinant == -ETA1
    assert linearization.singular_locus == sp.Eq(ETA1, 0)
    assert linearization.is_full


def test_chains_are_those_of_equation_12(linearization: Linearization) -> None:
    expected = (
        (X, -ETA1 * sin(THETA), -ETA1 * ETA2 * cos(THETA) - U1 * sin(THETA)),
        (Y, ETA1 * cos(THETA), -ETA1 * ETA2 * sin(THETA) + U1 * cos(THETA)),
    )
    assert linearization.chains == expected


def test_law_is_short_and_only_the_yaw_input_has_a_denominator(linearization: Linearization) -> None:
    law = linearization.law
    assert tuple(law) == (U2, W1)
    assert sp.fraction(law[U2]) == (-(2 * ETA2 * U1 + V1 * cos(THETA) + V2 * sin(THETA)), ETA1)
    assert law[W1] == ETA1 * ETA2**2 - V1 * sin(THETA) + V2 * cos(THETA)


def test_under_the_law_the_third_derivatives_are_the_outer_inputs(linearization: Linearization) -> None:
    extended = linearization.extended_system
    closed = extended.dynamics.subs(linearization.law).subs({D1: 0, D2: 0})
    third = [lie_derivative(output, closed, extended.states, 3) for output in (X, Y)]
    assert linearization.outer_inputs == (V1, V2)
    assert zero(sp.Matrix(third) - sp.Matrix([V1, V2]))


def test_disturbances_and_ratios_enter_unmatched_and_matched(linearization: Linearization) -> None:
    plant = add_integrators(robot(), (U1,))
    v = F + G * sp.Matrix([U2, W1])
    acceleration, jerk = D1 + (RHO1 - 1) * U1, ETA1 * D2 + (RHO2 - 1) * ETA1 * U2
    for index, (position, velocity, modelled) in enumerate(linearization.chains):
        along = [lie_derivative(function, plant.dynamics, plant.states) for function in (position, velocity, modelled)]
        assert zero(along[0] - velocity)
        assert zero(along[1] - modelled - acceleration * HEADING[index])
        assert zero(along[2] - v[index] - (jerk + ETA2 * acceleration) * HEADING_RATE[index])


def test_the_law_of_the_uncertain_plant_inverts_the_ratios() -> None:
    law = linearize(robot()).law
    nominal = linearize(nominal_robot()).law
    assert {symbol: expression.subs({RHO1: 1, RHO2: 1}) for symbol, expression in law.items()} == dict(nominal)
    assert zero(law[U2].subs(RHO1, 1) * RHO2 - nominal[U2])


def test_errata_the_printed_matrix_is_not_the_derivative_of_equation_12() -> None:
    printed = sp.Matrix([[-ETA1 * cos(THETA), sin(THETA)], [-ETA1 * sin(THETA), cos(THETA)]])
    acceleration = sp.Matrix(  # (12), along (9) and (13)
        [-ETA1 * ETA2 * cos(THETA) - U1 * sin(THETA), -ETA1 * ETA2 * sin(THETA) + U1 * cos(THETA)]
    )
    rates = {THETA: ETA2, ETA1: U1, ETA2: U2, U1: W1}
    jerk = sum((acceleration.diff(symbol) * rate for symbol, rate in rates.items()), sp.zeros(2, 1))
    derived = jerk.jacobian([U2, W1])
    assert zero(derived - G)
    assert zero(derived - linearize(nominal_robot()).decoupling_matrix)
    assert zero((derived - printed) - sp.Matrix([[0, -2 * sin(THETA)], [0, 0]]))
    assert sp.simplify(derived.det()) == -ETA1
    assert zero(printed.det() + ETA1 * cos(2 * THETA))
    assert not zero(printed.det() + ETA1**2)
    assert printed.det().subs(THETA, -3 * sp.pi / 4) == 0


def test_operating_point_is_refused_only_where_the_law_does_not_exist() -> None:
    regular = linearize(nominal_robot(), operating_point={"eta1": 0.5, THETA: 0})
    assert regular.determinant == -ETA1
    with pytest.raises(LinearizationError, match=r"operating point \(eta1 = 0\).*determinant -eta1.*eta1 = 0"):
        linearize(nominal_robot(), operating_point={ETA1: 0})
    with pytest.raises(ParameterError, match=r"speed is not a state or parameter.*known: x, y, theta, eta1, eta2, u1"):
        linearize(nominal_robot(), operating_point={"speed": 1})


def test_derivation_as_text_stands_step_by_step(linearization: Linearization) -> None:
    lines = [
        "  h1 = x",
        "  L_g(u1) L_f h1 = -sin(theta)",
        "Relative degree: 2, 2.",
        "G has generic rank 1, not 2: outputs 1, 2 depend on each other through u1 alone",
        "  du1/dt = w1",
        "  L_g(u2) L_f^2 h2 = -eta1*sin(theta)",
        "Relative degree: 3, 3.",
        "  G = [-eta1*cos(theta)  -sin(theta)]\n      [-eta1*sin(theta)   cos(theta)]",
        "  det G = -eta1",
        "  w1 = eta1*eta2**2 - v1*sin(theta) + v2*cos(theta)",
        "It does not exist where eta1 = 0.",
    ]
    text = linearization.explain()
    positions = [text.find(line) for line in lines]
    assert -1 not in positions, lines[positions.index(-1)]
    assert positions == sorted(positions)
    assert text.isascii()


@pytest.mark.parametrize("render", ["latex", "_repr_markdown_"])
def test_derivation_as_mathematics_holds_every_result(linearization: Linearization, render: str) -> None:
    text = getattr(linearization, render)()
    step = linearization.extension.steps[0].derivatives
    results = [
        *(f"L_{{f}}^{{3}} h_{{{i + 1}}} = {sp.latex(linearization.drift_term[i])}" for i in range(2)),
        f"G = {sp.latex(step.decoupling_matrix)}",
        f"F = {sp.latex(linearization.drift_term)}",
        f"G = {sp.latex(linearization.decoupling_matrix)}",
        r"\det G = - \eta_{1}",
        r"\dot{u_{1}} = w_{1}",
        *(f"{sp.latex(symbol)} = {sp.latex(law)}" for symbol, law in linearization.law.items()),
    ]
    assert [result for result in results if result not in text] == []
    assert text.count("{") == text.count("}")
    assert text.replace("$$", "").count("$") % 2 == 0
    assert (text.count("$$") > 0) == (render == "_repr_markdown_")


def test_linearizations_hash_and_pickle(linearization: Linearization) -> None:
    copy = pickle.loads(pickle.dumps(linearization))
    assert copy == linearization
    assert hash(copy) == hash(linearization)
    assert copy != linearize(robot())
