"""What disturbances leave of the error on the circle, and up to where P rejects them: said before any simulation."""

from __future__ import annotations

import cmath
import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm, solve_discrete_lyapunov

from brunovsky.analysis import (
    boundary_layer_gain,
    forward_disturbance_bound,
    matched_disturbance_bound,
    sliding_gain,
    yaw_disturbance_bound,
)
from brunovsky.comparison.metrics import TAIL, Array
from brunovsky.comparison.run import Run
from brunovsky.comparison.study import Law, PlannedRun
from brunovsky.comparison.study.loops import IDEAL

DISTURBANCES = {"d[1]": ("d₁", "m/s²"), "d[2]": ("d₂", "rad/s²"), "dv[1]": ("d_v1", "m/s³"), "dv[2]": ("d_v2", "m/s³")}
"""Symbol and unit of each disturbance."""


class Wave(NamedTuple):
    """A part of a disturbance in the last quarter: a phasor at an angular frequency (rad/s), of either sign."""

    frequency: float
    phasor: complex


def disturbance(planned: PlannedRun, name: str, time: Array) -> Array:
    """One disturbance at each instant (s), without noise."""
    value = np.full(time.size, float(planned.inputs.get(name, 0.0)))
    for signal in planned.signals:
        if name in signal.amplitudes:
            value += signal.amplitudes[name] * signal.shape(time)
    return value


def disturbed(planned: PlannedRun) -> bool:
    """Whether a disturbance acts at any time, constant or not; noise is none."""
    return any(planned.inputs.get(name, 0.0) for name in DISTURBANCES) or bool(planned.signals)


def tail_peaks(planned: PlannedRun) -> dict[str, float]:
    """Largest magnitude of each disturbance in the last quarter."""
    time = np.linspace(TAIL * planned.duration, planned.duration, 2001)
    return {name: float(np.max(np.abs(disturbance(planned, name, time)))) for name in DISTURBANCES}


def predicted_residual(planned: PlannedRun, law: Law) -> float | None:
    """Root mean square of the position error that disturbances leave on the circle in the last quarter, m.

    In the steady state the robot moves at eta1 = R w with its heading turning at w. In complex notation, for a part of
    the disturbance that meets the chains as ``exp(j s t)``,

        (k1 + j s k2 - s^2 k3 - j s^3) e = (k3 + j s + j w) d1 h + j eta1 d2 h + dv

    with h = j exp(j w t). For a saturation K is that of the boundary layer. For the sign function within its bounds
    what remains is the unmatched part, (c1 + j s c2 - s^2 c3) e = c3 d1 h. None where this doesn't apply: for laws of
    another kind, noise, hardware, parameter errors, a set point, or signals that begin or end in the last quarter.
    """
    p = planned.parameters
    ideal = replace(planned.loop.hardware, noisy=False, matched=False) == IDEAL
    if not law.in_family or not ideal or planned.noise or not disturbed(planned):
        return None
    if p["radius"] == 0.0 or planned.is_uncertain:
        return None
    waves = {name: _waves(planned, name) for name in DISTURBANCES}
    if any(one is None for one in waves.values()):
        return None
    w, surface = p["rate"], [p[f"C[{k}]"] for k in (1, 2, 3)]
    layer = law.kind == "saturation"
    gain = boundary_layer_gain(surface, p["Q"], p["P"], p["phi"]) if layer else sliding_gain(surface, p["Q"])
    heading = 1j * cmath.exp(1j * p["phase"])
    parts: dict[float, complex] = defaultdict(complex)
    for name, found in waves.items():
        turning = name.startswith("d[")
        for wave in found or ():
            s = round(wave.frequency + (w if turning else 0.0), 9)
            left = gain[0] + 1j * s * gain[1] - s**2 * gain[2] - 1j * s**3
            right = {
                "d[1]": (gain[2] + 1j * s + 1j * w) * heading,
                "d[2]": 1j * p["radius"] * w * heading,
                "dv[1]": 1.0,
                "dv[2]": 1j,
            }[name]
            if law.kind == "sign":
                left = surface[0] + 1j * s * surface[1] - s**2 * surface[2]
                right = surface[2] * heading if name == "d[1]" else 0.0
            parts[s] += right * wave.phasor / left
    return math.sqrt(sum(abs(one) ** 2 for one in parts.values()))


