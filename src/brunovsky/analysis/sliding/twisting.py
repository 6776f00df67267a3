"""Gains of super-twisting laws: which slope of a disturbance they bear."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brunovsky.analysis._checks import finite_scalar, finite_vector
from brunovsky.blocks.library.outer_loops.twisting_gains import WELL_ESTABLISHED
from brunovsky.errors import ParameterError


def super_twisting_gains(slope: float) -> NDArray[np.float64]:
    """Gains of S' = -K1 sqrt(abs(S)) sign(S) + w + delta, w' = -K2 sign(S), for abs(delta') <= L: 1.5 sqrt(L), 1.1 L.

    Parameters
    ----------
    slope : float
        L > 0, bound of the slope of the disturbance at the level of v times abs(cn) (m/s4 for n = 3).

    Returns
    -------
    ndarray, shape (2,)
        K1 = k1 sqrt(L) and K2 = k2 L, of which `brunovsky.blocks.super_twisting` has k and L as parameters.

    Raises
    ------
    ParameterError
        If the slope is not positive and finite.

    References
    ----------
    A. Levant, "Robust exact differentiation via sliding mode technique", Automatica 34(3), 379-384, 1998.
    """
    L = finite_scalar(slope, "slope", "super_twisting_gains", minimum=0.0, strict=True)
    k1, k2 = WELL_ESTABLISHED
    return np.array([k1 * np.sqrt(L), k2 * L])


def super_twisting_slope_bound(gains: ArrayLike) -> float:
    """Slope below which every disturbance is removed in finite time: min(K2, K1^2 - K2).

    The condition K2 > L, K1 > sqrt(K2 + L) is sufficient; K2 > L is necessary as well. In terms of the parameters of
    `brunovsky.blocks.super_twisting` the gains are K1 = k1 sqrt(L) and K2 = k2 L.

    Parameters
    ----------
    gains : array_like, shape (2,)
        K1 and K2, both positive, as `super_twisting_gains` gives them.

    Returns
    -------
    float
        Bound of abs(delta') (m/s4 for n = 3); 0 where K1^2 <= K2 and the condition guarantees nothing.

    Raises
    ------
    ParameterError
        If they are not two positive numbers.

    References
    ----------
    R. Seeber and M. Horn, "Stability proof for a well-established super-twisting parameter setting", Automatica 84,
    241-243, 2017, doi:10.1016/j.automatica.2017.07.002.
    """
    K = finite_vector(gains, "K", "super_twisting_slope_bound", minimum_size=2)
    if K.size != 2 or np.any(K <= 0):
        raise ParameterError(f"super_twisting_slope_bound: K = {K.tolist()}; pass two positive gains, K1 and K2")
    return float(max(min(K[1], K[0] ** 2 - K[1]), 0.0))


def super_twisting_condition(gains: ArrayLike, slope: float) -> bool:
    """Whether the gains satisfy K2 > L and K1 > sqrt(K2 + L), sufficient to remove disturbances of this slope.

    Parameters
    ----------
    gains : array_like, shape (2,)
        K1 and K2, both positive.
    slope : float
        L >= 0, bound of the slope of the disturbance at the level of v times abs(cn) (m/s4 for n = 3).

    Returns
    -------
    bool
        False says that convergence is not guaranteed, or, where K2 <= L, that it fails.

    Raises
    ------
    ParameterError
        If the gains are not two positive numbers, or the slope is negative.

    References
    ----------
    As for `super_twisting_slope_bound`.
    """
    L = finite_scalar(slope, "slope", "super_twisting_condition", minimum=0.0)
    return super_twisting_slope_bound(gains) > L
