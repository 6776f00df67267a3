"""Blocks of the gallery's plants at random regular starts, and what their chains must do."""

import math
import sys
from pathlib import Path

import numpy as np
import xarray as xr

import brunovsky as br
from brunovsky.blocks import Diagram, Parameter

sys.path.append(str(Path(__file__).parents[1] / "linearization"))
from gallery_plants import GALLERY, linearized

__all__ = ["GALLERY", "expected_chains", "gallery_block", "linearized", "random_start", "regular_part"]


def random_start(name: str, seed: int) -> tuple[dict[str, float], dict[str, float]]:
    """Values of all states and parameters of a plant, away from the singular locus, and of its inputs v."""
    linearization = linearized(name)
    generator = np.random.default_rng(seed)
    states, parameters = linearization.extended_system.states, linearization.system.parameters
    while True:
        values = {one.name: float(generator.uniform(0.3, 1.2)) for one in states}
        values |= {one.name: float(generator.uniform(0.7, 1.5)) for one in parameters}
        if linearization.distance_to_singularity(values) > 0.2:
            break
    return values, {f"v[{i}]": float(generator.uniform(-1, 1)) for i in range(1, len(linearization.outer_inputs) + 1)}


def gallery_block(name: str) -> tuple[Diagram, dict[str, float]]:
    """Block of a plant, whose defaults are a random start, and inputs v."""
    linearization = linearized(name)
    values, inputs = random_start(name, seed=0)
    starts = {one: values[one.name] for one in linearization.extended_system.states}
    parameters = [Parameter(one.name, value=values[one.name]) for one in linearization.system.parameters]
    return br.linearized_block(linearization, name, starts=starts, parameters=parameters), inputs


def regular_part(name: str, run: xr.Dataset) -> xr.Dataset:
    """A run until v drives the plant so close to its singular locus that a command exceeds 100."""
    commands = [np.abs(run[one.name].values) for one in linearized(name).system.inputs]
    large = np.flatnonzero(np.max(commands, axis=0) > 100)
    return run.isel(time=slice(0, large[0])) if len(large) else run


def expected_chains(name: str, run: xr.Dataset, inputs: dict[str, float]) -> dict[str, np.ndarray]:
    """Zi[k] from its start: the Taylor polynomial of y^(r) = v, which is exact for constant v."""
    time, expected = run["time"].values, {}
    for i, degree in enumerate(linearized(name).relative_degree, 1):
        start = [float(run[f"Z{i}[{k}]"][0]) for k in range(1, degree + 1)] + [inputs[f"v[{i}]"]]
        for k in range(degree):
            terms = (one * time**order / math.factorial(order) for order, one in enumerate(start[k:]))
            expected[f"Z{i}[{k + 1}]"] = np.sum(list(terms), axis=0)
    return expected
