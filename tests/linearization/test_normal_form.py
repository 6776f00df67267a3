"""Normal form, its inverse, and zero dynamics with the answers of the literature."""

import numpy as np
import pytest
import sympy as sp
from gallery_plants import GALLERY, linearized
from linearization_plants import chain

from brunovsky.errors import LinearizationError, ParameterError
from brunovsky.linearization import AffineSystem, linearize
from brunovsky.linearization.inverse import invert

A, B, C, U = sp.symbols("a b c u", real=True)
CART_POLE = {"M": 2, "m": 1, "l": 0.5, "g": 9.81}


@pytest.mark.parametrize("name", GALLERY)
def test_the_inverse_undoes_the_map(name: str) -> None:
    result = linearized(name)
    form, states = result.normal_form, result.extended_system.states
    assert form.inverse is not None
    symbols = (*states, *result.extended_system.parameters)
    forth = sp.lambdify(symbols, list(form.map.values()), cse=True)
    back = sp.lambdify((*form.map, *result.extended_system.parameters), list(form.inverse.values()), cse=True)
    branch = sp.lambdify(symbols, list(form.branch), cse=True)
    generator = np.random.default_rng(0)
    tried = 0
    while tried < 20:
        point = generator.uniform(0.1, 1.5, len(symbols))
        if all(value > 0 for value in branch(*point)):
            tried += 1
            parameters = point[len(states) :]
            np.testing.assert_allclose(back(*forth(*point), *parameters), point[: len(states)], rtol=1e-6, atol=1e-8)


def test_the_robot_s_inverse_is_polar() -> None:
    form = linearized("nominal_robot").normal_form
    assert [[str(one) for one in names] for names in form.chains] == [
        ["Z1_1", "Z1_2", "Z1_3"],
        ["Z2_1", "Z2_2", "Z2_3"],
    ]
    (_, dx, _), (_, dy, _) = form.chains
    x, y, theta, eta1, *_ = form.inverse
    assert form.inverse[theta] == sp.atan2(-dx, dy)
    assert form.inverse[eta1] == sp.sqrt(dx**2 + dy**2)
    assert form.branch == (eta1,)
    assert form.complement == ()
    assert (form.inverse[x], form.inverse[y]) == (form.chains[0][0], form.chains[1][0])


def test_a_map_that_is_not_triangular_has_no_inverse_in_closed_form() -> None:
    assert invert({B: A + sp.exp(A) + sp.sin(A)}, (A,)) is None
    assert invert({B: sp.exp(2 * A)}, (A,)) == ({A: sp.log(B) / 2}, ())


def test_zero_dynamics_of_the_pvtol_are_an_inverted_pendulum() -> None:
    zero = linearized("pvtol_centre").zero_dynamics
    first, second = zero.coordinates
    eps = sp.Symbol("epsilon", positive=True)
    assert zero.input_free
    assert zero.field == sp.Matrix([second / eps, sp.sin(first)])  # eps theta'' = sin(theta), g = 1
    eigenvalues = zero.eigenvalues(dict.fromkeys(["x", "y", "theta", "vx", "vy", "q"], 0) | {"epsilon": 0.25})
    np.testing.assert_allclose(eigenvalues, [2, -2], atol=1e-9)


def test_zero_dynamics_of_the_cart_pole_are_unstable_upright_and_critical_hanging() -> None:
    result = linearized("cart_pole")
    length, g = (sp.Symbol(name, positive=True) for name in "lg")
    first, second = result.zero_dynamics.coordinates
    assert result.zero_dynamics.field == sp.Matrix([second / length, g * sp.sin(first)])
    upright = {"s": 0.3, "theta": 0, "v": 0, "omega": 0} | CART_POLE
    np.testing.assert_allclose(result.zero_dynamics.eigenvalues(upright).real, [4.42944692, -4.42944692], rtol=1e-8)
    assert not result.is_minimum_phase(upright)
    assert not result.is_minimum_phase(upright | {"theta": sp.pi})
    hanging = result.zero_dynamics.equilibrium(upright | {"theta": 3.0, "omega": 0.1})
    assert {state.name: value for state, value in hanging.items()} == pytest.approx(
        {"s": 0.3, "theta": np.pi, "v": 0, "omega": 0}, abs=1e-8
    )


