"""Gains of super-twisting laws: which slope of a disturbance they bear."""

import numpy as np
from numpy.typing import ArrayLike

from brunovsky.analysis._checks import finite_scalar, finite_vector
from brunovsky.blocks.library.outer_loops.twisting_gains import WELL_ESTABLISHED
from brunovsky.errors import ParameterError


def super_twisting_slope_bound(L: float, k: ArrayLike = WELL_ESTABLISHED) -> float:
    """Slope below which every disturbance is removed in finite time: L min(k2, k1^2 - k2).

    Of S' = -k1 sqrt(L abs(S)) sign(S) + w + delta, w' = -k2 L sign(S). With K1 = k1 sqrt(L), K2 = k2 L the condition
    K2 > abs(delta'), K1 > sqrt(K2 + abs(delta')) is sufficient; the first part is necessary as well.

    Parameters
    ----------
    L : float
        Parameter L > 0 of `brunovsky.blocks.super_twisting` (unit of S per s2, m/s4 for n = 3).
    k : array_like, shape (2,)
        Its parameters k1, k2 > 0.

    Returns
    -------
    float
        Bound of abs(delta'), the slope of the disturbance at the level of v times abs(cn) (unit of L); 0 where
        k1^2 <= k2 and the condition guarantees nothing.

    Raises
    ------
    ParameterError
        If L is not positive and finite or k not two positive numbers.

    References
    ----------
    A. Levant, "Robust exact differentiation via sliding mode technique", Automatica 34(3), 379-384, 1998 (1.5 and 1.1);
    R. Seeber and M. Horn, "Stability proof for a well-established super-twisting parameter setting", Automatica 84,
    241-243, 2017, doi:10.1016/j.automatica.2017.07.002 (the condition).
    """
    where = "super_twisting_slope_bound"
    scale = finite_scalar(L, "L", where, minimum=0.0, strict=True)
    gains = finite_vector(k, "k", where, minimum_size=2)
    if gains.size != 2 or np.any(gains <= 0):
        raise ParameterError(f"{where}: k = {gains.tolist()}; pass two positive gains, k1 and k2")
    return scale * float(max(min(gains[1], gains[0] ** 2 - gains[1]), 0.0))


def super_twisting_condition(slope: float, L: float, k: ArrayLike = WELL_ESTABLISHED) -> bool:
    """Whether super-twisting with these gains is sure to remove every disturbance of this slope.

    Parameters
    ----------
    slope : float
        Bound >= 0 of the slope of the disturbance at the level of v times abs(cn) (unit of L).
    L, k
        As for `super_twisting_slope_bound`.

    Returns
    -------
    bool
        False says that convergence is not guaranteed, or, where k2 L is no more than the slope, that it fails.

    Raises
    ------
    ParameterError
        As `super_twisting_slope_bound`, or if the slope is negative.

    References
    ----------
    As for `super_twisting_slope_bound`.
    """
    wanted = finite_scalar(slope, "slope", "super_twisting_condition", minimum=0.0)
    return super_twisting_slope_bound(L, k) > wanted
