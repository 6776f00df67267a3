"""The gallery: answers of the literature, and the law as an identity at random regular points of every plant."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
import sympy as sp
from gallery_plants import GALLERY, linearized
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from linearization_plants import ETA1, U1, nominal_robot

from brunovsky.errors import LinearizationError
from brunovsky.linearization import AffineSystem, gallery, linearize
from brunovsky.linearization.gallery import ball_and_beam, trailer, vtol

ANSWERS = {
    # relative degree, integrators, full, factors of the singular locus
    "nominal_robot": ((3, 3), {"u1": 1}, True, "eta1"),
    "unicycle": ((2, 2), {"v": 1}, True, "v"),
    "car": ((3, 3), {"v": 2}, True, "v"),
    "trailer": ((3, 3), {"v": 1, "mu1": 1}, True, "v*cos(phi - theta)"),
    "vtol": ((4, 4), {"T": 2}, True, "T"),
    "pvtol_flat": ((4, 4), {"u1": 2}, True, "u1"),
    "pvtol_flat_untouched": ((4, 4), {"u1": 1, "mu1": 1}, True, "epsilon*q**2 - u1"),
    "pvtol_centre": ((2, 2), {}, False, None),
    "manipulator": ((2, 2), {}, True, None),
    "quadrotor": ((4, 4, 4, 2), {"T": 2}, True, "T*cos(phi)"),
    "flexible_joint": ((4,), {}, True, None),
    "ball_and_beam": ((3,), {}, False, "omega*r"),
    "cart_pole": ((2,), {}, False, None),
    "pm_motor": ((1, 2), {}, True, "L_d*i_d - L_q*i_d + psi"),
    "induction_motor": ((2, 2), {}, False, "psi_a**2 + psi_b**2"),
    "three_mixed_inputs": ((2, 2, 2), {"mu1": 1, "mu2": 1}, False, "mu1"),
    "mixed_inputs": ((2, 2), {"mu1": 1}, False, "mu1"),
}


def test_every_plant_has_an_answer_and_a_source() -> None:
    assert set(GALLERY) == set(ANSWERS)
    for name in gallery.__all__:
        assert "References\n" in getattr(gallery, name).__doc__


@pytest.mark.parametrize("name", ANSWERS)
def test_answers(name: str) -> None:
    degree, integrators, full, locus = ANSWERS[name]
    result = linearized(name)
    assert result.relative_degree == degree
    assert {symbol.name: count for symbol, count in result.extension.integrators.items()} == integrators
    assert result.is_full == full == (result.zero_dynamics is None)
    found = result.singular_locus
    assert (found == sp.false) if locus is None else str(found.lhs) == locus


def test_quadrotor_is_full_with_fourteen_states() -> None:
    result = linearized("quadrotor")
    assert len(result.extended_system.states) == 14
    assert [step.rank for step in result.extension.steps] == [2, 2]


def test_the_trailer_needs_a_transformation_of_its_inputs() -> None:
    result = linearized("trailer")
    (transformation,) = result.extension.transformations
    v, omega, w, theta, phi = (sp.Symbol(name, real=True) for name in ("v", "omega", "w", "theta", "phi"))
    (combination,) = transformation.combinations.values()
    assert sp.simplify(combination - (w * sp.cos(phi - theta) + v * omega * sp.sin(phi - theta))) == 0
    assert list(transformation.replaced) == [w]
    assert [len(step.delayed) for step in result.extension.steps] == [1, 1]
    assert dict(result.input_map) == {v: v, omega: omega}
    assert "Transformation of the inputs" in result.explain()
    straight = linearize(trailer(), operating_point={"theta": 0.1, "phi": 0.1, "v": 1})
    assert straight.determinant == result.determinant
    with pytest.raises(LinearizationError, match=r"is singular there, its determinant v\*cos\(phi - theta\)"):
        linearize(trailer(), operating_point={"theta": np.pi / 2, "phi": 0, "v": 1})


def test_an_input_that_was_replaced_is_recovered() -> None:
    result = linearized("mixed_inputs")
    u1, u2, c, mu1 = (sp.Symbol(name, real=True) for name in ("u1", "u2", "c", "mu1"))
    assert dict(result.input_map) == {u1: mu1 - c * u2, u2: u2}
    assert "  u1 = -c*u2 + mu1" in result.explain()
    assert r"\mu_{1} = c u_{2} + u_{1}" in result.latex()


def test_a_pivot_that_vanishes_at_the_operating_point_is_avoided() -> None:
    a, b, c, d, u1, u2 = sp.symbols("a b c d u1 u2", real=True)
    gains = [[c, 1 + c**2], [c * d, (1 + c**2) * d], [0, 0], [1, 2]]
    system = AffineSystem((a, b, c, d), (u1, u2), [0, 0, -c, 0], gains, (a, b))
    assert list(linearize(system).extension.transformations[0].replaced) == [u1]
    there = linearize(system, operating_point={"c": 0, "d": 1})
    assert list(there.extension.transformations[0].replaced) == [u2]


def test_the_number_of_rounds_is_limited_and_said_to_be_enough() -> None:
    with pytest.raises(LinearizationError, match=r"after 1 extension.*rank 1 of 2.*at most 1 more"):
        linearize(vtol(), max_extensions=1)


def test_ball_and_beam_has_no_relative_degree_at_rest() -> None:
    place = {"r": 0, "v": 0, "alpha": 0, "omega": 0}
    with pytest.raises(
        LinearizationError, match=r"rank is 0 instead of 1.*\(3,\) is not well defined.*off omega\*r = 0"
    ):
        linearize(ball_and_beam(), operating_point=place)
    assert linearize(ball_and_beam(), operating_point={"r": 1, "omega": 1}).relative_degree == (3,)


@cache
def identities(
    name: str,
) -> tuple[Callable[..., list[float]], Callable[..., list[float]], Callable[..., float], int, int]:
    """Both sides of z_k' = z_(k+1), z_r' = v and of the plant's x' under the law, and how regular a point is."""
    result = linearized(name)
    extended, system = result.extended_system, result.system
    undisturbed = dict.fromkeys(extended.disturbances, 0)
    dynamics = extended.dynamics.subs(undisturbed)
    states, v = sp.Matrix(extended.states), result.outer_inputs
    derivatives = [(sp.Matrix([part]).jacobian(states) * dynamics)[0] for chain in result.chains for part in chain]
    wanted = [part for chain, outer in zip(result.chains, v, strict=True) for part in (*chain[1:], outer)]
    plant = system.dynamics.subs(undisturbed).subs(dict(result.input_map))
    symbols = (*extended.states, *extended.parameters, *v)
    law = list(result.law.values())
    left = sp.lambdify((*symbols, *extended.inputs), [*derivatives, *plant], cse=True)
    right = sp.lambdify((*symbols, *extended.inputs), [*wanted, *dynamics[: len(system.states), :]], cse=True)
    inputs = sp.lambdify(symbols, law, cse=True)
    regular = sp.lambdify(symbols, [sp.Abs(d) for d in (result.determinant, *_determinants(result))], cse=True)
    outputs = [chain[0] - output for chain, output in zip(result.chains, system.outputs, strict=True)]
    assert all(sp.simplify(difference) == 0 for difference in outputs)
    return (
        lambda *values: left(*values, *inputs(*values)),
        lambda *values: right(*values, *inputs(*values)),
        lambda *values: min(regular(*values)),
        len(symbols) - len(v),
        len(v),
    )


def _determinants(result: object) -> list[sp.Expr]:
    return [one.determinant for one in result.extension.transformations]  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", GALLERY)
@settings(max_examples=30)
@given(data=st.data())
def test_the_law_makes_the_chains_linear_at_regular_points(name: str, data: st.DataObject) -> None:
    left, right, regular, count, outputs = identities(name)
    point = data.draw(st.lists(st.floats(0.2, 1.4), min_size=count, max_size=count))
    v = data.draw(st.lists(st.floats(-5.0, 5.0), min_size=outputs, max_size=outputs))
    assume(regular(*point, *v) > 1e-2)
    found, wanted = np.array(left(*point, *v)), np.array(right(*point, *v))
    scale = max(1.0, float(np.max(np.abs(found))), float(np.max(np.abs(wanted))))
    assert np.max(np.abs(found - wanted)) < 1e-9 * scale


def test_gravity_is_exact() -> None:
    for plant in (vtol, ball_and_beam, gallery.quadrotor):
        assert not plant().dynamics.has(sp.Float)
    assert vtol().drift[4] == -sp.Rational(981, 100)
    assert linearize(nominal_robot(), operating_point={ETA1: 0.5, U1: 0}).determinant == -ETA1
