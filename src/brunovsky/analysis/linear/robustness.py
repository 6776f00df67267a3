"""Margins of a linear loop; that of one chain is cut where v enters the inner loop.

That cut is where an actuator's lag, a sampled controller's delay or a wrong inner-loop gain appear.
"""

from dataclasses import dataclass

import control
import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from brunovsky.analysis._checks import finite_vector, stable_gain, stable_loop
from brunovsky.analysis.linear._frequencies import frequencies as frequencies_of
from brunovsky.errors import ParameterError


@dataclass(frozen=True)
class Margins:
    """Margins of a stable linear loop; see `margins`.

    Attributes
    ----------
    gain_lower, gain_upper : float
        Factors in [0, 1) and (1, inf] between which the loop gain may vary; 0 and inf where nothing limits it.
    phase : float
        Phase margin of smallest magnitude, in rad; negative where it is a lead that destabilises.
    gain_crossover : float
        Frequency at which it is found, in rad/s.
    modulus : float
        Modulus (or stability) margin, the distance from -1 to the Nyquist plot, 1/Ms; at most 1.
    max_sensitivity : float
        Ms, the peak of abs(1/(1 + L)).
    modulus_frequency : float
        Frequency of that peak, in rad/s; inf where it is only approached.
    delay : float
        Longest pure delay at v before instability, in s.
    lag, two_lags : float
        Largest time constant, in s, of one first-order lag at v, and of each of two equal ones; inf if any will do.
    """

    gain_lower: float
    gain_upper: float
    phase: float
    gain_crossover: float
    modulus: float
    max_sensitivity: float
    modulus_frequency: float
    delay: float
    lag: float
    two_lags: float


def loop_transfer(gain: ArrayLike) -> control.TransferFunction:
    """Loop transfer function of one chain, cut at v: L(s) = K (sI - A)^-1 b = (kn s^(n-1) + ... + k1) / s^n.

    Parameters
    ----------
    gain : array_like, shape (n,)
        K = [k1, ..., kn] of v = -K e.

    Returns
    -------
    control.TransferFunction
        L, with the sign of negative feedback (the closed loop is 1/(1 + L)), for `control.bode_plot`,
        `control.nyquist_plot`, `control.root_locus_plot` and so on.

    Raises
    ------
    ParameterError
        If `gain` is not a flat list of finite real numbers, or all of it is zero.

    References
    ----------
    K. J. Åström and R. M. Murray, *Feedback Systems*, Princeton University Press, 2008,
    doi:10.1515/9781400828739.
    """
    K = finite_vector(gain, "K", "loop_transfer")
    if not np.any(K):
        raise ParameterError("loop_transfer: K is zero, so there is no loop; pass at least one gain that is not")
    return control.tf(K[::-1], np.concatenate(([1.0], np.zeros(K.size))), inputs=["v"], outputs=["v_return"], name="L")


def margins(gain: ArrayLike) -> Margins:
    """Classical margins of v = -K e on one chain, and the delay and lags it tolerates at v.

    A chain of three integrators is only conditionally stable: its gain margin is a *lower* one, which the single
    number of `control.margin` doesn't tell from an upper one.

    Parameters
    ----------
    gain : array_like, shape (n,)
        K = [k1, ..., kn]; see `sliding_gain` and `boundary_layer_gain` for the sliding-mode law.

    Returns
    -------
    Margins
        Angles in rad, frequencies in rad/s, times in s.

    Raises
    ------
    ParameterError
        If `gain` is not a flat list of finite real numbers, or the closed loop is not stable (it has no margins).

    References
    ----------
    K. J. Åström and R. M. Murray, *Feedback Systems*, Princeton University Press, 2008,
    doi:10.1515/9781400828739.
    """
    return loop_margins(loop_transfer(stable_gain(gain, "margins")))


