"""Differentiate the outputs until an input appears: relative degree, decoupling matrix, Brunovsky chains."""

from dataclasses import dataclass

import sympy as sp

from brunovsky.errors import LinearizationError
from brunovsky.linearization.affine import AffineSystem
from brunovsky.linearization.lie import lie_derivative
from brunovsky.linearization.rank import is_zero
from brunovsky.linearization.simplify import tidy


@dataclass(frozen=True)
class OutputDerivatives:
    """The outputs differentiated until an input appears: y_i^(r_i) = F_i(x) + sum_j G_ij(x) u_j.

    Parameters
    ----------
    relative_degree : tuple of int, shape (p,)
        The orders r_i.
    chains : tuple of tuples of sympy.Expr
        Per output y, y', ..., y^(r_i - 1) = h, L_f h, ..., L_f^(r_i - 1) h in the states.
    drift_term : sympy.ImmutableDenseMatrix, shape (p, 1)
        The F_i = L_f^(r_i) h_i.
    decoupling_matrix : sympy.ImmutableDenseMatrix, shape (p, m)
        The G_ij = L_(g_j) L_f^(r_i - 1) h_i.
    """

    relative_degree: tuple[int, ...]
    chains: tuple[tuple[sp.Expr, ...], ...]
    drift_term: sp.ImmutableDenseMatrix
    decoupling_matrix: sp.ImmutableDenseMatrix


def differentiate_outputs(system: AffineSystem) -> OutputDerivatives:
    """Differentiate every output along the undisturbed system until an input appears.

    Parameters
    ----------
    system : AffineSystem
        The plant; its disturbances are taken as zero.

    Returns
    -------
    OutputDerivatives
        Relative degree, chains, F and G, in short forms.

    Raises
    ------
    LinearizationError
        If an output has no finite relative degree.

    References
    ----------
    A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, section 5.1, doi:10.1007/978-1-84628-615-5.
    """
    derived = [_differentiate(system, index) for index in range(len(system.outputs))]
    return OutputDerivatives(
        relative_degree=tuple(len(chain) for chain, _, _ in derived),
        chains=tuple(chain for chain, _, _ in derived),
        drift_term=sp.ImmutableDenseMatrix([drift for _, drift, _ in derived]),
        decoupling_matrix=sp.ImmutableDenseMatrix([row for _, _, row in derived]),
    )


def _differentiate(system: AffineSystem, index: int) -> tuple[tuple[sp.Expr, ...], sp.Expr, list[sp.Expr]]:
    """Chain, drift term and row of the decoupling matrix of one output."""
    n = len(system.states)
    chain = [tidy(system.outputs[index])]
    while True:
        row = [_gain(chain[-1], system, column) for column in range(len(system.inputs))]
        derivative = tidy(lie_derivative(chain[-1], system.drift, system.states))
        if any(gain != 0 for gain in row):
            return tuple(chain), derivative, row
        if len(chain) == n:
            raise LinearizationError(
                f"output {index + 1} ({system.outputs[index]}) has no finite relative degree: no input "
                f"({', '.join(map(str, system.inputs))}) appears in its first {n} derivatives (n = {n} states), so "
                "none ever will; choose an output that the inputs reach"
            )
        chain.append(derivative)


def _gain(function: sp.Expr, system: AffineSystem, column: int) -> sp.Expr:
    gain = tidy(lie_derivative(function, system.input_matrix.col(column), system.states))
    return sp.S.Zero if is_zero(gain) else gain


def vector_relative_degree(system: AffineSystem) -> tuple[int, ...]:
    """Order of the first derivative of each output in which an input appears.

    Parameters
    ----------
    system : AffineSystem
        The plant; its disturbances are taken as zero.

    Returns
    -------
    tuple of int, shape (p,)
        The r_i. They are a vector relative degree in Isidori's sense where `decoupling_matrix` has rank p; this
        function does not ask for that, `linearize` does.

    Raises
    ------
    LinearizationError
        If an output has no finite relative degree.

    References
    ----------
    A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, section 5.1, doi:10.1007/978-1-84628-615-5.
    """
    return differentiate_outputs(system).relative_degree


def decoupling_matrix(system: AffineSystem) -> sp.ImmutableDenseMatrix:
    """Matrix G_ij = L_(g_j) L_f^(r_i - 1) h_i that multiplies the inputs in y_i^(r_i).

    Parameters
    ----------
    system : AffineSystem
        The plant; its disturbances are taken as zero.

    Returns
    -------
    sympy.ImmutableDenseMatrix, shape (p, m)
        Rows in the order of the outputs, columns in that of the inputs.

    Raises
    ------
    LinearizationError
        If an output has no finite relative degree.

    References
    ----------
    A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, section 5.1, doi:10.1007/978-1-84628-615-5.
    """
    return differentiate_outputs(system).decoupling_matrix
