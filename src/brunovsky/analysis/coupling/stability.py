"""Exact limit of the communication step: eigenvalues of the coupled step of a chain and its linear outer loop."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from brunovsky.analysis._checks import stable_gain
from brunovsky.analysis.coupling.scheme import Array, Scheme, check_scheme, shifted
from brunovsky.errors import ParameterError


def coupled_step_matrix(gain: ArrayLike, communication_step: float, scheme: Scheme = "jacobi", order: int = 0) -> Array:
    """Matrix that one communication step multiplies the coupled system by: outer loop v = -K e and chain, in sequence.

    Parameters
    ----------
    gain : array_like, shape (n,)
        K of a stable chain of n integrators, in 1/s^n, ..., 1/s.
    communication_step : float
        s.
    scheme : {"jacobi", "gauss_seidel"}
        All at once, or the outer loop before the chain.
    order : int
        How many derivatives continue each signal over a step, 0 to 3.

    Returns
    -------
    ndarray, shape ((m + 1) (n + 1), (m + 1) (n + 1))
        Acts on what is exchanged: chain variables and their m derivatives (n each), then v and its m derivatives. The
        chain is integrated exactly. The coupled loop is stable where all eigenvalues lie within the unit circle.

    Raises
    ------
    ParameterError
        For an unknown scheme or order, a step that is not positive, or a gain whose loop is unstable without coupling.

    References
    ----------
    The discrete loop: K. J. Åström and B. Wittenmark, Computer-Controlled Systems, 3rd ed., Prentice Hall 1997, ch. 2.
    """
    step = check_scheme(scheme, order, communication_step, "coupled_step_matrix")
    K = stable_gain(gain, "coupled_step_matrix")
    return _advanced(np.eye((order + 1) * (len(K) + 1)), K, step, scheme, order)


def largest_communication_step(gain: ArrayLike, scheme: Scheme = "jacobi", order: int = 0) -> float:
    """Communication step from which on the coupled loop of :func:`coupled_step_matrix` is unstable, in s.

    Parameters
    ----------
    gain, scheme, order
        As those of :func:`coupled_step_matrix`.

    Returns
    -------
    float
        The smallest step at which an eigenvalue reaches the unit circle; found to a relative 1e-10.

    Raises
    ------
    ParameterError
        As :func:`coupled_step_matrix`, and where the loop is stable at no step or at all steps that were tried.
    """
    check_scheme(scheme, order, 1.0, "largest_communication_step")
    K = stable_gain(gain, "largest_communication_step")
    fastest = float(np.max(np.abs(np.roots(np.concatenate(([1.0], K[::-1]))))))

    def excess(step: float) -> float:
        return spectral_radius(K, step, scheme, order) - 1.0

    steps = np.geomspace(1e-3, 1e2, 401) / fastest
    unstable = next((index for index, one in enumerate(steps) if excess(float(one)) > 0), None)
    if not unstable:
        raise ParameterError(
            f"largest_communication_step: the loop of K = {K.tolist()} is {'never' if unstable is None else 'always'} "
            f"unstable for steps from {steps[0]:.3g} to {steps[-1]:.3g} s; there is no limit to find"
        )
    return float(brentq(excess, steps[unstable - 1], steps[unstable], rtol=1e-10))


def spectral_radius(gain: ArrayLike, communication_step: float, scheme: Scheme = "jacobi", order: int = 0) -> float:
    """Largest absolute eigenvalue of :func:`coupled_step_matrix`: the factor of the error from step to step.

    Parameters
    ----------
    gain, communication_step, scheme, order
        As those of :func:`coupled_step_matrix`.

    Raises
    ------
    ParameterError
        As :func:`coupled_step_matrix`.
    """
    matrix = coupled_step_matrix(gain, communication_step, scheme, order)
    return float(np.max(np.abs(np.linalg.eigvals(matrix))))


def _advanced(exchanged: Array, K: Array, step: float, scheme: str, order: int) -> Array:
    """What is exchanged after a step, from what was before it: one case in each column."""
    n, rows = len(K), order + 1
    chain = exchanged[: rows * n].reshape(rows, n, -1)
    law = -np.einsum("i,rij->rj", K, shifted(chain, step))
    begin = exchanged[rows * n :] if scheme == "jacobi" else shifted(law, -step)
    # z, z', ..., z^(n-1), v, v', ..., v^(m) is a Taylor polynomial of z, and so is the exact chain
    state = shifted(np.concatenate((chain[0], begin)), step)[:n]
    motion = np.concatenate((state, shifted(begin, step)))
    derivatives = [motion[row : row + n] for row in range(rows)]
    return np.concatenate((*derivatives, law))
