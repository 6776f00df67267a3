"""Disk margins: how far gain and phase may vary together, in one loop or in two at once."""

from dataclasses import dataclass

import control
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

from brunovsky.analysis._checks import finite_scalar, stable_loop
from brunovsky.analysis.linear._frequencies import frequencies
from brunovsky.errors import ParameterError

_BEYOND = 1e3  # how far beyond the slowest and the fastest closed-loop pole to look


@dataclass(frozen=True)
class DiskMargin:
    """Largest disk of complex factors F, one in each loop, that leaves the closed loop stable; see `disk_margin`.

    Attributes
    ----------
    radius : float
        The disk margin alpha of F = (1 + (1 - skew) d / 2) / (1 - (1 + skew) d / 2), abs(d) < alpha.
    gain_lower, gain_upper : float
        Real factors between which every loop gain may vary at once; inf where nothing limits it.
    phase : float
        Angle by which every loop may lag or lead at once, in rad.
    frequency : float
        Where the disk first touches, in rad/s; 0 or inf where that is only approached.
    skew : float
        The skew that was asked for.
    """

    radius: float
    gain_lower: float
    gain_upper: float
    phase: float
    frequency: float
    skew: float


def disk_margin(loop: control.StateSpace, skew: float = 0.0) -> DiskMargin:
    """Disk margin of a stable loop of one or two channels, 1/max over w of mu(S(j w) + (skew - 1)/2).

    With two channels the factors of both vary independently; the structured singular value mu of two complex scalars
    is its scaled upper bound, min over d of the largest singular value of diag(d, 1) M diag(1/d, 1), and the best d
    balances the two off-diagonal entries.

    Parameters
    ----------
    loop : control.TransferFunction or control.StateSpace
        Loop transfer function with negative feedback, S = (I + L)^-1, in continuous time; `loop_transfer`,
        `actuator_loop` and `actuator_loop_transfer` return such.
    skew : float
        In [-1, 1]: 0 for balanced changes of gain, (S - T)/2; 1 for S alone, where the disk is that of 1/Ms and favours
        increases; -1 for T alone.

    Returns
    -------
    DiskMargin
        Radius (1), gains (1), phase (rad), frequency (rad/s).

    Raises
    ------
    ParameterError
        If `loop` is no such system, its closed loop is not stable, or `skew` is out of range.

    See Also
    --------
    loop_margins : gain, phase and delay, one at a time.

    References
    ----------
    P. Seiler, A. Packard and P. Gahinet, "An introduction to disk margins", IEEE Control Systems Magazine 40(5), 78-95,
    2020, doi:10.1109/MCS.2020.3005277.
    """
    poles = stable_loop(loop, "disk_margin", channels=2)
    sigma = finite_scalar(skew, "skew", "disk_margin", minimum=-1.0)
    if sigma > 1.0:
        raise ParameterError(f"disk_margin: skew = {sigma:g} is out of range; pass -1 <= skew <= 1, 0 for balanced")

    one = 1 if isinstance(loop, control.TransferFunction) else control.ss([], [], [], np.eye(loop.ninputs))
    sensitivity = control.feedback(one, loop)  # has no pole on the imaginary axis, where L may have one

    def sizes(at_frequencies: NDArray[np.float64]) -> NDArray[np.float64]:
        at = np.asarray(sensitivity(1j * at_frequencies, squeeze=False)).transpose(2, 0, 1)
        return _structured_singular_values(at, sigma)

    speeds = np.abs(poles)
    roots = (*poles, *loop.poles(), *loop.zeros())
    grid = np.log10(frequencies(roots, np.min(speeds) / _BEYOND, np.max(speeds) * _BEYOND))
    values = sizes(10.0**grid)
    best = int(np.argmax(values))
    near = minimize_scalar(
        lambda power: -sizes(np.array([10.0**power]))[0],
        bounds=(grid[max(best - 1, 0)], grid[min(best + 1, grid.size - 1)]),
        method="bounded",
        options={"xatol": 1e-10},
    )
    peak, frequency = max((float(values[best]), 10.0 ** grid[best]), (float(-near.fun), 10.0 ** float(near.x)))
    limit = float(_structured_singular_values(control.ss(sensitivity).D[np.newaxis], sigma)[0])
    if limit >= peak * (1.0 - 1e-9) or best == grid.size - 1:
        peak, frequency = max(limit, peak), float("inf")
    elif best == 0:
        frequency = 0.0
    return _disk(1.0 / peak, float(frequency), sigma)


def _structured_singular_values(sensitivity: NDArray[np.complex128], skew: float) -> NDArray[np.float64]:
    """Structured singular value of S + (skew - 1)/2 for each value of S, shape (frequencies, size, size)."""
    size = sensitivity.shape[-1]
    matrix = sensitivity + 0.5 * (skew - 1.0) * np.eye(size)
    if size == 1:
        return np.asarray(np.abs(matrix[:, 0, 0]))
    diagonal = np.abs(matrix[:, 0, 0]) ** 2 + np.abs(matrix[:, 1, 1]) ** 2
    squares = diagonal + 2.0 * np.abs(matrix[:, 0, 1] * matrix[:, 1, 0])  # of the singular values, once balanced
    product = np.abs(np.linalg.det(matrix))
    return np.asarray(np.sqrt(0.5 * (squares + np.sqrt(np.maximum(squares**2 - 4.0 * product**2, 0.0)))))


def _disk(radius: float, frequency: float, skew: float) -> DiskMargin:
    down, up = 0.5 * radius * (1.0 - skew), 0.5 * radius * (1.0 + skew)
    lower = (1.0 - down) / (1.0 + up)
    upper = (1.0 + down) / (1.0 - up) if up < 1.0 - 1e-9 else float("inf")
    cosine = lower if np.isinf(upper) else (1.0 + lower * upper) / (lower + upper)
    phase = float(np.arccos(np.clip(cosine, -1.0, 1.0)))
    return DiskMargin(radius, lower, upper, phase, frequency, skew)
