"""Blocks made from plants of the literature: between v and the outputs each is a set of integrator chains."""

from collections.abc import Mapping

import numpy as np
import pytest
from gallery_blocks import GALLERY, expected_chains, gallery_block, random_start

import brunovsky as br
from brunovsky.blocks import Block


def check_chains(name: str, block: Block, values: Mapping[str, float], inputs: Mapping[str, float]) -> None:
    run = br.simulate(block, 0.3, step_size=1e-3, parameters=values, inputs=inputs)
    assert not run["singular"].any()
    for variable, wanted in expected_chains(name, run, inputs).items():
        error = np.max(np.abs(run[variable].values - wanted)) / np.max(np.abs(wanted))
        assert error < 1e-6, variable


@pytest.mark.parametrize("name", GALLERY)
def test_chains_of_the_block_integrate_v(name: str) -> None:
    block, inputs = gallery_block(name)
    check_chains(name, block, {}, inputs)


@pytest.mark.slow
@pytest.mark.parametrize("name", GALLERY)
def test_chains_of_the_block_integrate_v_from_other_starts_with_other_parameters(name: str) -> None:
    block, _ = gallery_block(name)
    declared = {one.name for one in block.parameters}
    for seed in range(1, 21):
        values, inputs = random_start(name, seed)
        values = {one if one in declared else f"{one}_start": value for one, value in values.items()}
        check_chains(name, block, values, inputs)


@pytest.mark.parametrize("name", GALLERY)
def test_both_engines_agree_on_the_block(name: str) -> None:
    block, inputs = gallery_block(name)
    native, plain = (br.simulate(block, 0.02, inputs=inputs, engine=engine) for engine in ("native", "numpy"))
    assert set(native) == set(plain)
    for variable in plain:
        np.testing.assert_allclose(native[variable], plain[variable], rtol=1e-11, atol=1e-12, err_msg=variable)
