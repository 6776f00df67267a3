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