def loop_margins(loop: control.TransferFunction) -> Margins:
    """Classical margins of any stable loop with negative feedback, and the delay and lags it tolerates at its cut.

    Parameters
    ----------
    loop : control.TransferFunction or control.StateSpace
        Loop transfer function L, one input and one output, in continuous time; the closed loop is 1/(1 + L). It may be
        unstable itself: margins are the smallest changes at which a closed-loop pole reaches the imaginary axis.

    Returns
    -------
    Margins
        Angles in rad, frequencies in rad/s, times in s. Where abs(L) never is 1, the phase, delay and lags are inf and
        the crossover is nan.

    Raises
    ------
    ParameterError
        If `loop` is no such system, or its closed loop is not stable (it has no margins).

    See Also
    --------
    margins : of one chain under a gain.
    disk_margin : of gain and phase varied together, also for two loops at once.

    References
    ----------
    K. J. Åström and R. M. Murray, *Feedback Systems*, Princeton University Press, 2008,
    doi:10.1515/9781400828739.
    """
    stable_loop(loop, "loop_margins", channels=1)
    gains, phases, distances, _, crossovers, nearest = control.stability_margins(loop, returnall=True)
    angles = np.deg2rad(phases)
    smallest = int(np.argmin(np.abs(angles))) if len(angles) else -1
    ends = [(abs(1.0 + value), w) for value, w in zip(_ends(loop), (0.0, float("inf")), strict=True)]
    modulus, modulus_frequency = min([*zip(distances, nearest, strict=True), *ends])
    gains = np.append(gains, [-1.0 / value for value in _ends(loop) if np.isfinite(value) and value < 0.0])
    return Margins(
        gain_lower=float(np.max(gains[gains < 1.0], initial=0.0)),
        gain_upper=float(np.min(gains[gains > 1.0], initial=np.inf)),
        phase=float(angles[smallest]) if len(angles) else float("inf"),
        gain_crossover=float(crossovers[smallest]) if len(angles) else float("nan"),
        modulus=float(modulus),
        max_sensitivity=float(1.0 / modulus),
        modulus_frequency=float(modulus_frequency),
        delay=float(np.min(np.mod(angles, 2.0 * np.pi) / crossovers, initial=np.inf)),
        lag=_lag_margin(loop, 1),
        two_lags=_lag_margin(loop, 2),
    )


def _ends(loop: control.TransferFunction) -> tuple[float, float]:
    """L at w = 0 and for w to infinity, infinite where it is not bounded."""
    system = control.ss(loop)
    with np.errstate(all="ignore"):
        static = complex(np.squeeze(system.dcgain()))
    return (static.real if np.isfinite(static) else float("inf")), float(np.squeeze(system.D))


def lag_margin(gain: ArrayLike, lags: int = 1) -> float:
    """Largest common time constant of first-order lags in series at v before the loop becomes unstable.

    The smallest tau > 0 with (1 + j w tau)^m = -L(j w) at some frequency w. The modulus of both sides gives tau(w),
    which exists up to the last gain crossover; the phase is then solved for w.

    Parameters
    ----------
    gain : array_like, shape (n,)
        K = [k1, ..., kn] of v = -K e.
    lags : int
        Number m >= 1 of equal lags 1/(1 + tau s), such as an actuator's current and torque loops.

    Returns
    -------
    float
        tau (s); inf if the loop is stable with any.

    Raises
    ------
    ParameterError
        If `gain` is not a flat list of finite real numbers, the loop without lags is not stable, or `lags` < 1.

    References
    ----------
    For n = 3 and m = 1, Routh's criterion gives (k2 k3 - k1) / k2^2; the frequency-domain condition is Nyquist's,
    K. J. Åström and R. M. Murray, *Feedback Systems*, 2008, doi:10.1515/9781400828739.
    """
    K = stable_gain(gain, "lag_margin")
    if isinstance(lags, bool) or not isinstance(lags, int | np.integer) or lags < 1:
        raise ParameterError(f"lag_margin: lags = {lags!r} is not a positive integer; pass 1, 2, ...")
    return _lag_margin(loop_transfer(K), int(lags))


def _lag_margin(loop: control.TransferFunction, lags: int) -> float:
    def time_constant(w: NDArray[np.float64]) -> NDArray[np.float64]:
        excess = np.maximum(np.abs(loop(1j * w)) ** (2.0 / lags) - 1.0, 0.0)
        return np.asarray(np.sqrt(excess) / w)

    def phase_error(w: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.angle((1.0 + 1j * w * time_constant(w)) ** lags / -loop(1j * w)))

    crossovers = control.stability_margins(loop, returnall=True)[4]
    if not len(crossovers):
        return float("inf")
    last_crossover = np.max(crossovers)
    frequencies = frequencies_of((*loop.poles(), *loop.zeros()), 1e-6 * last_crossover, last_crossover)
    errors = phase_error(frequencies)
    candidates = []
    for i in np.flatnonzero(np.signbit(errors[:-1]) != np.signbit(errors[1:])):
        if max(abs(errors[i]), abs(errors[i + 1])) > np.pi / 2:
            continue  # a jump between -pi and pi
        w = brentq(phase_error, frequencies[i], frequencies[i + 1], xtol=1e-15 * last_crossover, rtol=1e-14)
        tau = float(time_constant(w))
        if abs(phase_error(w)) > 1e-6:
            continue  # a jump within the interval
        if tau > 0.0:  # 0: abs(L) < 1 there, between two crossovers, where the modulus can't be met
            candidates.append(tau)
    return min(candidates, default=float("inf"))
