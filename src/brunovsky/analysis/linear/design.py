"""Outer-loop design for one Brunovsky chain: linear gains, sliding surfaces, and the link between the two.

Gains K and surfaces C are in ascending order of derivative, and errors are e = z - z_d (the paper's eq. 19), so
that v = -K e + z_d^(n) and S = C e. Two chains are two designs: placing the poles of both at once would return
cross-coupled gains and refuse repeated poles.
"""

import control
import numpy as np
from numpy.typing import ArrayLike, NDArray

from brunovsky.analysis._checks import conjugate_poles, finite_scalar, finite_vector, surface_coefficients
from brunovsky.analysis.linear.integrator_chains import chain, error_dynamics
from brunovsky.errors import ParameterError


def place(poles: ArrayLike) -> NDArray[np.float64]:
    """Gain that places the closed-loop poles of one chain; repeated poles are allowed.

    Parameters
    ----------
    poles : array_like of complex, shape (n,)
        Closed-loop poles (1/s), complex ones in conjugate pairs; n is the order of the chain.

    Returns
    -------
    ndarray, shape (n,)
        K of v = -K e (1/s3, 1/s2, 1/s for n = 3).

    Raises
    ------
    ParameterError
        If the poles are not finite, or not closed under conjugation.

    See Also
    --------
    closed_loop_poles : the way back.

    References
    ----------
    J. Ackermann, "Der Entwurf linearer Regelungssysteme im Zustandsraum", at - Automatisierungstechnik 20,
    297-300, 1972, doi:10.1524/auto.1972.20.112.297.
    """
    wanted = conjugate_poles(poles, "place")
    plant = chain(wanted.size)
    return np.asarray(control.place_acker(plant.A, plant.B, wanted), dtype=np.float64)


def closed_loop_poles(gain: ArrayLike) -> NDArray[np.complex128]:
    """Poles of one chain under v = -K e, the roots of s^n + kn s^(n-1) + ... + k1.

    Parameters
    ----------
    gain : array_like, shape (n,)
        K = [k1, ..., kn].

    Returns
    -------
    ndarray of complex, shape (n,)
        Poles (1/s), sorted by real, then imaginary part. A pole repeated m times comes out with an error of about
        eps^(1/m), 1e-5 relative for m = 3; that is its conditioning, not a defect of the gain.

    Raises
    ------
    ParameterError
        If `gain` is not a flat list of finite real numbers.

    References
    ----------
    The paper's eq. (19) with v = -K e.
    """
    poles = error_dynamics(finite_vector(gain, "K", "closed_loop_poles")).poles()
    return np.sort_complex(np.asarray(poles, dtype=np.complex128))


def sliding_gain(surface: ArrayLike, reaching_rate: float) -> NDArray[np.float64]:
    """Linear part of the sliding-mode law (P = 0), as the gain K of v = -K e.

    K = [Q c1, c1 + Q c2, ..., c_(n-1) + Q cn] / cn. Its closed-loop poles are those of the surface and -Q.

    Parameters
    ----------
    surface : array_like, shape (n,)
        C = [c1, ..., cn], cn != 0 (1/s2, 1/s, 1 for n = 3).
    reaching_rate : float
        Q (1/s) of the reaching law S' = -Q S - P sign(S).

    Returns
    -------
    ndarray, shape (n,)
        K (1/s3, 1/s2, 1/s for n = 3).

    Raises
    ------
    ParameterError
        If a number is not finite or cn is zero.

    See Also
    --------
    boundary_layer_gain : the gain of the saturated law near the surface.

    References
    ----------
    The paper's eqs. (20)-(23), with P = 0.
    """
    C = surface_coefficients(surface, "sliding_gain")
    Q = finite_scalar(reaching_rate, "Q", "sliding_gain")
    lower = np.concatenate(([0.0], C[:-1]))
    return np.asarray((lower + Q * C) / C[-1], dtype=np.float64)


def boundary_layer_gain(
    surface: ArrayLike, reaching_rate: float, switching_gain: float, boundary_layer: float
) -> NDArray[np.float64]:
    """Gain of the saturated sliding law inside its boundary layer abs(S) <= phi.

    There P sat(S/phi) = (P/phi) S: the law is linear, `sliding_gain` with Q + P/phi in place of Q.

    Parameters
    ----------
    surface : array_like, shape (n,)
        C = [c1, ..., cn], cn != 0 (1/s2, 1/s, 1 for n = 3).
    reaching_rate, switching_gain : float
        Q (1/s) and P >= 0 (m/s3 for n = 3).
    boundary_layer : float
        phi > 0, the half-width of the saturation (m/s2 for n = 3).

    Returns
    -------
    ndarray, shape (n,)
        K of v = -K e (1/s3, 1/s2, 1/s for n = 3).

    Raises
    ------
    ParameterError
        If a number is not finite, cn is zero, P negative or phi not positive.

    References
    ----------
    J.-J. Slotine and S. S. Sastry, "Tracking control of non-linear systems using sliding surfaces, with application
    to robot manipulators", Int. J. Control 38(2), 465-492, 1983, doi:10.1080/00207178308933088.
    """
    where = "boundary_layer_gain"
    C = surface_coefficients(surface, where)
    Q = finite_scalar(reaching_rate, "Q", where)
    P = finite_scalar(switching_gain, "P", where, minimum=0.0)
    phi = finite_scalar(boundary_layer, "phi", where, minimum=0.0, strict=True)
    return sliding_gain(C, finite_scalar(P / phi + Q, "Q + P/phi", where))


