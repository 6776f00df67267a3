"""Blocks made from plants of the literature: between v and the outputs each is a set of integrator chains."""

import sys
from pathlib import Path

import pytest

import brunovsky as br
from brunovsky.blocks import Parameter

sys.path.append(str(Path(__file__).parents[1] / "linearization"))
from gallery_plants import GALLERY, linearized


@pytest.mark.parametrize(
    "name", [pytest.param(one, marks=pytest.mark.slow) if one == "quadrotor" else one for one in GALLERY]
)
def test_chains_of_the_block_integrate_v(name: str) -> None:
    linearization = linearized(name)
    states = linearization.extended_system.states
    starts = {one: 0.4 + 0.07 * index for index, one in enumerate(states)}
    parameters = [
        Parameter(str(one), value=1.0 + 0.3 * index) for index, one in enumerate(linearization.system.parameters)
    ]
    block = br.linearized_block(linearization, "plant", starts=starts, parameters=parameters)
    count = len(linearization.relative_degree)
    inputs = {f"v[{i}]": 0.3 * i for i in range(1, count + 1)}
    result = br.simulate(block, 0.05, inputs=inputs)
    assert not result["singular"].any()
    for i, degree in enumerate(linearization.relative_degree, 1):
        last = result[f"Z{i}[{degree}]"].values
        assert last[-1] - last[0] == pytest.approx(0.05 * inputs[f"v[{i}]"], rel=1e-6, abs=1e-8)
        if degree > 1:
            below = result[f"Z{i}[{degree - 1}]"].values
            exact = below[0] + 0.05 * last[0] + 0.05**2 / 2 * inputs[f"v[{i}]"]
            assert below[-1] == pytest.approx(exact, rel=1e-6, abs=1e-8)
