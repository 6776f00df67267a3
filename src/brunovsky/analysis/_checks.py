"""Input checks shared by the folder: a bad number ends in one sentence that names it, the place and the remedy."""

from typing import Any

import control
import numpy as np
from numpy.typing import ArrayLike, NDArray

from brunovsky.errors import ParameterError


def finite_scalar(value: float, name: str, where: str, *, minimum: float | None = None, strict: bool = False) -> float:
    """Return `value` as a finite float, at least (`strict`: above) `minimum`, or raise ParameterError."""
    try:
        number = float(value)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"{where}: {name} = {value!r} is not a real number; pass one finite number") from error
    if not np.isfinite(number):
        raise ParameterError(f"{where}: {name} = {number} is not finite; pass one finite number")
    if minimum is not None and (number < minimum or (strict and number == minimum)):
        relation = ">" if strict else ">="
        raise ParameterError(f"{where}: {name} = {number:g} is out of range; pass {name} {relation} {minimum:g}")
    return number


def finite_vector(values: ArrayLike, name: str, where: str, *, minimum_size: int = 1) -> NDArray[np.float64]:
    """Return `values` as a finite real vector of shape (n,), n >= `minimum_size`, or raise ParameterError."""
    vector = _flat_vector(values, name, where, minimum_size)
    if np.any(vector.imag):
        raise ParameterError(f"{where}: {name} = {vector.tolist()} is complex; pass real numbers")
    return vector.real.copy()


def surface_coefficients(coefficients: ArrayLike, where: str, *, minimum_size: int = 1) -> NDArray[np.float64]:
    """Return the surface C = [c1, ..., cn], finite and with c_n != 0, or raise ParameterError."""
    C = finite_vector(coefficients, "C", where, minimum_size=minimum_size)
    if C[-1] == 0.0:
        raise ParameterError(
            f"{where}: the last coefficient of C = {C.tolist()} is zero, so v does not appear in dS/dt; "
            "pass C = [c1, ..., cn] in ascending order of derivative with c_n != 0"
        )
    return C


def conjugate_poles(poles: ArrayLike, where: str) -> NDArray[np.complex128]:
    """Return `poles` of shape (n,), finite and closed under conjugation, or raise ParameterError."""
    vector = _flat_vector(poles, "poles", where, 1)
    polynomial = np.atleast_1d(np.poly(vector))
    size = np.atleast_1d(np.poly(-np.abs(vector)))
    if np.any(np.abs(polynomial.imag) > 1e-9 * size.real):
        raise ParameterError(
            f"{where}: the complex poles {vector.tolist()} are not in conjugate pairs, so no real gain places them; "
            "give the conjugate of each complex pole as well"
        )
    return vector


def stable_loop(loop: Any, where: str, *, channels: int) -> NDArray[np.complex128]:
    """Return the closed-loop poles of a loop with 1 to `channels` channels, all stable, or raise ParameterError."""
    if not isinstance(loop, control.TransferFunction | control.StateSpace):
        raise ParameterError(
            f"{where}: {type(loop).__name__} is not a loop transfer function; pass a control.TransferFunction or "
            "control.StateSpace, from loop_transfer or actuator_loop for instance"
        )
    if not loop.isctime() or loop.ninputs != loop.noutputs or loop.ninputs > channels:
        limit = "one input and one output" if channels == 1 else f"as many outputs as inputs, at most {channels}"
        raise ParameterError(
            f"{where}: the loop has {loop.ninputs} input(s), {loop.noutputs} output(s) and dt = {loop.dt}; pass one in "
            f"continuous time with {limit}"
        )
    if isinstance(loop, control.TransferFunction):
        if loop.ninputs > 1:
            raise ParameterError(
                f"{where}: a loop of several channels is needed as control.StateSpace, not as fractions"
            )
        if len(loop.num[0][0]) > len(loop.den[0][0]):
            raise ParameterError(
                f"{where}: the loop's numerator has a higher degree than its denominator; pass a proper one"
            )
        poles = np.roots(np.polyadd(loop.num[0][0], loop.den[0][0]))
    else:
        poles = control.feedback(loop, np.eye(loop.ninputs)).poles()
    if np.max(poles.real, initial=-np.inf) >= -1e-10 * np.max(np.abs(poles), initial=0.0):
        raise ParameterError(
            f"{where}: the closed loop is not stable (poles {np.round(poles, 6).tolist()}), so it has no margins; "
            "design a stable one first, for instance with place"
        )
    return np.asarray(poles, dtype=np.complex128)


def stable_gain(gain: ArrayLike, where: str) -> NDArray[np.float64]:
    """Return `gain`, K of a stable chain v = -K e, as a vector of shape (n,), or raise ParameterError."""
    K = finite_vector(gain, "K", where)
    poles = np.roots(np.concatenate(([1.0], K[::-1])))
    if np.max(poles.real) >= -1e-10 * np.max(np.abs(poles)):
        raise ParameterError(
            f"{where}: K = {K.tolist()} does not make the chain stable (poles {np.round(poles, 6).tolist()}), "
            "so it has no margins; pass a stabilising gain, for instance from place"
        )
    return K


def _flat_vector(values: ArrayLike, name: str, where: str, minimum_size: int) -> NDArray[np.complex128]:
    try:
        vector = np.asarray(values, dtype=np.complex128)
    except (TypeError, ValueError) as error:
        raise ParameterError(f"{where}: {name} = {values!r} is not a list of numbers; pass a flat one") from error
    if vector.ndim != 1 or vector.size < minimum_size:
        raise ParameterError(
            f"{where}: {name} has shape {vector.shape}; pass a flat list of at least {minimum_size} number(s), "
            "for one chain at a time"
        )
    if not np.all(np.isfinite(vector)):
        raise ParameterError(f"{where}: {name} = {vector.tolist()} is not finite; pass finite numbers")
    return vector
