"""What acts on a run beyond its start and reference, in words: disturbances, noise, parameter errors, hardware."""

from __future__ import annotations

import math

from brunovsky.comparison.facts import given, joined
from brunovsky.comparison.residuals import DISTURBANCES
from brunovsky.comparison.study import PlannedRun, Signal
from brunovsky.comparison.study.signals import NOISE_INPUTS

_MEASURED = {"x_m": ("x", "m"), "y_m": ("y", "m"), "theta_rad": ("θ", "rad")} | {
    "eta_1_m_per_s": ("η₁", "m/s"),
    "eta_2_rad_per_s": ("η₂", "rad/s"),
}


def what_acts(planned: PlannedRun) -> list[str]:
    """One phrase for each disturbance, noise, parameter error and imperfection of the hardware."""
    constant = [
        f"{symbol} = {given(planned.inputs[name])} {unit}"
        for name, (symbol, unit) in DISTURBANCES.items()
        if planned.inputs.get(name)
    ]
    rho = {f"ρ{'₁₂'[k]}": planned.parameters.get(f"rho[{k + 1}]", 1.0) for k in (0, 1)}
    errors = [f"{symbol} = {given(value)}" for symbol, value in rho.items() if value != 1.0]
    return [*constant, *map(_signal, planned.signals), *errors, *_noise(planned), *_hardware(planned)]


def _signal(signal: Signal) -> str:
    sizes = joined(
        [
            f"{given(value)} {DISTURBANCES[name][1]} in {DISTURBANCES[name][0]}"
            for name, value in signal.amplitudes.items()
        ]
    )
    when = f"from {given(signal.start_s)} s on" if signal.stop_s is None else ""
    when = when or f"from {given(signal.start_s)} s to {given(signal.stop_s or 0.0)} s"
    if signal.kind == "impulse":
        return f"an impulse of {sizes} over {given(1e3 * (signal.width_s or 0.0))} ms at {given(signal.start_s)} s"
    if signal.kind == "sine":
        return f"a sine of {sizes} at {given(signal.angular_frequency_rad_per_s or 0.0)} rad/s {when}"
    return f"a step of {sizes} {when}"


def _noise(planned: PlannedRun) -> list[str]:
    names = {f"n[{k}]": _MEASURED[key] for key, k in NOISE_INPUTS.items()}
    found = [
        f"{names[key][0]} ({given(deviation)} {names[key][1]})" for key, deviation in planned.noise.items() if deviation
    ]
    if not found:
        return []
    return [f"white noise of standard deviation on {joined(found)}, each value held {_ms(planned.noise_period)}"]


def _hardware(planned: PlannedRun) -> list[str]:
    one = planned.loop.hardware
    found = []
    if any(one.lags):
        count = "a lag" if one.number == 1 else f"{one.number} lags each"
        found.append(f"{count} of {_pair(one.lags)} behind u₁ and u₂")
    if any(one.delays):
        found.append(f"a delay of {_pair(one.delays)} behind u₁ and u₂")
    for symbol, unit, limit in zip(("u₁", "u₂"), ("m/s²", "rad/s²"), one.limits, strict=True):
        if limit < math.inf:
            found.append(f"|{symbol}| ≤ {given(limit)} {unit}")
    if one.period is not None:
        found.append(f"sampling every {_ms(one.period)}")
    return found


def _pair(seconds: tuple[float, float]) -> str:
    return _ms(seconds[0]) if seconds[0] == seconds[1] else f"{_ms(seconds[0])} and {_ms(seconds[1])}"


def _ms(seconds: float) -> str:
    return f"{given(1e3 * seconds)} ms"
