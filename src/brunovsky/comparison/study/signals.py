"""What varies in time in a scenario: disturbances and measurement noise, as inputs that are held over each step."""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import AfterValidator, Field, FiniteFloat, PlainSerializer, model_validator

from brunovsky.comparison.study.keys import input_keys
from brunovsky.comparison.study.table import StudyTable, by_name, in_range, known_key

Array = np.ndarray[Any, np.dtype[np.float64]]
INSTANT = 1e-9  # s; rounding of the instants at which a signal begins and ends
NOISE_INPUTS = {"x_m": 1, "y_m": 2, "theta_rad": 3, "eta_1_m_per_s": 4, "eta_2_rad_per_s": 5}


def disturbance_key(text: str) -> str:
    """A key of a disturbance, or ValueError."""
    return known_key(text, input_keys(), "disturbance or unit")


DisturbanceTable = Annotated[
    Mapping[Annotated[str, AfterValidator(disturbance_key)], FiniteFloat],
    AfterValidator(in_range),
    PlainSerializer(dict),
]
Instant = Annotated[FiniteFloat, Field(ge=0.0)]
Deviation = Annotated[FiniteFloat, Field(ge=0.0)]


class Signal(StudyTable):
    """A disturbance that varies: a step, a sine or an impulse, with an amplitude for each input it acts on.

    It acts from ``start_s`` to ``stop_s``, or to the end. A sine is ``amplitude sin(w (t - start) + phase)``, an
    impulse the constant ``amplitude`` over ``width_s``, so that amplitude times width is its area.
    """

    kind: Literal["step", "sine", "impulse"]
    amplitude: DisturbanceTable = Field(min_length=1)
    start_s: Instant = 0.0
    stop_s: Instant | None = None
    width_s: Annotated[FiniteFloat, Field(gt=0.0)] | None = None
    angular_frequency_rad_per_s: Annotated[FiniteFloat, Field(gt=0.0)] | None = None
    phase_rad: FiniteFloat = 0.0

    @model_validator(mode="after")
    def _check_kind(self) -> Signal:
        if (self.kind == "sine") != (self.angular_frequency_rad_per_s is not None):
            raise ValueError("angular_frequency_rad_per_s belongs to a sine, and a sine needs it")
        if (self.kind == "impulse") != (self.width_s is not None):
            raise ValueError("width_s belongs to an impulse, and an impulse needs it")
        if self.kind != "sine" and self.phase_rad:
            raise ValueError("phase_rad belongs to a sine; remove it, or choose kind 'sine'")
        if self.kind == "impulse" and self.stop_s is not None:
            raise ValueError("an impulse ends after width_s; remove stop_s")
        if self.stop_s is not None and self.stop_s <= self.start_s:
            raise ValueError(f"stop_s = {self.stop_s:g} must be after start_s = {self.start_s:g}")
        return self

    @property
    def amplitudes(self) -> dict[str, float]:
        """Amplitude by the name of the input."""
        return by_name(self.amplitude, input_keys())

    def shape(self, time: Array) -> Array:
        """The signal at amplitude 1, at each instant (s)."""
        end = self.start_s + self.width_s if self.width_s is not None else self.stop_s
        active = time >= self.start_s - INSTANT
        if end is not None:
            active &= time < end - INSTANT
        if self.kind != "sine":
            return active.astype(float)
        assert self.angular_frequency_rad_per_s is not None
        wave = np.sin(self.angular_frequency_rad_per_s * (time - self.start_s) + self.phase_rad)
        return np.asarray(np.where(active, wave, 0.0))


class Noise(StudyTable):
    """Gaussian measurement noise by standard deviations; values are held for ``period_s``, by default the study's step.

    It is white from sample to sample, so that its power per frequency grows with the period at equal deviation.
    """

    x_m: Deviation = 0.0
    y_m: Deviation = 0.0
    theta_rad: Deviation = 0.0
    eta_1_m_per_s: Deviation = 0.0
    eta_2_rad_per_s: Deviation = 0.0
    period_s: Annotated[FiniteFloat, Field(gt=0.0)] | None = None

    @property
    def deviations(self) -> dict[str, float]:
        """Standard deviation of each noise input ``n[i]`` that is not zero."""
        return {f"n[{i}]": getattr(self, name) for name, i in NOISE_INPUTS.items() if getattr(self, name)}

    @property
    def acts(self) -> bool:
        """Whether there is any."""
        return bool(self.deviations)


NO_NOISE = Noise()


def noise_series(
    deviations: Mapping[str, float], period: float, seed: tuple[int, ...], time: Array
) -> dict[str, Array]:
    """Noise of each input at each instant (s): the same for equal seeds, whatever the step and the law.

    The k-th value holds from ``k period`` on. Every input has a stream of its own, so that adding one changes no other.
    """
    index = np.floor(time / period + 1e-6).astype(int)
    found = {}
    for name, deviation in deviations.items():
        stream = np.random.default_rng([*seed, int(name[2:-1])])
        found[name] = deviation * stream.standard_normal(int(index[-1]) + 1)[index]
    return found


def seed_of(study: int, name: str) -> tuple[int, int]:
    """Seed of a scenario: that of the study and the scenario's name, so that the order doesn't matter."""
    return study, zlib.crc32(name.encode())
