"""Every transition of the supervisor is taken, and both engines take the same ones."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pytest
import xarray as xr

import brunovsky as br
from brunovsky.blocks import Block

SEEN = ["x", "y", "theta", "eta[1]", "eta[2]", "u[1]", "u[2]", "mode", "regulator.supervisor.leg",
        "regulator.supervisor.choice"]  # fmt: skip
Inputs = Mapping[str, Callable[[float], float]]
PATHS, TURNS = {1, 2, 3, 4}, {7, 8}  # manoeuvres by number; 5 and 6 are reversals
SCENARIOS: dict[str, tuple[dict[str, float], Inputs, set[int], set[int]]] = {
    # parameters, inputs, modes passed, manoeuvres that may be chosen; no instant of a plan falls on a step, where
    # rounding decides which of two steps has it
    "moving at the start": ({"y_start": -0.5, "eta_start[1]": 0.6173}, {}, {0, 1, 2}, {0, *PATHS}),
    "another heading": ({"theta_start": 1.0}, {}, {0, 1}, {0}),
    "turn and drive": ({"x_start": 0.3, "y_start": 0.1, "theta_start": 2.5}, {}, {0, 1}, PATHS | TURNS),
    "pushed": ({"y_start": -3.0}, {"d[2]": lambda t: 25.0 if 1.0 <= t < 1.4 else 0.0}, {0, 1, 2}, {*range(1, 9)}),
    "pushed at rest": ({}, {"d[1]": lambda t: 3.0 if t < 0.1 else 0.0}, {0, 2}, {0}),
}  # fmt: skip


def run(loop: Block, name: str, engine: str) -> xr.Dataset:
    values, inputs, _, _ = SCENARIOS[name]
    parameters = {"goal[1]": 0.0, "goal[2]": 0.0} | values
    return br.simulate(loop, 3.5, parameters=parameters, inputs=inputs, record=SEEN, engine=engine)


@pytest.fixture(scope="module")
def loop() -> Block:
    return br.blocks.rest_to_rest()


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENARIOS)
def test_both_engines_take_the_same_transitions(loop: Block, name: str) -> None:
    native, plain = run(loop, name, "native"), run(loop, name, "numpy")
    _, _, modes, choices = SCENARIOS[name]
    assert {int(one) for one in native["mode"].values} == modes
    assert {int(one) for one in native["regulator.supervisor.choice"].values} <= choices
    for one in SEEN:
        np.testing.assert_allclose(native[one], plain[one], rtol=1e-6, atol=1e-8)
