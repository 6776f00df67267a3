"""Exact symmetric limit cycles of a relay in the loop: Tsypkin's locus, and stability of the switching instants.

A relay that switches every half period h = pi/w puts out a square wave, whose response S is known harmonic by
harmonic, without the describing function's neglect of all but the first. Only W(j w) is needed, so delays are exact.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from brunovsky.analysis._checks import finite_vector
from brunovsky.analysis.chatter._argument import argument_change
from brunovsky.analysis.chatter.limit_cycles import LimitCycle, crossing_level, peak, require_switching
from brunovsky.analysis.chatter.sampled_relay import sampled_cycles
from brunovsky.analysis.chatter.switching_loop import SwitchingLoop
from brunovsky.errors import ParameterError

_COARSE, _FINE = 32, 2048  # odd harmonics to find a crossing, and to compute it
_ALIASES, _ANGLES = 96, 91  # of the sampled impulse response on the unit circle


def relay_locus(loop: SwitchingLoop, frequency: ArrayLike, harmonics: int = _FINE) -> NDArray[np.complex128]:
    """Tsypkin's locus: sum over odd k of Re W(j k w) + j Im W(j k w)/k.

    A relay that switches at every half period pi/w sees (4/pi) times its imaginary part as S when it switches up,
    and (4/pi) w times its negative real part as dS/dt: it does so of itself where the imaginary part is -pi/4 times
    the hysteresis and the real part is negative. The first term alone is the describing function's condition.

    Parameters
    ----------
    loop : SwitchingLoop
        A continuous one with P > 0 and no boundary layer.
    frequency : array_like, shape (m,)
        w > 0 (rad/s).
    harmonics : int
        Number of odd harmonics that are summed; without lags the slowest part of the sum is in closed form.

    Returns
    -------
    ndarray of complex, shape (m,)
        The locus (unit of S).

    Raises
    ------
    ParameterError
        If the element is no relay, the law is sampled, there is neither lag nor delay nor hysteresis, or a frequency
        is not positive.

    References
    ----------
    Ya. Z. Tsypkin, *Relay Control Systems*, Cambridge University Press, 1984; for its relatives, I. Boiko,
    *Discontinuous Control Systems: Frequency-Domain Analysis and Design*, Birkhäuser, 2009.
    """
    _require_relay(loop, "relay_locus")
    w = finite_vector(frequency, "frequency", "relay_locus")
    if np.any(w <= 0.0):
        raise ParameterError(f"relay_locus: frequency = {w.min():g} is not positive; pass frequencies above 0 rad/s")
    if isinstance(harmonics, bool) or harmonics < 1:
        raise ParameterError(f"relay_locus: harmonics = {harmonics!r} is no positive number; pass 1, 2, ...")
    k = np.arange(1, 2 * harmonics, 2)
    terms = _remainder(loop, np.multiply.outer(w, k))
    before = np.array([-1e-12])  # half periods: without a delay the slope jumps at the switching
    value, slope = np.array([_asymptote_response(loop, before * np.pi / one, np.pi / one)[:, 0] for one in w]).T
    real = terms.real.sum(axis=-1) + 0.25 * np.pi * slope / w
    return np.asarray(real + 1j * ((terms.imag / k).sum(axis=-1) + 0.25 * np.pi * value))


def relay_cycles(loop: SwitchingLoop) -> tuple[LimitCycle, ...]:
    """Exact symmetric limit cycles of a relay that switches twice a period, with the stability of each.

    A continuous law: crossings of `relay_locus` over the frequencies that the loop's time constants reach (a pure delay
    has ever faster ones beyond, which are left out), kept where S in between stays on its side of the relay; amplitude
    and fundamental come from the whole waveform. Perturbed switching instants dt obey a difference equation whose
    characteristic function is 1 + (2/abs(dS/dt)) sum over m of (-1)^m w(m h) z^-m, with w the impulse response of W;
    its zeros outside the unit circle are counted by the argument principle. A sampled law: see `sampled_cycles`.

    Parameters
    ----------
    loop : SwitchingLoop
        With P > 0 and no boundary layer.

    Returns
    -------
    tuple of LimitCycle
        In ascending order of amplitude.

    Raises
    ------
    ParameterError
        If P is zero, the element is no relay, or nothing delays it.

    References
    ----------
    Ya. Z. Tsypkin, *Relay Control Systems*, Cambridge University Press, 1984; K. J. Åström, "Oscillations in systems
    with relay feedback", in *Adaptive Control, Filtering, and Signal Processing*, Springer, 1995.
    """
    if loop.sampling is not None:
        return sampled_cycles(loop)
    _require_relay(loop, "relay_cycles")
    level, grid = crossing_level(loop), loop.frequencies()

    def height(w: float, harmonics: int) -> float:
        return float(relay_locus(loop, [w], harmonics)[0].imag) - level

    heights = relay_locus(loop, grid, _COARSE).imag - level
    cycles = []
    for i in np.flatnonzero(np.signbit(heights[:-1]) != np.signbit(heights[1:])).tolist():
        # the neglected harmonics may move the crossing into the next cell
        cells = ((grid[i], grid[i + 1]), (grid[max(i - 1, 0)], grid[min(i + 2, grid.size - 1)]))
        cell = next((one for one in cells if height(one[0], _FINE) * height(one[1], _FINE) <= 0.0), None)
        if cell is None:
            continue
        frequency = float(brentq(height, *cell, args=(_FINE,), xtol=1e-14 * float(cell[0]), rtol=1e-13))
        if relay_locus(loop, [frequency])[0].real < 0.0:
            cycles.extend(_cycle(loop, frequency))
    return tuple(sorted(dict.fromkeys(cycles), key=lambda one: one.amplitude))


def _waveform(loop: SwitchingLoop, frequency: float) -> NDArray[np.float64]:
    """S at equal steps over half a period from the switching up (unit of S), under a square wave of f."""
    k = np.arange(1, 2 * _FINE, 2)
    spectrum = np.zeros(4 * _FINE + 1, dtype=complex)
    # f = (4/pi) sum of sin(k w t)/k, S = -W f; irfft of a spectrum X gives (2/N) Re sum X exp(j k w t)
    count = 2 * (spectrum.size - 1)
    spectrum[k] = -_remainder(loop, np.multiply(k, frequency, dtype=float)) * (4.0 / np.pi) / (1j * k) * count / 2.0
    period = np.fft.irfft(spectrum, count)
    half = period[: count // 2]
    times = np.arange(half.size) * (np.pi / frequency) / half.size
    return np.asarray(half - _asymptote_response(loop, times, np.pi / frequency)[0])


def _cycle(loop: SwitchingLoop, frequency: float) -> list[LimitCycle]:
    S = _waveform(loop, frequency)
    amplitude = peak(np.arange(float(S.size)), np.abs(S))
    if np.min(S[1:]) < -loop.hysteresis - 1e-6 * amplitude:
        return []  # the relay would switch back before the half period is over
    fundamental = float(4.0 / np.pi * abs(loop.frequency_response(frequency)))
    return [LimitCycle(amplitude, frequency, fundamental, _is_stable(loop, frequency), "relay locus")]


def _is_stable(loop: SwitchingLoop, frequency: float) -> bool:
    half = np.pi / frequency
    at_one = _alternating_impulse_response(loop, np.zeros(1), half)[0].real

    def reduced(angle: NDArray[np.float64]) -> NDArray[np.complex128]:
        inverse = np.exp(1j * angle)  # 1/z
        values = 1.0 - _alternating_impulse_response(loop, -angle, half) / at_one
        values = values / (1.0 - inverse)  # a zero at z = 1, a shift in time, is every cycle's
        # the pole of W at s = 0 stands at z = -1
        return np.asarray(values * (1.0 + inverse) if loop.reaching_rate == 0.0 else values)

    turns = argument_change(reduced, np.linspace(0.0, np.pi, _ANGLES)[1:-1]) / np.pi
    return loop.unstable_poles() + round(turns) == 0


def _alternating_impulse_response(
    loop: SwitchingLoop, angle: NDArray[np.float64], half: float
) -> NDArray[np.complex128]:
    """Sum over m >= 1 of (-1)^m w(m h) z^-m at z = exp(j angle), by Poisson's summation of W."""
    aliases = np.arange(-_ALIASES, _ALIASES)
    w = (angle[:, None] + np.pi * (1 + 2 * aliases)) / half
    values = _remainder(loop, np.abs(w))
    total = np.where(w < 0.0, np.conj(values), values).sum(axis=1) / half
    if not loop.lags:
        beta = _asymptote_rate(loop)
        ratio = -np.exp(-beta * half - 1j * angle)
        first = np.floor(loop.delay / half) + 1.0
        total = total + loop.switching_gain * np.exp(beta * loop.delay) * ratio**first / (1.0 - ratio)
    return np.asarray(total)


