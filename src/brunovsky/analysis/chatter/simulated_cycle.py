"""Limit cycle of a switching loop as a simulation shows it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from brunovsky.analysis._checks import finite_vector
from brunovsky.analysis.chatter.limit_cycles import LimitCycle, peak
from brunovsky.analysis.chatter.switched_response import Piece, trajectory
from brunovsky.analysis.chatter.switching_loop import SwitchingLoop
from brunovsky.errors import ParameterError

Array = NDArray[np.float64]

_WINDOW = 40  # half periods over which amplitude and frequency are averaged
_SETTLED = 2e-5  # relative change from one window to the next
_WINDOWS = 60  # after which a response is called unsettled
_PIECES = 100_000  # of a trajectory, after which it is given up
_LONGEST = 20_000  # samples of a half period, beyond which every other is dropped


@dataclass(frozen=True)
class SimulatedResponse:
    """What became of a simulated switching loop.

    Attributes
    ----------
    outcome : str
        ``"cycle"`` a steady oscillation; ``"slides"`` the relay switches faster than any mode of the loop, S goes to
        zero; ``"decays"``; ``"diverges"``; ``"unsettled"`` where amplitude or frequency still change after 2400 half
        periods: a hair before the loss of stability, or with a sampled relay whose switchings have no short pattern;
        or where a lag or delay is too small a fraction of the period, some ten-thousandths, to be stepped through.
    cycle : LimitCycle or None
        Mean of the last forty half periods where it oscillates.
    """

    outcome: str
    cycle: LimitCycle | None


def simulated_cycle(loop: SwitchingLoop, start: ArrayLike | None = None) -> SimulatedResponse:
    """Simulate the switching loop until it is steady, and measure amplitude and frequency of S.

    Parameters
    ----------
    loop : SwitchingLoop
        With P = 0 it is the linear part alone, which decays or diverges.
    start : array_like, shape (n,) or (n + m,), optional
        Initial errors e (m, m/s, m/s2 for n = 3), and the outputs of the m lags if not zero. By default S is P times
        the sum of lags, delay and sampling period, or twice the element's width if that is more.

    Returns
    -------
    SimulatedResponse
        Amplitude is half of peak to peak.

    Raises
    ------
    ParameterError
        If `start` has another length, is not finite, or zero.

    See Also
    --------
    predicted_cycles, relay_cycles : the predictions.

    References
    ----------
    E. Hairer, S. P. Nørsett and G. Wanner, *Solving Ordinary Differential Equations I*, 2nd ed., Springer, 1993,
    section II.6, on discontinuities that are located.
    """
    initial = _initial(loop, start)
    size = abs(float(np.dot(loop.surface, initial[: loop.order]))) or float(np.max(np.abs(initial)))
    width = max(loop.boundary_layer, loop.hysteresis)
    natural = loop.switching_gain * loop.dead_time + width
    small = 1e-6 * natural if loop.switching_gain > 0.0 and natural > 0.0 else 1e-4 * size
    halves: list[tuple[float, float]] = []
    means: tuple[float, float] | None = None
    last: list[Piece] = []
    for outcome, (t, S) in _halves(trajectory(loop, initial), small, 1e4 * max(size, natural)):
        if outcome:
            return SimulatedResponse(outcome, None)
        halves.append((float(t[-1] - t[0]), peak(t, np.abs(S))))
        last = [*last[-1:], (t, S)]
        if len(halves) % _WINDOW:
            continue
        durations, peaks = np.array(halves[-_WINDOW:]).T
        new = (float(durations.mean()), float(peaks.mean()))
        settled = means is not None and np.allclose(new, means, rtol=_SETTLED, atol=0.0)
        even = max(np.ptp(one[k::2]) / one.mean() for one in (durations, peaks) for k in (0, 1)) < 1e-2
        if settled and even:
            return SimulatedResponse("cycle", _measured(new, last))
        if len(halves) >= _WINDOW * _WINDOWS:
            return SimulatedResponse("unsettled", _measured(new, last))
        means = new
    return SimulatedResponse("slides", None)


def _initial(loop: SwitchingLoop, start: ArrayLike | None) -> Array:
    n, m = loop.order, len(loop.lags)
    state = np.zeros(n + m)
    if start is None:
        width = 2.0 * max(loop.boundary_layer, loop.hysteresis)
        state[n - 1] = max(loop.switching_gain * loop.dead_time, width) / loop.surface[-1] or 1.0
        return state
    given = finite_vector(start, "start", "simulated_cycle")
    if given.size not in (n, n + m) or not np.any(given):
        raise ParameterError(
            f"simulated_cycle: start = {given.tolist()} is no start for this loop; pass {n} errors that are not all "
            f"zero{f', or {n + m} numbers with the outputs of the lags' if m else ''}"
        )
    state[: given.size] = given
    return state


def _halves(pieces: Iterator[Piece], small: float, large: float) -> Iterator[tuple[str, Piece]]:
    """Parts of the trajectory between the zeros of S, or how it ended."""
    t, S = np.empty(0), np.empty(0)
    zero: float | None = None
    for count, (more_t, more_S) in enumerate(pieces):
        t, S = np.concatenate((t, more_t)), np.concatenate((S, more_S))
        if not float(np.max(np.abs(more_S))) < large:
            yield "diverges", (t, S)
            return
        # S and all else of a linear loop die out together; one short piece may be small by chance
        if S.size >= 64 and float(np.max(np.abs(S))) < small:
            yield "decays", (t, S)
            return
        begin = 0
        for i in np.flatnonzero(np.signbit(S[1:]) != np.signbit(S[:-1])).tolist():
            at = float(t[i] + (t[i + 1] - t[i]) * S[i] / (S[i] - S[i + 1]))
            if zero is not None:
                if float(np.max(np.abs(S[begin : i + 1]))) < small:
                    yield "decays", (t, S)
                    return
                yield "", (np.r_[zero, t[begin : i + 1], at], np.r_[0.0, S[begin : i + 1], 0.0])
            zero, begin = at, i + 1
        t, S = t[begin:], S[begin:]
        if S.size > _LONGEST:
            t, S = t[::-2][::-1], S[::-2][::-1]
        if count > _PIECES:
            yield "unsettled", (t, S)
            return


def _measured(means: tuple[float, float], halves: list[Piece]) -> LimitCycle:
    duration, amplitude = means
    t = np.concatenate([one[0] for one in halves])
    S = np.concatenate([one[1] for one in halves])
    even = np.linspace(t[0], t[-1], 1024, endpoint=False)
    angle = 2.0 * np.pi * np.arange(even.size) / even.size
    fundamental = float(2.0 * np.abs(np.mean(np.interp(even, t, S) * np.exp(-1j * angle))))
    return LimitCycle(amplitude, np.pi / duration, fundamental, True, "simulation")
