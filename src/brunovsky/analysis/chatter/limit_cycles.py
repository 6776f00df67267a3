"""Limit cycles of the switching element by describing function, and what a limit cycle is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import control
import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from brunovsky.analysis.chatter.switching_loop import SwitchingLoop
from brunovsky.errors import ParameterError

_AMPLITUDES = 60  # along -1/N(a) where it is curved in the amplitude


@dataclass(frozen=True)
class LimitCycle:
    """Oscillation of the sliding variable S.

    Attributes
    ----------
    amplitude : float
        Half of peak to peak of S (unit of S, m/s2 for a chain of three).
    frequency : float
        Angular frequency (rad/s).
    fundamental : float
        Amplitude of the first harmonic of S (unit of S); the same as `amplitude` by describing function.
    stable : bool
        Whether the oscillation is attractive.
    method : str
        ``"describing function"``, ``"relay locus"``, ``"sampled relay"`` or ``"simulation"``.
    """

    amplitude: float
    frequency: float
    fundamental: float
    stable: bool
    method: str


def harmonic_balance(loop: SwitchingLoop) -> control.DescribingFunctionResponse:
    """Frequency response of the linear part and describing function of the switching element, with intersections.

    Parameters
    ----------
    loop : SwitchingLoop
        With P > 0.

    Returns
    -------
    control.DescribingFunctionResponse
        Of `control.describing_function_response`; its ``plot`` draws W(j w) and -1/N(a). Amplitudes in units of S,
        frequencies in rad/s; `predicted_cycles` refines the intersections and tells whether they are stable.

    Raises
    ------
    ParameterError
        If P is zero.

    References
    ----------
    A. Gelb and W. E. Vander Velde, *Multiple-Input Describing Functions and Nonlinear System Design*, McGraw-Hill,
    1968; D. P. Atherton, "Early developments in nonlinear control", IEEE Control Systems Magazine 16(3), 34-43,
    1996, doi:10.1109/37.506396.
    """
    require_switching(loop, "harmonic_balance")
    w = loop.frequencies()
    curve = loop.frequency_response(w)
    sizes = np.abs(curve[curve.real < 0.0])
    # in this unit the curves are of order one, below which control takes their short segments for parallel
    unit = loop.boundary_layer or loop.hysteresis or float(np.min(sizes, initial=np.max(np.abs(curve))))
    top = 2.0 + 2.0 * float(np.max(sizes, initial=0.0)) / unit
    amplitudes = np.geomspace(1.0, top, _AMPLITUDES)
    if loop.boundary_layer > 0.0:
        element = control.saturation_nonlinearity(1.0)
    elif loop.hysteresis > 0.0:
        element = control.relay_hysteresis_nonlinearity(1.0, 1.0)
    else:
        element = control.relay_hysteresis_nonlinearity(1.0, 0.0)
        amplitudes = np.array([1e-3, top])  # -1/N is straight, and linear in the amplitude
    scaled = control.FRD(curve / unit, w, smooth=True)
    found = control.describing_function_response(scaled, element, amplitudes, w, refine=False, warn_nyquist=False)
    refined = dict.fromkeys(_refined(loop, w, frequency) for _, frequency in found.intersections)
    system = control.FRD(curve, w, smooth=True, name="W")
    return control.DescribingFunctionResponse(
        control.nyquist_response(system, w, warn_encirclements=False, warn_nyquist=False),
        found.N_vals * unit,
        [complex(loop.frequency_response(frequency)) for _, frequency in refined],
        list(refined),
    )


def predicted_cycles(loop: SwitchingLoop) -> tuple[LimitCycle, ...]:
    """Limit cycles by describing function, stable and unstable ones told apart.

    An intersection is stable if the quasi-linear loop at a slightly larger amplitude decays (Loeb's criterion) and its
    other modes are damped.

    Parameters
    ----------
    loop : SwitchingLoop
        With P > 0.

    Returns
    -------
    tuple of LimitCycle
        In ascending order of amplitude; empty where -1/N(a) and W(j w) don't meet: the chatter dies out.

    Raises
    ------
    ParameterError
        If P is zero.

    See Also
    --------
    relay_cycles : without the approximation of a sinusoidal S.

    References
    ----------
    A. Gelb and W. E. Vander Velde, *Multiple-Input Describing Functions and Nonlinear System Design*, McGraw-Hill,
    1968; J. Loeb, "Recent advances in nonlinear servo theory", in R. Oldenburger (ed.), *Frequency Response*,
    Macmillan, 1956.
    """
    require_switching(loop, "predicted_cycles")
    cycles = [
        LimitCycle(amplitude, frequency, amplitude, _is_stable(loop, amplitude, frequency), "describing function")
        for amplitude, frequency in harmonic_balance(loop).intersections
    ]
    return tuple(sorted(cycles, key=lambda one: one.amplitude))


def require_switching(loop: SwitchingLoop, where: str) -> None:
    """Raise ParameterError where P = 0, so that nothing switches."""
    if loop.switching_gain == 0.0:
        raise ParameterError(
            f"{where}: P = 0 leaves the linear law, which has no limit cycle; pass P > 0, or see margins"
        )


def crossing_level(loop: SwitchingLoop) -> float:
    """Imaginary part of -1/N(a), the same at every amplitude (unit of S)."""
    return -0.25 * np.pi * loop.hysteresis


def peak(t: NDArray[np.floating[Any]], values: NDArray[np.floating[Any]]) -> float:
    """Largest value of a sampled curve: by a parabola where it is round, the largest sample where it has a corner."""
    i, top = int(np.argmax(values)), float(np.max(values))
    if not 2 <= i <= values.size - 3:
        return top
    spacing = np.diff(t[i - 2 : i + 3])
    if np.any(spacing <= 0.0):
        return top
    slopes = np.diff(values[i - 2 : i + 3]) / spacing
    bends = np.diff(slopes) / (t[i : i + 3] - t[i - 2 : i + 1])
    if bends[1] >= 0.0 or bends[1] < 2.0 * min(bends[0], bends[2]):
        return top
    slope = slopes[1] + bends[1] * (t[i] - t[i - 1])
    return float(top - slope**2 / (4.0 * bends[1]))


def _refined(loop: SwitchingLoop, grid: NDArray[np.float64], guess: float) -> tuple[float, float]:
    """Amplitude and frequency of the intersection in the cell of the grid in which `guess` lies."""
    cell = int(np.clip(np.searchsorted(grid, guess) - 1, 0, grid.size - 2))
    level = crossing_level(loop)

    def height(w: float) -> float:
        return float(loop.frequency_response(w).imag) - level

    frequency = float(brentq(height, grid[cell], grid[cell + 1], xtol=1e-14 * guess, rtol=1e-14))
    reach = float(abs(loop.frequency_response(frequency)))
    phi = loop.boundary_layer
    if phi == 0.0:
        return 4.0 * reach / np.pi, frequency
    gain = control.saturation_nonlinearity(1.0).describing_function
    return phi * float(brentq(lambda a: gain(a) - phi / reach, 1.0, 4.0 * reach / (np.pi * phi) + 1.0)), frequency


def _is_stable(loop: SwitchingLoop, amplitude: float, frequency: float) -> bool:
    step = 1e-5 * frequency
    value = loop.frequency_response(frequency)
    slope = (loop.frequency_response(frequency + step) - loop.frequency_response(frequency - step)) / (2j * step)
    lead = loop.hysteresis / np.sqrt(max(amplitude**2 - loop.hysteresis**2, 1e-30 * amplitude**2))
    # N' / N times the amplitude; for a saturation a positive multiple of it
    growth = (complex(1.0, -lead) * value / slope).real
    latency = float(np.arcsin(min(loop.hysteresis / amplitude, 1.0))) / frequency
    others = loop.unstable_poles(1.0 / float(abs(value)), latency, mode=frequency)
    return bool(growth < 0.0 and others == 0)
