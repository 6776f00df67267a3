"""What a scenario says of sensors and actuators."""

from __future__ import annotations

import math
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, FiniteFloat, model_validator

from brunovsky.comparison.study.loops import Hardware
from brunovsky.comparison.study.table import StudyTable


def _pair(value: Any) -> Any:
    """One number holds for both commands."""
    return value if isinstance(value, list | tuple) else (value, value)


NotNegative = Annotated[FiniteFloat, Field(ge=0.0)]
Pair = Annotated[tuple[NotNegative, NotNegative], BeforeValidator(_pair), Field(strict=False)]
Positive = Annotated[FiniteFloat, Field(gt=0.0)]


class HardwareTable(StudyTable):
    """Actuators that lag, delay and saturate, and sampling; what isn't given is ideal.

    ``lag_s`` and ``delay_s`` are one number, or two for u1 and u2; ``lags`` is how many equal lags each command has.
    """

    lag_s: Pair = (0.0, 0.0)
    lags: Annotated[int, Field(ge=1, le=4)] = 1
    delay_s: Pair = (0.0, 0.0)
    u1_max_m_per_s2: Positive | None = None
    u2_max_rad_per_s2: Positive | None = None
    sampling_period_s: Positive | None = None

    @model_validator(mode="after")
    def _check_lags(self) -> HardwareTable:
        if self.lags > 1 and not any(self.lag_s):
            raise ValueError("lags counts the lags of lag_s, which is 0; give lag_s")
        return self

    def resolved(self, *, noisy: bool, matched: bool) -> Hardware:
        """Hardware of a loop, with the inputs that noise and matched disturbances need."""
        limits = (self.u1_max_m_per_s2 or math.inf, self.u2_max_rad_per_s2 or math.inf)
        return Hardware(self.lag_s, self.lags, self.delay_s, limits, self.sampling_period_s, noisy, matched)


NO_HARDWARE = HardwareTable()
