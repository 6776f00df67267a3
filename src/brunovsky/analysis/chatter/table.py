"""Chatter of a switching loop, predicted twice and measured, a row for each loop."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from brunovsky.analysis.chatter.limit_cycles import LimitCycle, predicted_cycles, require_switching
from brunovsky.analysis.chatter.relay_locus import relay_cycles
from brunovsky.analysis.chatter.simulated_cycle import simulated_cycle
from brunovsky.analysis.chatter.switching_loop import SwitchingLoop


@dataclass(frozen=True)
class ChatterRow:
    """Amplitude (half of peak to peak, unit of S) and frequency (rad/s) of the chatter of one loop.

    Attributes
    ----------
    lag_s : tuple of float
        Time constants of the lags (s); empty without.
    delay_s : float
        Delay (s).
    sampling_s : float or None
        Sampling period (s); None for a continuous law.
    C : tuple of float
        Surface.
    Q, P, phi : float
        Reaching rate (1/s), switching gain, and half-width of the boundary layer (unit of S).
    hysteresis : float
        Half-width of the relay's hysteresis (unit of S).
    predicted_amplitude, predicted_frequency_rad_s : float or None
        Stable limit cycle by describing function; None where there is none.
    locus_amplitude, locus_frequency_rad_s, locus_fundamental : float or None
        Stable limit cycle by the exact relay locus, and the amplitude of its first harmonic; None where there is none,
        or the element is no relay.
    simulated_amplitude, simulated_frequency_rad_s, simulated_fundamental : float or None
        The same, measured; None where the simulation shows no oscillation.
    linear_part_stable : bool
        Whether the loop without its switching term is stable behind lags, delay and hold. Where it is not, a small
        limit cycle may still be stable, and larger errors diverge.
    outcome : str
        Of `SimulatedResponse`.
    """

    lag_s: tuple[float, ...]
    delay_s: float
    sampling_s: float | None
    C: tuple[float, ...]
    Q: float
    P: float
    phi: float
    hysteresis: float
    predicted_amplitude: float | None
    predicted_frequency_rad_s: float | None
    locus_amplitude: float | None
    locus_frequency_rad_s: float | None
    locus_fundamental: float | None
    simulated_amplitude: float | None
    simulated_frequency_rad_s: float | None
    simulated_fundamental: float | None
    linear_part_stable: bool
    outcome: str


def chatter_table(loops: Iterable[SwitchingLoop]) -> tuple[ChatterRow, ...]:
    """Predict and measure the chatter of each loop.

    Of several stable limit cycles the smallest by describing function is given, in which the default start of
    `simulated_cycle` usually ends, and the exact one whose frequency is nearest to it. Several do occur: the paper's
    surface has a second one just before its linear part loses stability, and a sampled relay almost always.

    Parameters
    ----------
    loops : iterable of SwitchingLoop
        Each with P > 0.

    Returns
    -------
    tuple of ChatterRow
        In the order of `loops`; `dataclasses.asdict` makes a row ready for JSON.

    Raises
    ------
    ParameterError
        If P is zero.

    References
    ----------
    See `predicted_cycles` and `relay_cycles`.
    """
    return tuple(_row(loop) for loop in loops)


def _row(loop: SwitchingLoop) -> ChatterRow:
    require_switching(loop, "chatter_table")
    predicted = _smallest(predicted_cycles(loop))
    exact = _exact(loop, predicted)
    measured = simulated_cycle(loop)
    seen = measured.cycle
    return ChatterRow(
        lag_s=loop.lags,
        delay_s=loop.delay,
        sampling_s=loop.sampling,
        C=loop.surface,
        Q=loop.reaching_rate,
        P=loop.switching_gain,
        phi=loop.boundary_layer,
        hysteresis=loop.hysteresis,
        predicted_amplitude=predicted.amplitude if predicted else None,
        predicted_frequency_rad_s=predicted.frequency if predicted else None,
        locus_amplitude=exact.amplitude if exact else None,
        locus_frequency_rad_s=exact.frequency if exact else None,
        locus_fundamental=exact.fundamental if exact else None,
        simulated_amplitude=seen.amplitude if seen else None,
        simulated_frequency_rad_s=seen.frequency if seen else None,
        simulated_fundamental=seen.fundamental if seen else None,
        linear_part_stable=loop.unstable_poles() == 0,
        outcome=measured.outcome,
    )


def _smallest(cycles: tuple[LimitCycle, ...]) -> LimitCycle | None:
    return min((one for one in cycles if one.stable), key=lambda one: one.amplitude, default=None)


def _exact(loop: SwitchingLoop, predicted: LimitCycle | None) -> LimitCycle | None:
    nothing_delays = loop.dead_time == 0.0 and loop.hysteresis == 0.0
    if loop.boundary_layer > 0.0 or nothing_delays:
        return None
    cycles = relay_cycles(loop)
    if predicted is None:
        return _smallest(cycles)
    stable = (one for one in cycles if one.stable)
    return min(stable, key=lambda one: abs(one.frequency - predicted.frequency), default=None)
