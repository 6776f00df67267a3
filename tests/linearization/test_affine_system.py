"""Normalisation, parameters and checks of `AffineSystem`: every bad input gets its message."""

from typing import Any

import numpy as np
import pytest
import sympy as sp
from linearization_plants import D1, ETA1, RHO1, RHO2, U1, U2, nominal_robot, pendulum, robot

from brunovsky.errors import ModelError, ParameterError
from brunovsky.linearization import AffineSystem

A, B, U, P, D = sp.symbols("a b u p d", real=True)
GOOD: dict[str, Any] = {
    "states": (A, B),
    "inputs": (U,),
    "drift": [B, -P * A],
    "input_matrix": [0, 1],
    "outputs": (A,),
    "parameters": (P,),
    "disturbances": {D: [0, 1]},
}
RATIO = sp.Rational(981, 100)
TIME = sp.Symbol("t")


def test_sequences_matrices_and_arrays_give_the_same_system() -> None:
    expected = AffineSystem(**GOOD)
    matrices = AffineSystem(
        sp.Matrix([A, B]),
        [U],
        sp.Matrix([B, -P * A]),
        np.array([[0], [1]]),
        sp.Matrix([A]),
        [P],
        {D: sp.Matrix([0, 1])},
    )
    assert matrices == expected
    assert hash(matrices) == hash(expected)
    assert matrices.states == (A, B)
    assert matrices.drift.shape == (2, 1)
    assert AffineSystem(**GOOD | {"outputs": (B,)}) != expected


def test_dynamics_hold_inputs_and_disturbances() -> None:
    assert AffineSystem(**GOOD).dynamics == sp.Matrix([B, -P * A + U + D])


def test_a_system_cannot_be_changed() -> None:
    system = AffineSystem(**GOOD)
    with pytest.raises(AttributeError):
        system.states = ()  # type: ignore[misc]
    with pytest.raises(TypeError):
        system.disturbances[D] = sp.zeros(2, 1)  # type: ignore[index]


def test_floating_point_numbers_become_exact() -> None:
    system = AffineSystem((A,), (U,), [9.81 * A], [np.float64(0.5)], (A,))
    assert system.drift[0] == RATIO * A
    assert system.input_matrix[0] == sp.Rational(1, 2)


def test_parameters_are_replaced_everywhere_and_gone() -> None:
    nominal = robot().with_parameters({RHO1: 1, "rho2": 0.5})
    assert nominal.parameters == ()
    assert nominal.dynamics[3:] == [U1 + D1, U2 / 2 + sp.Symbol("d2", real=True)]
    partly = robot().with_parameters({RHO1: 2 * RHO2})
    assert partly.parameters == (RHO2,)
    assert partly.dynamics[3] == 2 * RHO2 * U1 + D1
    assert pendulum().with_parameters({"g": 9.81, "l": 1}).drift[1].coeff(sp.sin(pendulum().states[0])) == -RATIO
    swapped = AffineSystem((A,), (U,), [P - D], [P], (A + P,), (P, D), {B: [P]}).with_parameters({P: 2})
    assert (swapped.drift[0], swapped.input_matrix[0], swapped.outputs, swapped.disturbances[B][0]) == (
        2 - D,
        2,
        (A + 2,),
        2,
    )