def _remainder(loop: SwitchingLoop, w: NDArray[np.float64]) -> NDArray[np.complex128]:
    """W(j w), without lags less its slowly falling part P exp(-j w delay) / (j w + beta)."""
    values = loop.frequency_response(w)
    if loop.lags:
        return values
    s = 1j * w
    return np.asarray(values - loop.switching_gain * np.exp(-loop.delay * s) / (s + _asymptote_rate(loop)))


def _asymptote_rate(loop: SwitchingLoop) -> float:
    return 1.0 / loop.delay if loop.delay > 0.0 else loop.switching_gain / loop.hysteresis


def _asymptote_response(loop: SwitchingLoop, t: NDArray[np.float64], half: float) -> NDArray[np.float64]:
    """Response of the part that `_remainder` leaves out to the square wave, and its slope, shape (2, t.size)."""
    if loop.lags:
        return np.zeros((2, t.size))
    beta = _asymptote_rate(loop)
    periods = (t - loop.delay) / half
    sign = np.where(np.floor(periods) % 2 == 0, 1.0, -1.0)
    decay = 2.0 * np.exp(-beta * half * (periods - np.floor(periods))) / (1.0 + np.exp(-beta * half))
    height = loop.switching_gain / beta * sign
    return np.array([height * (1.0 - decay), height * beta * decay])


def _require_relay(loop: SwitchingLoop, where: str) -> None:
    require_switching(loop, where)
    if loop.boundary_layer > 0.0:
        raise ParameterError(
            f"{where}: a boundary layer phi = {loop.boundary_layer:g} is no relay, whose locus alone is exact; pass "
            "phi = 0, or use predicted_cycles"
        )
    if loop.sampling is not None:
        raise ParameterError(f"{where}: the law is sampled; use relay_cycles, which counts in samples")
    if loop.dead_time == 0.0 and loop.hysteresis == 0.0:
        raise ParameterError(
            f"{where}: without lag, delay or hysteresis the relay slides and does not oscillate; give the actuator "
            "a lag or a delay, or the relay a hysteresis"
        )