def predicted_noise(planned: PlannedRun, law: Law) -> float | None:
    """Root mean square of the position error that noise of x and y leaves under pole placement, m; else None.

    Each axis is the chain e' = (A - B K) e - B k1 n with n white and held for a period: the discrete Lyapunov
    equation gives its covariance at the instants of the noise. It is that of all runs, from which one run differs.
    """
    p, noise = planned.parameters, planned.noise
    undisturbed = not disturbed(planned) and not planned.is_uncertain
    bare = replace(planned.loop.hardware, noisy=False, matched=False) == IDEAL
    if law.kind != "linear" or not noise or set(noise) - {"n[1]", "n[2]"} or not undisturbed or not bare:
        return None
    gain = sliding_gain([p[f"C[{k}]"] for k in (1, 2, 3)], p["Q"])
    system = np.zeros((4, 4))
    system[:3, :3] = np.eye(3, k=1)
    system[2] = [*(-gain), -gain[0]]
    held = expm(system * planned.noise_period)
    covariance = solve_discrete_lyapunov(held[:3, :3], np.outer(held[:3, 3], held[:3, 3]))
    return float(math.sqrt(covariance[0, 0] * sum(one**2 for one in noise.values())))


def _waves(planned: PlannedRun, name: str) -> tuple[Wave, ...] | None:
    """Parts of a disturbance in the last quarter; None if it changes its form within."""
    first, last = TAIL * planned.duration, planned.duration
    found = [Wave(0.0, complex(planned.inputs.get(name, 0.0)))]
    for signal in planned.signals:
        if name not in signal.amplitudes:
            continue
        end = signal.start_s + signal.width_s if signal.width_s is not None else signal.stop_s or math.inf
        if end <= first or signal.start_s >= last:
            continue
        if signal.start_s > first or end < last:
            return None
        found += _parts(signal.amplitudes[name], signal.angular_frequency_rad_per_s, signal.phase_rad, signal.start_s)
    return tuple(one for one in found if one.phasor)


def _parts(amplitude: float, frequency: float | None, phase: float, start: float) -> Iterator[Wave]:
    if frequency is None:
        yield Wave(0.0, complex(amplitude))
        return
    turn = cmath.exp(1j * (phase - frequency * start))
    yield Wave(frequency, amplitude * turn / 2j)
    yield Wave(-frequency, -amplitude * turn.conjugate() / 2j)


def within_bounds(run: Run) -> bool:
    """Whether P rejects the disturbances of a run in its last quarter: their shares of the bounds sum to below 1.

    The bounds are taken at the largest speed and yaw rate of that quarter, and at the largest magnitude of each
    disturbance; without disturbance the answer is yes. They hold for disturbances that vary as well: with z'' computed
    from the model no derivative of d1 enters S'.
    """
    p, peaks = run.planned.parameters, tail_peaks(run.planned)
    if not any(peaks.values()):
        return True
    if run.facts is None or not p.get("P"):
        return False
    surface = [p[f"C[{k}]"] for k in (1, 2, 3)]
    forward = forward_disturbance_bound(surface, p["P"], run.facts.tail_turning)
    yaw = yaw_disturbance_bound(surface, p["P"], run.facts.tail_fastest)
    direct = max(peaks["dv[1]"], peaks["dv[2]"]) / matched_disturbance_bound(surface, p["P"])
    return peaks["d[1]"] / forward + peaks["d[2]"] / yaw + direct < 1.0