def test_zero_dynamics_of_the_induction_motor_turn_the_flux() -> None:
    zero = linearized("induction_motor").zero_dynamics
    assert len(zero.coordinates) == 1
    (psi_a,) = zero.coordinates
    speed, flux = zero.constants
    pairs = sp.Symbol("n_p", positive=True)
    assert sp.simplify(zero.field[0] + pairs * speed * sp.sqrt(flux - psi_a**2)) == 0  # psi' = n_p omega J psi
    point = dict.fromkeys(["mu", "alpha", "M", "beta", "gamma", "sigma", "n_p"], 1) | {"psi_a": 1, "psi_b": 0}
    point |= {"i_a": 1, "i_b": 0}
    assert zero.eigenvalues(point | {"omega": 0}) == pytest.approx([0], abs=1e-9)
    with pytest.raises(LinearizationError, match=r"not at rest: dpsi_b/dt = 1; eigenvalues say"):
        zero.eigenvalues(point | {"omega": 1})


def test_zero_dynamics_of_ball_and_beam_are_those_of_a_ball_held() -> None:
    zero = linearized("ball_and_beam").zero_dynamics
    (angle,) = zero.coordinates
    assert str(zero.coordinates[angle]) == "alpha"
    (radius,) = zero.constants
    assert sp.simplify(zero.field[0] ** 2 - sp.Rational(981, 100) * sp.sin(angle) / radius) == 0


def test_eigenvalues_are_the_transmission_zeros_of_a_linear_system() -> None:
    # (s + 2) / (s^2 (s + 1)): u into b and c with a' = b, and y = 2 a + b seen through the chain
    system = AffineSystem((A, B, C), (U,), [B, C, -C], [0, 0, 1], (2 * A + B,))
    result = linearize(system)
    assert result.relative_degree == (2,)
    np.testing.assert_allclose(result.zero_dynamics.eigenvalues({"a": 0, "b": 0, "c": 0}), [-2])
    assert result.is_minimum_phase({"a": 0, "b": 0, "c": 0})
    assert linearize(chain(3)).is_minimum_phase({})


def test_without_input_free_functions_states_complete_the_map() -> None:
    # g1, g2 with [g1, g2] outside their span: no two functions of five states have L_g = 0 along both
    x = sp.symbols("x1:5", real=True)
    u = sp.symbols("u1 u2", real=True)
    gains = sp.Matrix([[1, 0], [0, 1], [0, x[0]], [0, x[2]]])
    system = AffineSystem(x, u, [0, 0, -x[2], -x[3]], gains, (x[0], x[1]))
    form = linearize(system).normal_form
    assert not form.input_free
    assert "whose derivatives contain inputs" in linearize(system).explain()
    assert linearize(system).zero_dynamics.field == sp.Matrix([-form.complement[0], -form.complement[1]])


def test_missing_values_are_named() -> None:
    with pytest.raises(ParameterError, match="no value for g, l; give one"):
        linearized("cart_pole").zero_dynamics.eigenvalues({"s": 0, "theta": 0, "v": 0, "omega": 0})


@pytest.mark.parametrize("render", ["latex", "_repr_markdown_", "explain"])
def test_the_derivation_tells_of_zero_dynamics(render: str) -> None:
    text = getattr(linearized("cart_pole"), render)()
    assert "Zero dynamics" in text
    assert (
        "deta2/dt = g*sin(eta1)" if render == "explain" else r"\dot{\eta_{2}} = g \sin{\left(\eta_{1} \right)}"
    ) in text
    assert "Zero dynamics" not in linearized("nominal_robot").explain()