def switching_gain_margin(surface: ArrayLike, reaching_rate: float) -> float:
    """Upper bound of the lower gain margin of a sliding mode, whatever its switching gain is.

    To an oscillation of some amplitude the sign function is a gain, the larger the smaller S: the law is `sliding_gain`
    with an effective rate q between Q and infinity. With a = c2/c3 and b = c1/c2 that linear loop is stable for factors
    of its gain above k(q) = b q/((q + b)(q + a)), which is largest at q = sqrt(a b). So no factor above k(max(Q, sqrt(a
    b))) takes the stability of any of these loops. It rests on the describing function, and is no proof.

    Parameters
    ----------
    surface : array_like, shape (3,)
        C = [c1, c2, c3] (1/s2, 1/s, 1), stable.
    reaching_rate : float
        Q > 0 (1/s) of the reaching law S' = -Q S - P sign(S).

    Returns
    -------
    float
        Factor of the loop gain (1), below 1.

    Raises
    ------
    ParameterError
        If there are not three finite coefficients of one sign, or Q is not positive.

    References
    ----------
    The Routh-Hurwitz criterion for s^3 + k (k3 s^2 + k2 s + k1), and A. Gelb and W. E. Vander Velde, "Multiple-Input
    Describing Functions and Nonlinear System Design", McGraw-Hill, 1968, for the gain of a switching element.
    """
    where = "switching_gain_margin"
    C = surface_coefficients(surface, where)
    Q = finite_scalar(reaching_rate, "Q", where, minimum=0.0, strict=True)
    if C.size != 3 or not np.all(C / C[-1] > 0.0):
        raise ParameterError(f"{where}: C = {C.tolist()}; pass three coefficients of one sign")
    a, b = C[1] / C[2], C[0] / C[1]
    q = max(Q, float(np.sqrt(a * b)))
    return float(b * q / ((q + b) * (q + a)))


def surface_poles(surface: ArrayLike) -> NDArray[np.complex128]:
    """Poles of the reduced-order motion on S = 0, the roots of cn s^(n-1) + ... + c2 s + c1.

    Parameters
    ----------
    surface : array_like, shape (n,)
        C = [c1, ..., cn], cn != 0.

    Returns
    -------
    ndarray of complex, shape (n - 1,)
        Poles (1/s), sorted by real, then imaginary part; empty for n = 1.

    Raises
    ------
    ParameterError
        If a number is not finite or cn is zero.

    References
    ----------
    The paper's eq. (20); V. I. Utkin, "Variable structure systems with sliding modes", IEEE Trans. Autom. Control
    22(2), 212-222, 1977, doi:10.1109/TAC.1977.1101446.
    """
    C = surface_coefficients(surface, "surface_poles")
    return np.sort_complex(np.asarray(np.roots(C[::-1]), dtype=np.complex128))


def surface_from_poles(poles: ArrayLike, *, leading: float = 1.0) -> NDArray[np.float64]:
    """Sliding surface whose reduced-order motion has the given poles.

    Parameters
    ----------
    poles : array_like of complex, shape (n - 1,)
        Poles on the surface (1/s), complex ones in conjugate pairs.
    leading : float
        cn != 0, the scale of S; P and phi scale with it.

    Returns
    -------
    ndarray, shape (n,)
        C = [c1, ..., cn] (1/s2, 1/s, 1 for n = 3).

    Raises
    ------
    ParameterError
        If a number is not finite, `leading` is zero, or the poles are not closed under conjugation.

    References
    ----------
    The paper's eq. (20), read backwards; see also `surface_poles`.
    """
    where = "surface_from_poles"
    scale = finite_scalar(leading, "leading", where)
    if np.size(poles) == 0:  # a chain of one integrator has no motion on its surface
        return surface_coefficients([scale], where)
    wanted = conjugate_poles(poles, where)
    monic = np.real(np.poly(wanted))[::-1]
    return surface_coefficients(scale * monic, where)
