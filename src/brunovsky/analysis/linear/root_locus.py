"""Where the poles of one chain lie, and where they go as Q or a gain of the surface changes.

The linear part of the sliding-mode law (P = 0), or the law within its boundary layer with Q + P/phi for Q, behind a
first-order lag tau at v, has the characteristic polynomial

    cn s^n (1 + tau s) + c_(n-1) s^(n-1) + ... + c1 s + Q p(s),   p(s) = cn s^(n-1) + ... + c2 s + c1.

Each parameter enters linearly, so 1 + parameter * G(s) = 0 with a fraction G: an ordinary root locus.
"""

import control
import numpy as np
from control.pzmap import PoleZeroData
from numpy.typing import ArrayLike, NDArray

from brunovsky.analysis._checks import finite_scalar, finite_vector, surface_coefficients
from brunovsky.analysis.linear.set_point import complementary_sensitivity
from brunovsky.errors import ParameterError


def pole_zero_map(gain: ArrayLike) -> PoleZeroData:
    """Closed-loop poles of one chain under v = -K e, and the zeros of its loop.

    Parameters
    ----------
    gain : array_like, shape (n,)
        K = [k1, ..., kn].

    Returns
    -------
    control.PoleZeroData
        From `control.pole_zero_map` of T = L/(1 + L): poles (n) and zeros (n - 1), in 1/s; those zeros attract the
        poles as the gain of the loop grows. ``plot()`` draws them.

    Raises
    ------
    ParameterError
        If `gain` is not a flat list of finite real numbers, or all of it is zero.

    References
    ----------
    The paper's eq. (19) with v = -K e.
    """
    return control.pole_zero_map(complementary_sensitivity(gain))


def root_locus_over_reaching_rate(
    surface: ArrayLike, *, lag: float = 0.0, rates: ArrayLike | None = None
) -> PoleZeroData:
    """Root locus of one chain over Q, the gain of the reaching law.

    Without a lag at v only one pole moves: from 0 to -Q; those of the surface stay. A lag makes all of them move, and
    shows whether some Q makes the loop unstable.

    Parameters
    ----------
    surface : array_like, shape (n,)
        C = [c1, ..., cn], cn != 0 (1/s2, 1/s, 1 for n = 3).
    lag : float
        Time constant tau >= 0 of an actuator at v, s.
    rates : array_like, shape (m,), optional
        Values of Q (1/s); python-control chooses them if left out. Read them as Q + P/phi within a boundary layer.

    Returns
    -------
    control.PoleZeroData
        From `control.root_locus_map`: ``loci`` of shape (m, n) or, with a lag, (m, n + 1), in 1/s; ``gains``, the
        values of Q; ``plot()`` draws it.

    Raises
    ------
    ParameterError
        If a number is not finite, cn is zero, or a rate or the lag is negative.

    References
    ----------
    The paper's eqs. (20)-(23) with P = 0; W. R. Evans, "Control system synthesis by root locus method", Transactions of
    the AIEE 69(1), 66-69, 1950, doi:10.1109/T-AIEE.1950.5060121.
    """
    where = "root_locus_over_reaching_rate"
    C = surface_coefficients(surface, where)
    rest = _without_reaching_rate(C, finite_scalar(lag, "lag", where, minimum=0.0))
    return _locus(C[::-1], rest, rates, "Q", where)


def root_locus_over_surface_gain(
    surface: ArrayLike, reaching_rate: float, element: int, *, lag: float = 0.0, gains: ArrayLike | None = None
) -> PoleZeroData:
    """Root locus of one chain over one gain c_k of its surface, k < n, the others as they are.

    Parameters
    ----------
    surface : array_like, shape (n,)
        C = [c1, ..., cn], cn != 0 (1/s2, 1/s, 1 for n = 3); the value of c_k itself doesn't matter.
    reaching_rate : float
        Q (1/s), or Q + P/phi within a boundary layer.
    element : int
        k = 1, ..., n - 1. Not n: S and cn scale together, only the ratios to cn count.
    lag : float
        Time constant tau >= 0 of an actuator at v, s.
    gains : array_like, shape (m,), optional
        Values of c_k >= 0, in its own unit; python-control chooses them if left out.

    Returns
    -------
    control.PoleZeroData
        From `control.root_locus_map`: ``loci`` of shape (m, n) or, with a lag, (m, n + 1), in 1/s; ``gains``, the
        values of c_k; ``plot()`` draws it.

    Raises
    ------
    ParameterError
        If a number is not finite, cn is zero, there is no such element, or a gain or the lag is negative.

    References
    ----------
    The paper's eqs. (20)-(23) with P = 0; W. R. Evans, "Control system synthesis by root locus method", Transactions of
    the AIEE 69(1), 66-69, 1950, doi:10.1109/T-AIEE.1950.5060121.
    """
    where = "root_locus_over_surface_gain"
    C = surface_coefficients(surface, where, minimum_size=2)
    Q = finite_scalar(reaching_rate, "Q", where)
    tau = finite_scalar(lag, "lag", where, minimum=0.0)
    if isinstance(element, bool) or element not in range(1, C.size):
        raise ParameterError(
            f"{where}: element = {element!r}; pass 1, ..., {C.size - 1} for C = {C.tolist()} (its last one only scales "
            "S: change the others instead)"
        )
    others = np.where(np.arange(1, C.size + 1) == element, 0.0, C)
    rest = np.asarray(np.polyadd(_without_reaching_rate(others, tau), Q * others[::-1]), dtype=np.float64)
    numerator = np.concatenate(([1.0, Q], np.zeros(element - 1)))  # s^(k-1) (s + Q)
    return _locus(numerator, rest, gains, f"c{element}", where)


def _without_reaching_rate(C: NDArray[np.float64], lag: float) -> NDArray[np.float64]:
    """The polynomial for Q = 0, highest power first."""
    polynomial = np.concatenate((C[::-1], [0.0]))
    return np.concatenate(([lag * C[-1]], polynomial)) if lag > 0.0 else polynomial


def _locus(
    numerator: NDArray[np.float64], denominator: NDArray[np.float64], values: ArrayLike | None, name: str, where: str
) -> PoleZeroData:
    chosen = None if values is None else finite_vector(values, name, where)
    if chosen is not None and np.any(chosen < 0.0):
        raise ParameterError(f"{where}: {name} = {np.min(chosen):g} is out of range; pass {name} >= 0")
    return control.root_locus_map(control.tf(numerator, denominator, name=name), chosen)
