"""Normal form: the chains, and where they are not all of the system, coordinates that complete them."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import sympy as sp

from brunovsky._frozen import FrozenMapping
from brunovsky.linearization.affine import AffineSystem
from brunovsky.linearization.inverse import invert
from brunovsky.linearization.lie import lie_derivative
from brunovsky.linearization.naming import numbered
from brunovsky.linearization.rank import generic_rank, is_zero
from brunovsky.linearization.simplify import tidy


@dataclass(frozen=True)
class NormalForm:
    """Change of coordinates z = Phi(x) in which the chains are linear.

    Parameters
    ----------
    map : mapping of sympy.Symbol to sympy.Expr, length n
        Every coordinate in the states of the extended system: first the chains, Zi_k = y_i^(k - 1), then eta_j.
    chains : tuple of tuples of sympy.Symbol
        The coordinates of each chain.
    complement : tuple of sympy.Symbol, shape (n - sum r_i,)
        The coordinates eta that complete them to a diffeomorphism (generically).
    input_free : bool
        Whether no input appears in the derivatives of the eta, L_g eta = 0. Where functions with that property were
        not found, states complete the map.
    inverse : mapping of sympy.Symbol to sympy.Expr, or None
        Every state in the coordinates, angles modulo 2 pi; None where it was not found in closed form.
    branch : tuple of sympy.Expr
        Functions of the states that the inverse takes as positive.

    References
    ----------
    A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, section 5.1, doi:10.1007/978-1-84628-615-5.
    """

    map: Mapping[sp.Symbol, sp.Expr]
    chains: tuple[tuple[sp.Symbol, ...], ...]
    complement: tuple[sp.Symbol, ...]
    input_free: bool
    inverse: Mapping[sp.Symbol, sp.Expr] | None
    branch: tuple[sp.Expr, ...]


def find_normal_form(system: AffineSystem, chains: Sequence[Sequence[sp.Expr]]) -> NormalForm:
    """Complete the chains of a system to coordinates and invert the map.

    Parameters
    ----------
    system : AffineSystem
        The extended system.
    chains : sequence of sequences of sympy.Expr
        Per output y, y', ..., y^(r_i - 1).

    Returns
    -------
    NormalForm
        The map, and its inverse where one is found.
    """
    taken = {str(s) for s in (*system.states, *system.inputs, *system.parameters, *system.disturbances)}
    heads = [(f"Z{i}_", f"zeta{i}_") for i in range(1, len(chains) + 1)]
    names = tuple(numbered(head, system.states, len(chain), taken) for head, chain in zip(heads, chains, strict=True))
    functions, input_free = _complement(system, [function for chain in chains for function in chain])
    eta = numbered(("eta", "xi", "eta_c"), system.states, len(functions), taken)
    pairs = [pair for one, chain in zip(names, chains, strict=True) for pair in zip(one, chain, strict=True)]
    coordinate_map = dict([*pairs, *zip(eta, functions, strict=True)])
    inverse, branch = invert(coordinate_map, system.states) or (None, ())
    return NormalForm(
        map=FrozenMapping(coordinate_map),
        chains=names,
        complement=eta,
        input_free=input_free,
        inverse=None if inverse is None else FrozenMapping(inverse),
        branch=branch,
    )


def _complement(system: AffineSystem, functions: list[sp.Expr]) -> tuple[list[sp.Expr], bool]:
    """Functions that complete the given ones to coordinates, without inputs in their derivatives if possible."""
    states = sp.Matrix(system.states)
    found: list[sp.Expr] = []
    gradients = sp.Matrix(functions).jacobian(states)
    input_free = True
    for candidates, free in ((_input_free(system), True), (iter(system.states), False)):
        for candidate in candidates:
            if len(found) + len(functions) == len(states):
                break
            extended = gradients.col_join(sp.Matrix([candidate]).jacobian(states))
            if generic_rank(extended) == extended.rows:
                gradients = extended
                found.append(candidate)
                input_free &= free
    return found, input_free


def _input_free(system: AffineSystem) -> Iterator[sp.Expr]:
    """Functions with L_g = 0: states whose derivatives have no input, then potentials of forms that annihilate G.

    With x_b the states whose derivatives contain inputs, the rows of G that belong to them have left null vectors
    c(x). Where c is a gradient with respect to x_b, its potential has L_g = c G_b = 0, as the other states have no
    inputs. For mechanical systems, c depends on the positions alone and the potential is linear in the velocities.
    """
    gains = system.input_matrix
    driven = [i for i in range(gains.rows) if any(entry != 0 for entry in gains.row(i))]
    yield from (state for i, state in enumerate(system.states) if i not in driven)
    states = [system.states[i] for i in driven]
    for vector in gains[driven, :].T.nullspace(simplify=tidy):
        common = sp.lcm_list([sp.fraction(sp.together(entry))[1] for entry in vector])
        for form in (vector * common, vector):
            potential = _potential([tidy(entry) for entry in form], states)
            if potential is not None and all(is_zero(_along(potential, system, j)) for j in range(gains.cols)):
                yield potential
                break


def _along(function: sp.Expr, system: AffineSystem, column: int) -> sp.Expr:
    return lie_derivative(function, system.input_matrix.col(column), system.states)


def _potential(form: Sequence[sp.Expr], variables: Sequence[sp.Symbol]) -> sp.Expr | None:
    """Function with these derivatives, if there is one and it is polynomial in the variables."""
    potential: sp.Expr = sp.S.Zero
    for entry, variable in zip(form, variables, strict=True):
        missing = sp.expand(entry - sp.diff(potential, variable))
        if missing != 0 and not missing.is_polynomial(*variables):
            return None
        potential += sp.integrate(missing, variable)
    closed = all(is_zero(sp.diff(potential, one) - entry) for entry, one in zip(form, variables, strict=True))
    return tidy(potential) if closed else None
