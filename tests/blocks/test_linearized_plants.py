"""Blocks made from plants of the literature: between v and the outputs each is a set of integrator chains."""

from collections.abc import Mapping

import numpy as np
import pytest
import sympy as sp
from gallery_blocks import GALLERY, expected_chains, gallery_block, linearized, random_start, regular_part

import brunovsky as br
from brunovsky.blocks import Block, Variable


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


@pytest.mark.parametrize(
    "name", [pytest.param(one, marks=[pytest.mark.slow] * (one == "quadrotor")) for one in GALLERY]
)
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


def test_factors_are_guarded_one_by_one() -> None:
    """v cos(phi - theta) vanishes in two ways; each has a limit, two indicators and keeps the other factor exact."""
    linearization = linearized("trailer")
    v, bend = sorted(linearization.singular_locus.lhs.args, key=lambda one: not one.is_Symbol)
    block = br.linearized_block(linearization, parameters={"L": 1.0}, guards={v: 0.2, -bend: 0.1})
    limits = {one.name: one.value for one in block.parameters if "_min" in one.name}
    assert sorted(limits.values()) == [0.1, 0.2] and limits["v_min"] == 0.2
    assert len(block.indicators) == 4
    slow = br.simulate(block, 1e-3, parameters={"v_start": 0.1})
    bent = br.simulate(block, 1e-3, parameters={"v_start": 1.0, "theta_start": 1.6})
    neither = br.simulate(block, 1e-3, parameters={"v_start": 1.0})
    assert slow["singular"].all() and bent["singular"].all() and not neither["singular"].any()


def test_a_guard_for_what_is_no_factor_is_refused() -> None:
    linearization = linearized("trailer")
    with pytest.raises(br.BrunovskyError, match=r"no factor of the singular locus; its factors are: .*v"):
        br.linearized_block(linearization, parameters={"L": 1.0}, guards={linearization.singular_locus.lhs: 0.1})


def test_without_a_limit_the_law_fails_at_its_singularity_and_says_so() -> None:
    block = br.linearized_block(linearized("unicycle"))
    with pytest.raises(br.BrunovskyError, match=r"singular at v = 0; start away from it or set v_min > 0"):
        br.simulate(block, 0.1)


@pytest.mark.parametrize("name", ["t", "x'", r"\theta", "Z1_1", "singular", "v_1"])
def test_a_symbol_that_cannot_be_a_variable_needs_a_label(name: str) -> None:
    state, rate, force = sp.Symbol(name, real=True), *sp.symbols("rate force", real=True)
    linearization = br.linearize(br.AffineSystem((state, rate), (force,), [rate, 0], [0, 1], (state,)))
    with pytest.raises(br.BrunovskyError, match=r"give it another one with labels="):
        br.linearized_block(linearization)
    block = br.linearized_block(linearization, labels={state: Variable("position", "m", "position")})
    assert [one.name for one in block.outputs][:2] == ["position", "rate"]
