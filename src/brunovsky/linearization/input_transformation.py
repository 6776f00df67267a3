"""State-dependent static transformation of the inputs, u = beta(x) u_new.

Where outputs depend on more inputs than they have independent rows in the decoupling matrix, it is combinations of
inputs that appear too early. Making those combinations inputs themselves lets an integrator go in front of them.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import sympy as sp

from brunovsky._frozen import FrozenMapping
from brunovsky.linearization.affine import AffineSystem
from brunovsky.linearization.naming import transformed_inputs
from brunovsky.linearization.numeric import point_of
from brunovsky.linearization.rank import generic_rank
from brunovsky.linearization.simplify import factored, tidy, vanishes


@dataclass(frozen=True)
class InputTransformation:
    """Some inputs replaced by as many combinations of the inputs, with coefficients that depend on the state.

    Parameters
    ----------
    combinations : mapping of sympy.Symbol to sympy.Expr
        Each new input as a combination of the old ones, its unit being theirs times the coefficients'.
    replaced : mapping of sympy.Symbol to sympy.Expr
        Each input that goes, in the new inputs and those that stay.
    determinant : sympy.Expr
        Where it vanishes the combinations do not determine the inputs that go.
    """

    combinations: Mapping[sp.Symbol, sp.Expr]
    replaced: Mapping[sp.Symbol, sp.Expr]
    determinant: sp.Expr

    def apply(self, system: AffineSystem) -> AffineSystem:
        """Return the system with the new inputs, each in the place of one that it replaces."""
        names = dict(zip(self.replaced, self.combinations, strict=True))
        inputs = tuple(names.get(symbol, symbol) for symbol in system.inputs)
        old = sp.Matrix([self.replaced.get(symbol, symbol) for symbol in system.inputs])
        gains = (system.input_matrix * old.jacobian(sp.Matrix(inputs))).applyfunc(tidy)
        return replace(system, inputs=inputs, input_matrix=gains)


def find_transformation(
    system: AffineSystem, rows: sp.Matrix, operating_point: Mapping[str, Any]
) -> tuple[tuple[sp.Symbol, ...], InputTransformation]:
    """Make the independent combinations of inputs in some rows of the decoupling matrix inputs themselves.

    Each combination is a row without the factors that its entries share; a row with a single input leaves it as it is.
    Of the other inputs that occur, those go whose coefficients have the determinant that does not vanish at the
    operating point and is shortest.

    Parameters
    ----------
    system : AffineSystem
        The system (m inputs).
    rows : sympy.Matrix, shape (k, m)
        The rows, of generic rank less than the number of inputs that occur in them.
    operating_point : mapping of str to number
        Values of states and parameters by name; may be empty.

    Returns
    -------
    inputs : tuple of sympy.Symbol
        As many independent inputs as the rows have rank: old ones that stand alone in a row, then the new ones.
    transformation : InputTransformation
        To the new ones.

    References
    ----------
    A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, section 5.4, doi:10.1007/978-1-84628-615-5;
    H. Nijmeijer and A. van der Schaft, *Nonlinear Dynamical Control Systems*, 1990, chapter 8,
    doi:10.1007/978-1-4757-2101-0.
    """
    basis = _shortest_basis([_primitive(rows.row(i)) for i in range(rows.rows)], generic_rank(rows))
    single = [i for i in range(basis.rows) if sum(entry != 0 for entry in basis.row(i)) == 1]
    kept = [next(j for j, entry in enumerate(basis.row(i)) if entry != 0) for i in single]
    basis = basis.extract([i for i in range(basis.rows) if i not in single], list(range(basis.cols)))
    names = {symbol.name for symbol in system.states + system.parameters}
    point = point_of(system, {name: value for name, value in operating_point.items() if name in names})
    columns, determinant = _pivots(basis, [j for j in range(basis.cols) if j not in kept], point)
    pivots = basis.extract(list(range(basis.rows)), list(columns))
    if determinant.could_extract_minus_sign():
        basis, pivots, determinant = _negated(basis, 0), _negated(pivots, 0), -determinant
    new = transformed_inputs(system.inputs, len(columns), {str(symbol) for symbol in _symbols(system)})
    old = [system.inputs[column] for column in columns]
    stays = basis * sp.Matrix([0 if symbol in old else symbol for symbol in system.inputs])
    solved = pivots.adjugate() * (sp.Matrix(new) - stays)
    return (*(system.inputs[j] for j in kept), *new), InputTransformation(
        combinations=FrozenMapping(dict(zip(new, basis * sp.Matrix(system.inputs), strict=True))),
        replaced=FrozenMapping({s: tidy(part / determinant) for s, part in zip(old, solved, strict=True)}),
        determinant=determinant,
    )


def _primitive(row: sp.Matrix) -> sp.Matrix:
    """Row times the common denominator of its entries, without their common factors."""
    numerators, denominators = zip(*(sp.fraction(sp.together(entry)) for entry in row), strict=True)
    common = sp.lcm_list(list(denominators))
    entries = [sp.cancel(n * common / d) for n, d in zip(numerators, denominators, strict=True)]
    divisor = sp.gcd_list(entries)
    return sp.Matrix([[tidy(entry / divisor) for entry in entries]]) if divisor != 0 else sp.Matrix([entries])


def _shortest_basis(rows: Sequence[sp.Matrix], rank: int) -> sp.Matrix:
    chosen: list[sp.Matrix] = []
    for row in sorted(rows, key=lambda row: sum(int(sp.count_ops(entry)) for entry in row)):
        if generic_rank(sp.Matrix.vstack(*chosen, row)) > len(chosen):
            chosen.append(row)
    return sp.Matrix.vstack(*chosen[:rank])


def _pivots(
    basis: sp.Matrix, allowed: Sequence[int], point: Mapping[sp.Symbol, sp.Expr]
) -> tuple[tuple[int, ...], sp.Expr]:
    candidates = []
    for columns in itertools.combinations(allowed, basis.rows):
        determinant = factored(basis.extract(list(range(basis.rows)), list(columns)).det(method="berkowitz"))
        if determinant != 0:
            candidates.append((vanishes(determinant, point), int(sp.count_ops(determinant)), columns, determinant))
    _, _, columns, determinant = min(candidates, key=lambda candidate: candidate[:3])
    return columns, determinant


def _negated(matrix: sp.Matrix, row: int) -> sp.Matrix:
    return sp.diag(*(-1 if i == row else 1 for i in range(matrix.rows))) * matrix


def _symbols(system: AffineSystem) -> tuple[sp.Symbol, ...]:
    return (*system.states, *system.inputs, *system.parameters, *system.disturbances)