@pytest.mark.parametrize(
    ("values", "error", "message"),
    [
        ({"rho3": 1}, ParameterError, r"rho3 is not a parameter of the system; known: rho1, rho2"),
        ({ETA1: 1}, ParameterError, r"eta1 is not a parameter"),
        ({"rho1": float("inf")}, ParameterError, r"rho1: inf is not a finite real value"),
        ({"rho1": "one"}, ParameterError, r"rho1: 'one' is not a number"),
        ({"rho1": TIME}, ModelError, r"row of eta1, column of u1: the symbol t in t is unknown"),
    ],
)
def test_bad_parameter_values(values: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        robot().with_parameters(values)


def test_a_system_without_parameters_says_so() -> None:
    with pytest.raises(ParameterError, match="known: none"):
        nominal_robot().with_parameters({"rho1": 1})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"states": A}, r"states: a is not a sequence"),
        ({"states": "ab"}, r"states: 'ab' is not a sequence"),
        ({"states": ("a", B)}, r"states: 'a' is not a SymPy Symbol; create it"),
        ({"inputs": (U**2,)}, r"inputs: u\*\*2 is not a SymPy Symbol"),
        ({"inputs": (), "input_matrix": sp.zeros(2, 0)}, r"inputs: there are none"),
        ({"outputs": ()}, r"outputs: there are none"),
        ({"outputs": A}, r"outputs: a is not a sequence"),
        ({"outputs": (A, B)}, r"outputs: 2 output\(s\) \(a, b\) for 1 input\(s\)"),
        ({"outputs": (A, [B, A])}, r"outputs: .*give scalar expressions"),
        ({"outputs": (A > 0,)}, r"outputs: an entry of \(a > 0,\) is not a scalar"),
        ({"drift": [B]}, r"drift: shape \(1, 1\) where \(2, 1\) is needed; give one expression per state"),
        ({"drift": sp.Matrix([[B, A]])}, r"drift: shape \(1, 2\)"),
        ({"drift": "ab"}, r"drift: 'ab' is a string"),
        ({"drift": 5}, r"drift: not a matrix"),
        ({"input_matrix": [[0, 1], [1, 0]]}, r"input_matrix: shape \(2, 2\) where \(2, 1\)"),
        ({"disturbances": {D: [1]}}, r"disturbances\[d\]: shape \(1, 1\)"),
        ({"disturbances": [D]}, r"disturbances: not a mapping"),
        ({"disturbances": {"d": [0, 1]}}, r"disturbances: 'd' is not a SymPy Symbol"),
        ({"states": (A, A)}, r"the symbol a stands twice, in states and in states"),
        ({"parameters": (P, U)}, r"the symbol u stands twice, in inputs and in parameters"),
        ({"parameters": (P, sp.Symbol("a"))}, r"the symbol a stands twice, in states and in parameters"),
        ({"disturbances": {P: [0, 1]}}, r"the symbol p stands twice, in parameters and in disturbances"),
        ({"drift": [B, TIME * A]}, r"drift, row of b: the symbol t in a\*t is unknown; declare it"),
        ({"drift": [B, sp.Symbol("a")]}, r"drift, row of b: a in a has other assumptions"),
        ({"drift": [B, -A + U**2]}, r"drift, row of b: the input u occurs in -a \+ u\*\*2; .*affine"),
        ({"input_matrix": [0, 1 + U]}, r"input_matrix, row of b, column of u: the input u occurs"),
        ({"outputs": (A + U,)}, r"output 1: the input u occurs in a \+ u"),
        ({"disturbances": {D: [0, U]}}, r"disturbances\[d\], row of b: the input u occurs"),
        ({"drift": [B, D]}, r"drift, row of b: the disturbance d occurs in d; disturbances enter only"),
        ({"drift": [B, sp.nan]}, r"drift, row of b: nan contains nan"),
        ({"outputs": (A + sp.zoo,)}, r"output 1: .* contains zoo"),
        ({"drift": [B, sp.I * A]}, r"drift, row of b: I\*a contains I"),
        ({"drift": [B, sp.Function("f")(A)]}, r"drift, row of b: f\(a\) is not an explicit function"),
        ({"drift": [B, sp.Integral(A, (A, 0, 1))]}, r"Integral\(a, \(a, 0, 1\)\) is not an explicit"),
    ],
)
def test_bad_systems_are_refused_by_name_and_place(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ModelError, match=message):
        AffineSystem(**GOOD | change)


@pytest.mark.parametrize(
    "term",
    [
        sp.sign(A),
        sp.Abs(B),
        sp.Heaviside(A),
        sp.DiracDelta(A),
        sp.Piecewise((A, A > 0), (0, True)),
        sp.Min(A, B),
        sp.Max(A, P),
        sp.floor(A),
        sp.ceiling(A),
        sp.frac(A),
        sp.Mod(A, 2),
    ],
    ids=lambda term: type(term).__name__,
)
def test_what_is_not_smooth_is_refused(term: sp.Expr) -> None:
    with pytest.raises(ModelError) as caught:
        AffineSystem(**GOOD | {"drift": [B, -A + 2 * term]})
    assert type(term).__name__ in str(caught.value)
    assert "drift, row of b" in str(caught.value)
    assert "is not smooth" in str(caught.value)
