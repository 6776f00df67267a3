"""Known answers for textbook plants, the failures with their reasons, and y^(r) = v as a property of all of them."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
import sympy as sp
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from linearization_plants import (
    chain,
    nominal_robot,
    pendulum,
    robot,
    three_inputs,
)

from brunovsky.errors import LinearizationError, ModelError, ParameterError
from brunovsky.linearization import AffineSystem, Linearization, add_integrators, linearize, vector_relative_degree
from brunovsky.linearization.gallery import manipulator, unicycle, vtol

A, B, C, U1, U2 = sp.symbols("a b c u1 u2", real=True)


def integrators(linearization: Linearization) -> dict[str, int]:
    return {symbol.name: count for symbol, count in linearization.extension.integrators.items()}


def names(symbols: tuple[sp.Symbol, ...]) -> list[str]:
    return [symbol.name for symbol in symbols]


def test_pendulum_is_linearised_statically() -> None:
    system = pendulum()
    result = linearize(system)
    g, length = system.parameters
    assert result.relative_degree == (2,)
    assert result.extended_system == system
    assert integrators(result) == {}
    assert result.singular_locus == sp.false
    assert result.is_full
    (law,) = result.law.values()
    assert sp.simplify(law - (result.outer_inputs[0] + g / length * sp.sin(system.states[0]))) == 0
    assert "It exists wherever F and G do." in result.explain()


def test_manipulator_law_is_computed_torque() -> None:
    system = manipulator()
    result = linearize(system)
    (_, q2, p1, p2), (a1, a2, a3), v = system.states, system.parameters, sp.Matrix(result.outer_inputs)
    inertia = sp.Matrix([[a1 + 2 * a2 * sp.cos(q2), a3 + a2 * sp.cos(q2)], [a3 + a2 * sp.cos(q2), a3]])
    coriolis = a2 * sp.sin(q2) * sp.Matrix([-(2 * p1 * p2 + p2**2), p1**2])
    assert result.relative_degree == (2, 2)
    assert result.is_full
    assert sp.expand(sp.Matrix(list(result.law.values())) - inertia * v - coriolis) == sp.zeros(2, 1)


@pytest.mark.parametrize("length", [2, 3, 5])
def test_chain_has_the_relative_degree_of_its_length(length: int) -> None:
    system = chain(length)
    result = linearize(system)
    assert result.relative_degree == (length,)
    assert result.chains == (system.states,)
    assert list(result.law.values()) == [(result.outer_inputs[0] - system.states[0] ** 2) * sp.exp(-system.states[1])]


def test_unicycle_needs_one_integrator_on_its_speed() -> None:
    system = unicycle()
    result = linearize(system)
    heading, speed = system.states[2], system.inputs[0]
    v1, v2 = result.outer_inputs
    assert result.relative_degree == (2, 2)
    assert integrators(result) == {"v": 1}
    assert names(result.extended_system.inputs) == ["omega", "w"]
    assert result.determinant == -speed
    assert result.is_full
    turn, w = result.law.values()
    assert sp.simplify(turn - (v2 * sp.cos(heading) - v1 * sp.sin(heading)) / speed) == 0
    assert sp.simplify(w - (v1 * sp.cos(heading) + v2 * sp.sin(heading))) == 0


def test_vtol_needs_two_integrators_one_after_the_other() -> None:
    result = linearize(vtol())
    assert result.relative_degree == (4, 4)
    assert integrators(result) == {"T": 2}
    assert [names(step.delayed) + names(step.inputs) for step in result.extension.steps] == [["T", "w"], ["w", "w_2"]]
    assert names(result.extension.states) == ["T", "w"]
    assert names(result.extension.inputs) == ["w_2"]
    assert result.is_full
    mass, inertia = vtol().parameters
    assert sp.simplify(result.determinant + result.extension.states[0] / (inertia * mass**2)) == 0
    with pytest.raises(
        LinearizationError, match=r"after 1 extension.*integrators on T\).*still singular \(rank 1 of 2"
    ):
        linearize(vtol(), max_extensions=1)


def test_only_the_inputs_of_dependent_outputs_are_delayed() -> None:
    result = linearize(three_inputs())
    assert result.relative_degree == (1, 2, 2)
    assert integrators(result) == {"u2": 1}
    assert names(result.extended_system.inputs) == ["u1", "u3", "w2"]
    assert result.extension.steps[0].outputs == (1, 2)


def test_internal_dynamics_make_a_linearisation_partial() -> None:
    system = AffineSystem((A, B), (U1,), [0, -B + A**2], [1, 0], (A,))
    result = linearize(system)
    assert not result.is_full
    assert "there are internal dynamics" in result.explain()


def test_factors_that_cannot_vanish_are_not_in_the_singular_locus() -> None:
    mass = sp.Symbol("m", positive=True)
    system = AffineSystem((A,), (U1,), [0], [mass * A], (A,), (mass,))
    assert linearize(system).determinant == mass * A
    assert linearize(system).singular_locus == sp.Eq(A, 0)


def test_a_gain_that_vanishes_in_disguise_does_not_count() -> None:
    disguise = 2 * sp.sin(C / 2) * sp.cos(C / 2) - sp.sin(C)
    system = AffineSystem((A, B, C), (U1,), [B, 0, 0], [0, 1, 1], (A + disguise,))
    assert vector_relative_degree(system) == (2,)


def test_added_names_avoid_those_that_are_taken() -> None:
    v1, w1 = sp.symbols("v1 w1")
    u1 = sp.Symbol("u1", positive=True)
    system = AffineSystem((A, v1), (u1, U2), [v1, w1], [[1, 0], [0, 1]], (A, v1), (w1,))
    extended = add_integrators(system, (u1,))
    assert names(extended.inputs) == ["u2", "w1_2"]
    assert extended.inputs[1].is_real and extended.inputs[1].is_positive is None
    result = linearize(system)
    assert names(result.outer_inputs) == ["nu1", "nu2"]
    assert all(symbol.is_real for symbol in result.outer_inputs)
    underscored = AffineSystem((A,), sp.symbols("u_1,"), [0], [1], (A,))
    assert names(add_integrators(underscored, underscored.inputs).inputs) == ["w_1"]
    assert add_integrators(underscored, underscored.inputs).inputs[0].is_real is None


def test_only_inputs_get_integrators() -> None:
    with pytest.raises(ModelError, match=r"a is not an input; .* u1, u2"):
        add_integrators(nominal_robot(), (A,))


UNREACHABLE = AffineSystem((A, B), (U1,), [0, -B], [1, 0], (B,))
SUM = AffineSystem((A, B), (U1, U2), [0, 0], [[1, A], [2, 2 * A]], (A, B))
TWICE = AffineSystem((A, B), (U1, U2), [0, 0], sp.eye(2), (A, A))
D = sp.Symbol("d", real=True)
# y2' = y1' + c with c' = y1 + y1': related, which shows only when the outputs have been differentiated more often
LATER = AffineSystem((A, B, C, D), (U1, U2), [0, C, A, 0], [[1, 0], [1, 0], [1, 0], [0, 1]], (A, B))


@pytest.mark.parametrize(
    ("system", "message"),
    [
        (
            UNREACHABLE,
            r"before any.*output 1 \(b\) has no finite relative degree: no input \(u1\).*first 2 derivatives",
        ),
        (SUM, r"before any.*not right-invertible.*the outputs 1, 2 satisfy a differential equation"),
        (TWICE, r"before any.*not right-invertible.*the outputs 1, 2 satisfy a differential equation"),
        (LATER, r"after 2 extension\(s\) \(integrators on u1; w1\): the system is not right-invertible"),
    ],
)
def test_failures_say_why_and_at_which_step(system: AffineSystem, message: str) -> None:
    with pytest.raises(LinearizationError, match=message):
        linearize(system)


def test_an_unreachable_output_has_no_relative_degree_by_itself() -> None:
    with pytest.raises(LinearizationError, match=r"output 1 \(b\)"):
        vector_relative_degree(UNREACHABLE)


def test_arguments_are_checked() -> None:
    with pytest.raises(ModelError, match="'robot' is not an AffineSystem"):
        linearize("robot")  # type: ignore[arg-type]
    with pytest.raises(ModelError, match="max_extensions is -1"):
        linearize(pendulum(), max_extensions=-1)
    with pytest.raises(ParameterError, match="theta: nan is not a finite"):
        linearize(nominal_robot(), operating_point={"theta": float("nan")})


def test_operating_points_in_floating_point_meet_the_locus() -> None:
    cosine = AffineSystem((A,), (U1,), [0], [sp.cos(A)], (A,))
    assert linearize(cosine, operating_point={A: 1.5}).singular_locus == sp.Eq(sp.cos(A), 0)
    with pytest.raises(LinearizationError, match=r"at the operating point.*determinant cos\(a\) vanishes"):
        linearize(cosine, operating_point={A: np.pi / 2})
    pole = AffineSystem((A,), (U1,), [1 / A], [1], (A,))
    with pytest.raises(LinearizationError, match=r"at the operating point \(a = 0\): 1/a is not finite"):
        linearize(pole, operating_point={A: 0})


PLANTS: list[Callable[[], AffineSystem]] = [
    nominal_robot,
    robot,
    pendulum,
    manipulator,
    unicycle,
    vtol,
    three_inputs,
    lambda: chain(4),
]


@cache
def closed_loop(index: int) -> tuple[Callable[..., float], Callable[..., list[float]], int, int]:
    """The determinant and y^(r) under the law, straight from the outputs and the right-hand side, unsimplified."""
    result = linearize(PLANTS[index]())
    extended = result.extended_system
    dynamics = extended.dynamics.subs(result.law).subs(dict.fromkeys(extended.disturbances, 0))
    derivatives = []
    for output, degree in zip(extended.outputs, result.relative_degree, strict=True):
        for _ in range(degree):
            output = (sp.Matrix([output]).jacobian(sp.Matrix(extended.states)) * dynamics)[0]
        derivatives.append(output)
    symbols = (*extended.states, *extended.parameters)
    determinant = sp.lambdify(symbols, result.decoupling_matrix.det(), cse=True)
    return (
        determinant,
        sp.lambdify((*symbols, *result.outer_inputs), derivatives, cse=True),
        len(symbols),
        len(derivatives),
    )


@pytest.mark.parametrize("index", range(len(PLANTS)))
@settings(max_examples=40)
@given(data=st.data())
def test_at_regular_points_the_law_makes_the_highest_derivatives_v(index: int, data: st.DataObject) -> None:
    determinant, derivatives, count, outputs = closed_loop(index)
    point = data.draw(st.lists(st.floats(0.1, 3.0), min_size=count, max_size=count))
    v = data.draw(st.lists(st.floats(-5.0, 5.0), min_size=outputs, max_size=outputs))
    assume(1e-2 < abs(determinant(*point)) < 1e2)
    np.testing.assert_allclose(derivatives(*point, *v), v, rtol=1e-9, atol=1e-9)
