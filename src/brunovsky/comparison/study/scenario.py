"""The tasks of a study."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, FiniteFloat, PlainSerializer, ValidationInfo, model_validator

from brunovsky._frozen import FrozenMapping
from brunovsky.comparison.study.hardware import NO_HARDWARE, HardwareTable
from brunovsky.comparison.study.keys import kinds_of, known_parameter
from brunovsky.comparison.study.law import SWITCHING, Name
from brunovsky.comparison.study.loops import Hardware
from brunovsky.comparison.study.signals import NO_NOISE, DisturbanceTable, Noise, Signal
from brunovsky.comparison.study.table import StudyTable, in_range


def _scenario_parameter(text: str, info: ValidationInfo) -> str:
    if known_parameter(text, kinds_of(info)).variable.name in SWITCHING:
        raise ValueError("belongs to a law, so that laws differ in nothing else; move it to a [[laws]] table")
    return text


ScenarioTable = Annotated[
    Mapping[Annotated[str, AfterValidator(_scenario_parameter)], FiniteFloat],
    AfterValidator(in_range),
    PlainSerializer(dict),
]


class Scenario(StudyTable):
    """One task for the robot: start, reference, disturbances, hardware and duration, run under several laws."""

    name: Name
    title: str
    about: str = ""
    figure: Literal["4", "5", "6"] | None = None
    duration_s: Annotated[FiniteFloat, Field(gt=0.0)]
    laws: tuple[str, ...] | None = Field(default=None, strict=False)
    parameters: ScenarioTable = Field(default_factory=lambda: FrozenMapping({}))
    disturbances: DisturbanceTable = Field(default_factory=lambda: FrozenMapping({}))
    signals: tuple[Signal, ...] = Field(default=(), strict=False)
    noise: Noise = NO_NOISE
    hardware: HardwareTable = NO_HARDWARE

    @model_validator(mode="after")
    def _check_signals(self) -> Scenario:
        for k, one in enumerate(self.signals, 1):
            if one.start_s >= self.duration_s:
                raise ValueError(
                    f"signals[{k}] begins at {one.start_s:g} s, when the run of {self.duration_s:g} s has ended; "
                    "give an earlier start_s or a longer duration_s"
                )
        return self

    @property
    def resolved_hardware(self) -> Hardware:
        """Hardware around the law, with the inputs that noise and matched disturbances need."""
        keys = {key for table in (self.disturbances, *(one.amplitude for one in self.signals)) for key in table}
        return self.hardware.resolved(noisy=self.noise.acts, matched=any(key.startswith("dv_") for key in keys))
