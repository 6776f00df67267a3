"""How far a coupled loop can be from the monolithic one, to first order in the communication step."""

from __future__ import annotations

import control
import numpy as np
from numpy.typing import ArrayLike

from brunovsky.analysis._checks import finite_vector, stable_gain
from brunovsky.analysis.coupling.scheme import Array, check_scheme
from brunovsky.errors import ParameterError


def coupling_error_bound(times: ArrayLike, v: ArrayLike, gain: ArrayLike, communication_step: float) -> Array:
    """Bound of the position error of one chain where all components step at once and inputs are held (``"jacobi"``).

    The outer loop gives v from what reference and chain gave a step before, and the chain holds it for a step: v is
    between one and two communication steps old. With g the response of z to an impulse at v in the closed loop,

        abs(z_coupled(t) - z(t)) <= 2 h int_0^t abs(g(t - s)) abs(dv/ds) ds + O(h^2).

    Parameters
    ----------
    times : array_like, shape (k,)
        Equidistant instants, s.
    v : array_like, shape (k,)
        Outer-loop input of the chain in the monolithic loop, m/s3 for three integrators.
    gain : array_like, shape (n,)
        K of the loop's linear part, v = -K e; a boundary layer adds stability and is left out of g.
    communication_step : float
        h, s.

    Returns
    -------
    ndarray, shape (k,)
        Bound at each instant, m.

    Raises
    ------
    ParameterError
        If the times are not equidistant or as many as v, or the gain or step cannot be used.

    Notes
    -----
    With the components in sequence the chain's variables are at most one step old and the reference at most one step
    ahead; the mean ages are 3h/2 and h/2, so the sequence is about three times as accurate.
    """
    where = "coupling_error_bound"
    step = check_scheme("jacobi", 0, communication_step, where)
    K = stable_gain(gain, where)
    instants = finite_vector(times, "times", where, minimum_size=2)
    values = finite_vector(v, "v", where, minimum_size=2)
    spacing = np.diff(instants)
    if len(values) != len(instants) or np.any(np.abs(spacing - spacing[0]) > 1e-6 * abs(spacing[0])) or spacing[0] <= 0:
        raise ParameterError(f"{where}: pass equidistant increasing times and one value of v for each of them")
    n = len(K)
    loop = control.ss(np.eye(n, k=1) - np.eye(n)[:, -1:] * K, np.eye(n)[:, -1:], np.eye(n)[:1], 0)
    response = np.abs(control.impulse_response(loop, instants - instants[0]).outputs)
    slope = np.abs(np.gradient(values, instants))
    bound: Array = 2 * step * spacing[0] * np.convolve(response, slope)[: len(instants)]
    return bound
