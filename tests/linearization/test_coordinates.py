"""A nonlinear change of coordinates changes no answer: degree, law, zeros, static linearisability."""

from collections.abc import Mapping
from functools import cache

import numpy as np
import pytest
import sympy as sp
from gallery_plants import GALLERY, linearized

from brunovsky.linearization import AffineSystem, Linearization, linearize, static_linearizability
from brunovsky.linearization.rank import is_zero

# States that are left as they are. A sheared angle stands in every sine as sin(s_i + s_(i + 1)^2), which expands
# into sines of squares: fractions are no longer polynomials in the sines of single angles and take minutes to cancel.
# So where there is much trigonometry the angles stay and only what enters polynomially is sheared; of the quadrotor
# one state of each kind (position, velocity, body rate), as it takes seconds as it is. More stays of the PVTOL and the
# induction motor (its fluxes), as the inverse of their normal form is sought for the zero dynamics too.
KEPT = {
    "cart_pole": {"theta"},
    "manipulator": {"q2"},
    "pvtol_centre": {"theta", "y", "vx"},
    "pvtol_flat": {"theta"},
    "pvtol_flat_untouched": {"theta"},
    "trailer": {"theta", "phi"},
    "vtol": {"phi"},
    "induction_motor": {"psi_a", "psi_b"},
    "quadrotor": {"y", "z", "phi", "theta", "psi", "vx", "vy", "q"},
}

# Equilibria of those zero dynamics that have one off the singular locus, with parameters of no particular value.
EQUILIBRIA = {
    "cart_pole": {"s": 0.3, "theta": 0, "v": 0, "omega": 0, "M": 2, "m": 1, "l": 0.5, "g": 9.81},
    "pvtol_centre": dict.fromkeys(["x", "y", "theta", "vx", "vy", "q"], 0) | {"x": 0.4, "epsilon": 0.7},
    "induction_motor": {"omega": 0, "psi_a": 0.6, "psi_b": 0.8, "i_a": 0.3, "i_b": 0.4}
    | {"mu": 1.1, "alpha": 0.9, "M": 2, "beta": 0.5, "gamma": 1.3, "sigma": 0.2, "n_p": 2},
}

PLANTS = [pytest.param(one, marks=pytest.mark.slow) if one in ("quadrotor", "trailer") else one for one in GALLERY]


def sheared(name: str) -> tuple[AffineSystem, dict[sp.Symbol, sp.Expr]]:
    """The plant in other coordinates: x_i = s_i + s_(i + 1)^2 for all but the last and the kept.

    The coefficient is 1, since a transformed input is scaled so that its coefficients are free of denominators.
    """
    system = GALLERY[name]()
    new = sp.symbols(f"s1:{len(system.states) + 1}", real=True)
    kept = {*KEPT.get(name, ()), system.states[-1].name}
    pairs = zip(system.states, new, (*new[1:], new[-1]), strict=True)
    old = [one if state.name in kept else one + other**2 for state, one, other in pairs]
    replacement = dict(zip(system.states, old, strict=True))
    slope = sp.Matrix(old).jacobian(sp.Matrix(new)).inv()
    return AffineSystem(
        new,
        system.inputs,
        slope * system.drift.xreplace(replacement),
        slope * system.input_matrix.xreplace(replacement),
        tuple(output.xreplace(replacement) for output in system.outputs),
        system.parameters,
    ), replacement


@cache
def both(name: str) -> tuple[Linearization, Linearization, Mapping[sp.Symbol, sp.Expr]]:
    system, replacement = sheared(name)
    return linearized(name), linearize(system), replacement


@pytest.mark.parametrize("name", PLANTS)
def test_degree_extension_and_law_do_not_depend_on_coordinates(name: str) -> None:
    one, other, replacement = both(name)
    assert other.relative_degree == one.relative_degree
    assert other.extension.integrators == one.extension.integrators
    assert other.is_full == one.is_full
    assert is_zero(other.determinant - one.determinant.xreplace(dict(replacement)))
    pairs = [(other.law[symbol], law.xreplace(dict(replacement))) for symbol, law in one.law.items()]
    symbols = sorted(set().union(*(part.free_symbols for pair in pairs for part in pair)), key=str)
    laws = sp.lambdify(symbols, list(zip(*pairs, strict=True)), cse=True)
    generator = np.random.default_rng(1)
    for _ in range(5):
        found, wanted = laws(*generator.uniform(0.5, 1.0, len(symbols)))
        np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("name", PLANTS)
def test_static_linearizability_does_not_depend_on_coordinates(name: str) -> None:
    one, other = static_linearizability(GALLERY[name]()), static_linearizability(sheared(name)[0])
    assert (other.answer, other.reason) == (one.answer, one.reason)
    assert (other.ranks, other.involutive) == (one.ranks, one.involutive)
    assert other.controllability_indices == one.controllability_indices


@pytest.mark.parametrize("name", EQUILIBRIA)
def test_eigenvalues_of_zero_dynamics_do_not_depend_on_coordinates(name: str) -> None:
    one, other, replacement = both(name)
    point = EQUILIBRIA[name]
    there = {symbol: point[symbol.name] for symbol in one.system.parameters}
    for new, (state, old) in reversed(list(zip(other.system.states, replacement.items(), strict=True))):
        there[new] = point[state.name] - (old - new).subs(there)
    found, wanted = other.zero_dynamics.eigenvalues(there), one.zero_dynamics.eigenvalues(point)
    np.testing.assert_allclose(found, wanted, atol=1e-9)
    assert other.is_minimum_phase(there) == one.is_minimum_phase(point)
