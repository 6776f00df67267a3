"""How long the sampling period of a sampled sliding mode may be: poles of the held linear part of one chain."""

from __future__ import annotations

from math import factorial
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from brunovsky.analysis._checks import finite_scalar, surface_coefficients
from brunovsky.analysis.linear.design import surface_poles
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
    _check_map(surface_map, where)
    if mean_rates(list(C), h, surface_map)[-1] == 0.0:
        raise ParameterError(f"{where}: with C = {C.tolist()} v does not move S in {h:g} s; pass a shorter period")
    return np.sort_complex(1 + h * _rates(C, np.array([h]), np.array([q]), surface_map)[0])


def sampled_sliding_gain(
    surface: ArrayLike, sampling_period: float, *, reaching_rate: float | None = None, surface_map: SurfaceMap = "euler"
) -> NDArray[np.float64]:
    """K of the linear part v = y_d^(n) - K e of `brunovsky.blocks.sliding_mode_sampled`.

    Parameters
    ----------
    surface, sampling_period, reaching_rate, surface_map
        As for `sampled_sliding_poles`.

    Returns
    -------
    ndarray, shape (n,)
        K = [k1, ..., kn] (1/s3, 1/s2, 1/s for n = 3).

    Raises
    ------
    ParameterError
        As for `sampled_sliding_poles`.

    References
    ----------
    As for `sampled_sliding_poles`.
    """
    where = "sampled_sliding_gain"
    C = surface_coefficients(surface, where)
    h = finite_scalar(sampling_period, "sampling_period", where, minimum=0.0, strict=True)
    q = 1 / h if reaching_rate is None else finite_scalar(reaching_rate, "Q", where)
    _check_map(surface_map, where)
    return np.asarray(_gains(C, np.array([h]), np.array([q]), surface_map)[0], dtype=np.float64)


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
        If a number is not finite, cn or Q is zero, or the surface is not stable or all but undamped.

    References
    ----------
    As for `sampled_sliding_poles`.
    """
    where = "largest_sampling_period"
    C = surface_coefficients(surface, where)
    _check_map(surface_map, where)
    poles = surface_poles(C)
    if np.any(poles.real >= 0):
        raise ParameterError(
            f"{where}: the surface C = {C.tolist()} is not stable at any period; surface_from_poles gives stable ones"
        )
    Q = None if reaching_rate is None else finite_scalar(reaching_rate, "Q", where, minimum=0.0, strict=True)

    def excess(periods: ArrayLike) -> NDArray[np.float64]:
        h = np.atleast_1d(np.asarray(periods, dtype=np.float64))
        rates = _rates(C, h, 1 / h if Q is None else np.full_like(h, Q), surface_map)
        return np.asarray((2 * rates.real + h[:, np.newaxis] * abs(rates) ** 2).max(axis=1), dtype=np.float64)

    scales = np.abs(poles) if Q is None else np.append(np.abs(poles), Q)
    if scales.size == 0:
        return float("inf")
    periods = np.geomspace(1e-6 / np.max(scales), 1e3 / np.min(scales), 2000)
    unstable = np.flatnonzero(excess(periods) > 0.0)
    if unstable.size == 0:
        return float("inf")
    if unstable[0] == 0:
        raise ParameterError(
            f"{where}: the surface C = {C.tolist()} is so lightly damped that the limit is below {periods[0]:.2g} s; "
            "surface_from_poles gives others"
        )
    before, after = periods[unstable[0] - 1 : unstable[0] + 1]
    return float(brentq(lambda period: excess(period)[0], before, after, xtol=1e-15 * after, rtol=1e-12))


def _rates(
    C: NDArray[np.float64], h: NDArray[np.float64], q: NDArray[np.float64], surface_map: SurfaceMap
) -> NDArray[np.complex128]:
    """(z - 1)/h of the poles for several periods h and rates q, shape (m,) both, as an array of shape (m, n)."""
    n = C.size
    K = _gains(C, h, q, surface_map)
    moved = np.zeros((h.size, n, n + 1))  # of the chain and its held input: h^k/k! on diagonal k
    for k in range(1, n + 1):
        moved += np.multiply.outer(h ** (k - 1) / factorial(k), np.eye(n, n + 1, k))
    return np.asarray(np.linalg.eigvals(moved[:, :, :-1] - moved[:, :, -1:] * K[:, np.newaxis]), dtype=np.complex128)


def _gains(
    C: NDArray[np.float64], h: NDArray[np.float64], q: NDArray[np.float64], surface_map: SurfaceMap
) -> NDArray[np.float64]:
    """Rows K of v = -K e for several periods and rates."""
    *row, gain = mean_rates(list(C), h, surface_map)
    return np.stack([(q * c + rate) / gain for c, rate in zip(C, row, strict=True)], axis=-1)


def _check_map(surface_map: str, where: str) -> None:
    if surface_map not in get_args(SurfaceMap):
        raise ParameterError(f"{where}: surface_map = {surface_map!r} is unknown; pass 'euler' or 'exact'")
