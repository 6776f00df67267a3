"""What the sliding mode of one chain rejects, and what it leaves.

For S = C e and v = (1/cn)(-Q S - P sign(S) - c1 e2 - ... ) + z_d^(n) (the paper's eqs. 20-23). Disturbances of the
flagship robot: d1 (m/s2) on its forward acceleration, d2 (rad/s2) on its yaw acceleration. With
h = (-sin theta, cos theta) and h_th = dh/dtheta, d2 enters the chains as eta1 d2 h_th at the level of v (matched);
d1, where z'' is computed from the model, as d1 h below it (unmatched) and as eta2 d1 h_th at the level of v.
"""

import numpy as np
from numpy.typing import ArrayLike

from brunovsky.analysis._checks import finite_scalar, surface_coefficients
from brunovsky.errors import ParameterError


def matched_disturbance_bound(surface: ArrayLike, switching_gain: float) -> float:
    """Bound of the disturbance at the level of v that the relay rejects on each axis: abs(d) < P/abs(cn).

    Sliding needs S S' < 0 as S -> 0, where S' = -Q S - P sign(S) + cn d. Holds for sign(S); with a saturation of
    half-width phi, S stays within phi instead of at zero.

    Parameters
    ----------
    surface : array_like, shape (n,)
        C = [c1, ..., cn], cn != 0.
    switching_gain : float
        P >= 0 (m/s3 for n = 3).

    Returns
    -------
    float
        P/abs(cn) (m/s3 for n = 3).

    Raises
    ------
    ParameterError
        If a number is not finite, cn is zero or P negative.

    References
    ----------
    The paper's eqs. (21)-(23); B. Draženović, "The invariance conditions in variable structure systems",
    Automatica 5(3), 287-295, 1969, doi:10.1016/0005-1098(69)90071-5.
    """
    C = surface_coefficients(surface, "matched_disturbance_bound")
    P = finite_scalar(switching_gain, "P", "matched_disturbance_bound", minimum=0.0)
    return float(P / abs(C[-1]))


def yaw_disturbance_bound(surface: ArrayLike, switching_gain: float, speed: float) -> float:
    """Bound of the robot's yaw acceleration disturbance d2 that is rejected at every heading.

    abs(d2) < P / abs(cn eta1): the disturbance is eta1 d2 h_th, and the worst heading puts all of it on one axis.

    Parameters
    ----------
    surface : array_like, shape (n,)
        C = [c1, ..., cn], cn != 0.
    switching_gain : float
        P >= 0 (m/s3).
    speed : float
        Forward velocity eta1 (m/s), of either sign; its largest magnitude for a whole manoeuvre.

    Returns
    -------
    float
        Bound of abs(d2) (rad/s2); inf at rest, where d2 doesn't reach the chains.

    Raises
    ------
    ParameterError
        If a number is not finite, cn is zero or P negative.

    References
    ----------
    The paper's eqs. (12)-(16) with d2 added, and eqs. (21)-(23).
    """
    bound = matched_disturbance_bound(surface, switching_gain)
    eta1 = abs(finite_scalar(speed, "speed", "yaw_disturbance_bound"))
    return bound / eta1 if eta1 > 0.0 else float("inf")


def forward_disturbance_bound(surface: ArrayLike, switching_gain: float, yaw_rate: float) -> float:
    """Bound of the robot's forward acceleration disturbance d1 under which sliding persists at every heading.

    c2 abs(d1) + c3 abs(d1 eta2) < P on each axis, for a constant d1 and z'' computed from the model. Below the bound
    sliding persists and leaves `unmatched_residual`. The condition is sufficient; with no other disturbance the sharp
    one is hypot(c2, c3 eta2) abs(d1) < P, since h and h_th are in quadrature. Beyond that, sliding is lost at some
    headings; with Q > 0, S then stays near what exceeds P over Q.

    Parameters
    ----------
    surface : array_like, shape (n,)
        C = [c1, ..., cn], n >= 2, cn != 0 (c2 and c3 above are its last two).
    switching_gain : float
        P >= 0 (m/s3).
    yaw_rate : float
        eta2 (rad/s), of either sign; its largest magnitude for a whole manoeuvre.

    Returns
    -------
    float
        Bound of abs(d1) (m/s2).

    Raises
    ------
    ParameterError
        If a number is not finite, C has fewer than two entries, cn is zero or P negative.

    References
    ----------
    The paper's eqs. (12)-(16) with d1 added, and eqs. (21)-(23).
    """
    where = "forward_disturbance_bound"
    C = surface_coefficients(surface, where, minimum_size=2)
    P = finite_scalar(switching_gain, "P", where, minimum=0.0)
    eta2 = finite_scalar(yaw_rate, "yaw_rate", where)
    effect = abs(C[-2]) + abs(C[-1] * eta2)
    return float(P / effect) if effect > 0.0 else float("inf")


def unmatched_residual(surface: ArrayLike, disturbance: float, rate: float = 0.0) -> float:
    """Amplitude of the position error that an unmatched disturbance leaves while sliding persists.

    On S = 0 with z'' computed from the model, c1 e + c2 e' + c3 e'' = c3 d1 h(theta), so that the amplitude is
    c3 abs(d1) / abs(c1 - c3 w^2 + j c2 w) on each axis for a heading that turns steadily at w, and at most
    c3 abs(d1) / abs(c1) when it is steady. See `forward_disturbance_bound` for when sliding persists; the surface
    must be stable.

    Parameters
    ----------
    surface : array_like, shape (n,)
        C = [c1, ..., cn], cn != 0 (1/s2, 1/s, 1 for n = 3).
    disturbance : float
        d1 (m/s2), of either sign.
    rate : float
        w (rad/s), of either sign; 0 for a steady heading.

    Returns
    -------
    float
        Amplitude (m); inf at a resonance on the imaginary axis.

    Raises
    ------
    ParameterError
        If a number is not finite or cn is zero.

    References
    ----------
    The paper's eqs. (12) and (20) with d1 added.
    """
    C = surface_coefficients(surface, "unmatched_residual", minimum_size=2)
    poles = np.roots(C[::-1])
    if np.any(poles.real > 1e-9 * np.max(np.abs(poles), initial=0.0)):
        raise ParameterError(
            f"unmatched_residual: motion on C = {C.tolist()} is not stable, so nothing settles there; pass a surface "
            "with poles in the left half-plane, for instance from surface_from_poles"
        )
    d1 = finite_scalar(disturbance, "disturbance", "unmatched_residual")
    w = finite_scalar(rate, "rate", "unmatched_residual")
    denominator = abs(np.polyval(C[::-1], 1j * w))
    if d1 == 0.0:
        return 0.0
    return float(abs(C[-1] * d1) / denominator) if denominator > 0.0 else float("inf")
