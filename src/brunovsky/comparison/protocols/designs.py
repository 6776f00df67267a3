"""Designs that a law is tried at: values of its knobs, spread evenly over the logarithms of their ranges."""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping

import numpy as np
from scipy.stats import qmc

from brunovsky.comparison.protocols.evaluation import check_range

Space = Mapping[str, tuple[float, float]]
"""Knobs with their ranges."""


def designs(space: Space, budget: int, seed: int, law: str) -> list[dict[str, float]]:
    """Values of the knobs for each design of a law: a scrambled Sobol sequence over the logarithms of their ranges."""
    if not space:
        return [{}]
    for name, (low, high) in space.items():
        check_range("pareto", name, low, high)
    rng = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(zlib.crc32(law.encode()),)))
    unit_cube = qmc.Sobol(len(space), scramble=True, seed=rng).random(budget)
    ends = [(math.log(low), math.log(high)) for low, high in space.values()]
    return [
        {name: math.exp(a + share * (b - a)) for name, share, (a, b) in zip(space, row, ends, strict=True)}
        for row in unit_cube
    ]
