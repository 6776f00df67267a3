"""Blocks made from plants of the literature: between v and the outputs each is a set of integrator chains."""

from collections.abc import Mapping

import numpy as np
import pytest
from gallery_blocks import GALLERY, expected_chains, gallery_block, random_start, regular_part

import brunovsky as br
from brunovsky.blocks import Block


def check_chains(name: str, block: Block, values: dict[str, float], inputs: Mapping[str, float]) -> None:
    """Values: of states and parameters; the former are starts."""
    declared = {one.name for one in block.parameters}
    parameters = {one if one in declared else f"{one}_start": value for one, value in values.items()}
    run = regular_part(name, br.simulate(block, 0.3, step_size=1e-3, parameters=parameters, inputs=inputs))
    assert len(run["time"]) > 100
    assert not run["singular"].any()
    for variable, wanted in expected_chains(name, run, inputs).items():
        error = np.max(np.abs(run[variable].values - wanted)) / np.max(np.abs(wanted))
        assert error < 1e-6, variable


@pytest.mark.parametrize("name", GALLERY)
def test_chains_of_the_block_integrate_v(name: str) -> None:
    block, inputs = gallery_block(name)
    check_chains(name, block, random_start(name, seed=0)[0], inputs)


@pytest.mark.slow
@pytest.mark.parametrize("name", GALLERY)
def test_chains_of_the_block_integrate_v_from_other_starts_with_other_parameters(name: str) -> None:
    block, _ = gallery_block(name)
    for seed in range(1, 21):
        check_chains(name, block, *random_start(name, seed))


@pytest.mark.parametrize("name", GALLERY)
def test_both_engines_agree_on_the_block(name: str) -> None:
    block, inputs = gallery_block(name)
    native, plain = (br.simulate(block, 0.02, inputs=inputs, engine=engine) for engine in ("native", "numpy"))
    assert set(native) == set(plain)
    for variable in plain:
        np.testing.assert_allclose(native[variable], plain[variable], rtol=1e-11, atol=1e-12, err_msg=variable)
