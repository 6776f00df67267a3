"""Every outer loop regulates and tracks, on the robot and on a chain of three integrators, the same in both engines."""

import numpy as np
import pytest
from outer_loop_cases import LOOPS, REGULATION, B, chain_loop, chain_plant

import brunovsky as br
from brunovsky.blocks import Chains

IN_CI = (
    "LQR, integral",
    "constant rate",
    "relay",
    "integral sliding mode",
    "disturbance observer",
    "super-twisting, sampled",
)


@pytest.mark.parametrize("name", LOOPS)
def test_on_a_chain_of_three_integrators(name: str) -> None:
    loop = chain_loop(LOOPS[name](chain_plant()))
    for parameters in ({}, {"amplitude": 0.5}):
        data = br.simulate(loop, 8.0, parameters=parameters, record=["e1[1]", "v[1]"])
        assert abs(data["e1[1]"][0]) == pytest.approx(1.0)
        assert abs(data["e1[1]"][-1000:]).max() < 1e-3
        assert np.isfinite(data["v[1]"]).all()


@pytest.mark.parametrize("name", LOOPS)
def test_engines_agree(name: str) -> None:
    loop = chain_loop(LOOPS[name](chain_plant()))
    options = {"parameters": {"amplitude": 0.5}, "inputs": {"d": lambda t: np.sin(7 * t)}, "step_size": 2e-3}
    native, numpy = (br.simulate(loop, 1.0, engine=engine, **options) for engine in ("native", "numpy"))
    for one in native:
        scale = 1e-9 + abs(numpy[one].astype(float)).max()
        assert abs(native[one].astype(float) - numpy[one].astype(float)).max() / scale < 1e-9, one


@pytest.mark.parametrize("name", [one if one in IN_CI else pytest.param(one, marks=pytest.mark.slow) for one in LOOPS])
def test_on_the_robot(name: str) -> None:
    loop = B.closed_loop(LOOPS[name](B.linearized_robot()))
    for parameters in ({}, REGULATION):
        data = br.simulate(loop, 8.0, parameters=parameters, record=["e1[1]", "e2[1]"])
        error = np.hypot(data["e1[1]"], data["e2[1]"])
        assert error[0] > 1.0
        assert error[-1000:].max() < 2e-3


@pytest.mark.parametrize("law", ["sliding_mode", "sliding_mode_relay", "integral_sliding_mode", "disturbance_observer"])
def test_unlike_chains_have_parameters_of_their_own(law: str) -> None:
    chains = Chains((4, 2, 1), ("m", "rad", "V"))
    block = getattr(B, law)(chains, [[24.0, 50.0, 35.0, 10.0], [6.0, 5.0], [3.0]])
    stem = "C" if law.startswith("sliding") else "K"
    names = [one.name for one in block.parameters]
    assert names[:7] == [*(f"{stem}1[{k}]" for k in (1, 2, 3, 4)), f"{stem}2[1]", f"{stem}2[2]", f"{stem}3[1]"]
    assert all(one.endswith(("[1]", "[2]", "[3]")) for one in names[7:])
    assert [one.name for one in block.outputs][:3] == ["v[1]", "v[2]", "v[3]"]


def test_the_default_instances_keep_the_contract() -> None:
    sliding, linear = B.sliding_mode(), B.pole_placement()
    assert [(one.name, one.unit, one.value) for one in sliding.parameters] == [
        ("C[1]", "1/s2", 500), ("C[2]", "1/s", 10), ("C[3]", "1", 1), ("Q", "1/s", 5), ("P", "m/s3", 2.5),
        ("phi", "m/s2", 0.05),
    ]  # fmt: skip
    assert [(one.name, one.unit, one.value) for one in linear.parameters] == [
        ("K[1]", "1/s3", 2500), ("K[2]", "1/s2", 550), ("K[3]", "1/s", 15),
    ]  # fmt: skip
    assert [one.name for one in sliding.outputs] == ["v[1]", "v[2]", "S[1]", "S[2]"]
    assert [one.name for one in linear.outputs] == ["v[1]", "v[2]"]
