"""What is drawn for each case of a Monte-Carlo study: the same under every law, whatever laws there are."""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from brunovsky.comparison.facts import given
from brunovsky.errors import ParameterError

_NOISE = zlib.crc32(b"noise")


@dataclass(frozen=True)
class Distribution:
    """Distribution of one parameter.

    Attributes
    ----------
    kind : {"uniform", "normal", "loguniform"}
        Which one.
    first, second : float
        Its ends; for ``"normal"`` its mean and standard deviation.
    """

    kind: Literal["uniform", "normal", "loguniform"]
    first: float
    second: float

    def __post_init__(self) -> None:
        a, b = self.first, self.second
        usable = {"uniform": a < b, "normal": b > 0.0, "loguniform": 0.0 < a < b}
        if self.kind not in usable:
            raise ParameterError(f"there is no distribution {self.kind!r}; choose uniform, normal or loguniform")
        if not (math.isfinite(a) and math.isfinite(b) and usable[self.kind]):
            wanted = {"uniform": "low < high", "normal": "mean and deviation > 0", "loguniform": "0 < low < high"}
            raise ParameterError(f"{self.kind} distribution of {a!r} and {b!r}; give finite {wanted[self.kind]}")

    def draw(self, rng: np.random.Generator) -> float:
        """One value."""
        if self.kind == "normal":
            return float(rng.normal(self.first, self.second))
        if self.kind == "uniform":
            return float(rng.uniform(self.first, self.second))
        return math.exp(rng.uniform(math.log(self.first), math.log(self.second)))

    def __str__(self) -> str:
        between = "of mean {} and standard deviation {}" if self.kind == "normal" else "between {} and {}"
        return f"{self.kind} {between.format(given(self.first), given(self.second))}"


def draw_case(distributions: Mapping[str, Distribution], seed: int, case: int) -> dict[str, float]:
    """Parameters of one case; each has its own stream, so that neither laws nor other parameters change it."""
    return {
        name: distribution.draw(np.random.default_rng(_sequence(seed, case, zlib.crc32(name.encode()))))
        for name, distribution in distributions.items()
    }


def noise_seed(seed: int, case: int) -> int:
    """Seed of the noise of one case, the same under every law."""
    return int(_sequence(seed, case, _NOISE).generate_state(1, np.uint64)[0] >> np.uint64(1))


def _sequence(seed: int, case: int, stream: int) -> np.random.SeedSequence:
    return np.random.SeedSequence(seed, spawn_key=(case, stream))
