"""How long the sampling period of a sampled sliding mode may be: poles of the held linear part of one chain."""

from __future__ import annotations

from typing import get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import expm
from scipy.optimize import brentq

from brunovsky.analysis._checks import finite_scalar, surface_coefficients
from brunovsky.analysis.design import surface_poles
from brunovsky.blocks.library.outer_loops.surface_map import SurfaceMap, mean_rates
from brunovsky.errors import ParameterError


def sampled_sliding_poles(
    surface: ArrayLike, sampling_period: float, *, reaching_rate: float | None = None, surface_map: SurfaceMap = "euler"
) -> NDArray[np.complex128]:
    """Poles of one chain under the linear part of `brunovsky.blocks.sliding_mode_sampled`, v held over a period.

    The linear part is v = y_d^(n) - (q S + m e)/b with q = 1/h on the surface, where the implicit schemes aim at
    S[k+1] = 0, and q = Q off it. By the exact map the poles are 1 - h q and the zeros of the sampled chain from v to S.

    Parameters
    ----------
    surface : array_like, shape (n,)
        C = [c1, ..., cn], cn != 0 (1/s2, 1/s, 1 for n = 3).
    sampling_period : float
        h > 0 (s).
    reaching_rate : float, optional
        Q (1/s); not given: on the surface.
    surface_map : {"euler", "exact"}
        How the law takes v to move S.

    Returns
    -------
    ndarray of complex, shape (n,)
        Poles in the z plane, sorted by real, then imaginary part; the error decays if all are inside the unit circle.

    Raises
    ------
    ParameterError
        If a number is not finite, cn is zero, the period not positive, or the map unknown.

    References
    ----------
    K. J. Åström, P. Hagander and J. Sternby, "Zeros of sampled systems", Automatica 20(1), 31-38, 1984; B. Wang,
    X. Yu and G. Chen, "ZOH discretization effect on single-input sliding mode control systems with matched
    uncertainties", Automatica 45(1), 118-125, 2009, doi:10.1016/j.automatica.2008.05.028.
    """
    where = "sampled_sliding_poles"
    C = surface_coefficients(surface, where)
    h = finite_scalar(sampling_period, "sampling_period", where, minimum=0.0, strict=True)
    q = 1 / h if reaching_rate is None else finite_scalar(reaching_rate, "Q", where)
    if surface_map not in get_args(SurfaceMap):
        raise ParameterError(f"{where}: surface_map = {surface_map!r} is unknown; pass 'euler' or 'exact'")
    *rates, gain = mean_rates(list(C), h, surface_map)
    if gain == 0.0:
        raise ParameterError(f"{where}: with C = {C.tolist()} v does not move S in {h:g} s; pass a shorter period")
    held = expm(h * np.eye(C.size + 1, k=1))[:-1]  # of the chain and its held input
    K = (q * C + np.array(rates)) / gain
    poles = np.linalg.eigvals(held[:, :-1] - np.outer(held[:, -1], K))
    return np.sort_complex(np.asarray(poles, dtype=np.complex128))


def largest_sampling_period(
    surface: ArrayLike, *, reaching_rate: float | None = None, surface_map: SurfaceMap = "euler"
) -> float:
    """Sampling period at which the linear part of a sampled sliding mode loses stability.

    For the paper's C = [500, 10, 1] it is 57.2 ms by Euler's rule and 154.9 ms by the exact map on the surface; off it,
    with Q = 5/s, 40.5 ms by Euler's rule and again 154.9 ms.

    Parameters
    ----------
    surface, reaching_rate, surface_map
        As for `sampled_sliding_poles`; the surface must be stable and Q > 0.

    Returns
    -------
    float
        The first period (s) with a pole on the unit circle; inf where there is none, as for n = 2 by the exact map on
        the surface.

    Raises
    ------
    ParameterError
        If a number is not finite, cn or Q is zero, or the surface is not stable.

    References
    ----------
    As for `sampled_sliding_poles`.
    """
    where = "largest_sampling_period"
    C = surface_coefficients(surface, where)
    poles = surface_poles(C)
    if np.any(poles.real >= 0):
        raise ParameterError(
            f"{where}: the surface C = {C.tolist()} is not stable at any period; surface_from_poles gives stable ones"
        )
    Q = None if reaching_rate is None else finite_scalar(reaching_rate, "Q", where, minimum=0.0, strict=True)

    def excess(period: float) -> float:
        found = sampled_sliding_poles(C, period, reaching_rate=Q, surface_map=surface_map)
        return float(np.max(np.abs(found))) - 1.0

    rates = np.abs(poles) if Q is None else np.append(np.abs(poles), Q)
    if rates.size == 0:
        return float("inf")
    before = 1e-2 / np.max(rates)
    for period in np.geomspace(before, 1e3 / np.min(rates), 600)[1:]:
        if excess(period) > 0.0:
            return float(brentq(excess, before, period, xtol=1e-15 * period, rtol=1e-12))
        before = period
    return float("inf")
