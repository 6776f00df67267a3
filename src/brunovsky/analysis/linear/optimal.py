"""Outer-loop design by quadratic cost for one Brunovsky chain: linear gains and sliding surfaces."""

import control
import numpy as np
from numpy.typing import ArrayLike, NDArray

from brunovsky.analysis._checks import finite_scalar, surface_coefficients
from brunovsky.analysis.linear.integrator_chains import chain
from brunovsky.errors import ParameterError


def lqr_gain(
    order: int, state_weights: ArrayLike, input_weight: float = 1.0, *, integral: bool = False
) -> NDArray[np.float64]:
    """Gain of v = -K e that minimises the integral of e' W e + R v^2 on one chain of n integrators.

    The gain for :func:`brunovsky.blocks.pole_placement`, also with ``integral=True`` there: the integral of the error
    is then one more integrator at the head of the chain. Its loop, cut at v, keeps a distance of 1 from -1: it
    tolerates any factor of the gain above 1/2, and at least 60 degrees of phase.

    Parameters
    ----------
    order : int
        n >= 1.
    state_weights : array_like, shape (n,) or (n, n)
        Diagonal of W, or W, symmetric and positive semidefinite, in ascending order of derivative. With ``integral``
        one row more, the first, for the integral. The first weight must be positive: without it the optimum leaves the
        first error as it is.
    input_weight : float
        R > 0. Only the ratio of W and R matters.
    integral : bool
        Whether the integral of the error is weighed too.

    Returns
    -------
    ndarray, shape (n,) or, with ``integral``, (n + 1,)
        K = [k1, ..., kn], or [K_I, k1, ..., kn].

    Raises
    ------
    ParameterError
        If the order is no positive integer, the weights are not finite, do not fit the order or are not as said.

    References
    ----------
    R. E. Kalman, "Contributions to the theory of optimal control", Bol. Soc. Mat. Mexicana 5, 102-119, 1960; the
    margins: M. G. Safonov and M. Athans, "Gain and phase margin for multiloop LQG regulators", IEEE Trans. Autom.
    Control 22(2), 173-179, 1977, doi:10.1109/TAC.1977.1101470.
    """
    plant = chain(order)
    if integral:
        plant = chain(order + 1)
    W = _weights(state_weights, plant.nstates, "lqr_gain")
    R = finite_scalar(input_weight, "input_weight", "lqr_gain", minimum=0.0, strict=True)
    return _regulator(plant, W, [[R]], np.zeros((plant.nstates, 1)), "lqr_gain")


def surface_from_cost(weights: ArrayLike, *, leading: float = 1.0) -> NDArray[np.float64]:
    """Sliding surface on which the integral of e' W e, from the instant it is reached, is least.

    On S = 0 the last error e_n is what drives the n - 1 others, so that this is the linear-quadratic regulator of a
    chain of n - 1 integrators with e_n in place of its input. Off-diagonal weights between e_n and the others are taken
    into account.

    Parameters
    ----------
    weights : array_like, shape (n,) or (n, n), n >= 2
        Diagonal of W, or W, symmetric and positive semidefinite, in ascending order of derivative; the first and the
        last diagonal weight positive.
    leading : float
        cn != 0, the scale of S; P and phi scale with it.

    Returns
    -------
    ndarray, shape (n,)
        C = [c1, ..., cn] (1/s2, 1/s, 1 for n = 3).

    Raises
    ------
    ParameterError
        If the weights are not finite or not as said, or ``leading`` is zero.

    References
    ----------
    V. I. Utkin and K. D. Young, "Methods for constructing discontinuity planes in multidimensional variable structure
    systems", Autom. Remote Control 39(10), 1466-1470, 1978.
    """
    where = "surface_from_cost"
    size = np.shape(weights)[0] if np.ndim(weights) in (1, 2) else 0
    if size < 2:
        raise ParameterError(f"{where}: weights of the shape {np.shape(weights)}; pass one for each of n >= 2 errors")
    W = _weights(weights, size, where)
    if W[-1, -1] <= 0.0:
        raise ParameterError(f"{where}: the last weight is {W[-1, -1]:g}; pass one > 0, it is what drives the others")
    reduced = chain(size - 1)
    gain = _regulator(reduced, W[:-1, :-1], W[-1:, -1:], W[:-1, -1:], where)
    scale = finite_scalar(leading, "leading", where)
    return surface_coefficients(scale * np.append(gain, 1.0), where)


def _regulator(
    plant: control.StateSpace, W: ArrayLike, R: ArrayLike, cross: ArrayLike, where: str
) -> NDArray[np.float64]:
    """Gain of control.lqr, refused where it does not make the chain stable."""
    problem = (
        f"{where}: these weights leave an error that does not decay; give each error a positive weight, and smaller "
        "cross terms"
    )
    try:
        gain, _, poles = control.lqr(plant.A, plant.B, W, R, cross)
    except np.linalg.LinAlgError as error:
        raise ParameterError(problem) from error
    if not np.max(poles.real) < -1e-10 * np.max(np.abs(poles)):
        raise ParameterError(problem)
    return np.asarray(gain[0], dtype=np.float64)


def _weights(values: ArrayLike, size: int, where: str) -> NDArray[np.float64]:
    """Matrix of weights, shape (size, size), symmetric, positive semidefinite and with a positive first entry."""
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"{where}: weights {values!r} are no numbers; pass a flat list or a matrix") from error
    matrix = np.diag(array) if array.ndim == 1 else array
    if matrix.shape != (size, size):
        raise ParameterError(f"{where}: weights of the shape {array.shape}; pass ({size},) or ({size}, {size})")
    if not np.all(np.isfinite(matrix)) or not np.allclose(matrix, matrix.T):
        raise ParameterError(f"{where}: the weights are not finite or not symmetric; pass finite, symmetric ones")
    if np.min(np.linalg.eigvalsh(matrix)) < -1e-12 * np.max(np.abs(matrix)):
        raise ParameterError(f"{where}: the weights are not positive semidefinite; the cost would have no least value")
    if matrix[0, 0] <= 0.0:
        raise ParameterError(f"{where}: the first weight is {matrix[0, 0]:g}; pass one > 0, or its error will stay")
    return matrix
