"""Sampled sliding mode on a clock: the law of the sampled block, bit for bit, wherever nobody drives the clock."""

import dataclasses

import numpy as np
import pytest
from outer_loop_cases import SURFACE, B, chain_loop, chain_plant

import brunovsky as br
from brunovsky.blocks import Clock, symbol
from brunovsky.errors import ModelError, ParameterError

OPTIONS = [
    {},
    {"scheme": "explicit", "surface_map": "exact"},
    {"surface_map": "exact", "preview": True, "period": 0.02},
    {"P": 20.0, "disturbance": 2.0},
]


@pytest.mark.parametrize("options", OPTIONS)
def test_it_is_the_sampled_block_with_a_clock(options: dict[str, object]) -> None:
    sampled, clocked = B.sliding_mode_sampled(**options), B.sliding_mode_clocked(**options)
    assert clocked.clocks == (Clock("sampling", "ticks where the law is sampled", symbol("sampling_period")),)
    assert [one.clock for one in clocked.samples] == ["sampling", "sampling"] and not sampled.clocks
    for key in ("inputs", "parameters", "outputs", "relations", "transitions", "checks"):
        assert getattr(clocked, key) == getattr(sampled, key)
    assert tuple(dataclasses.replace(one, clock="") for one in clocked.samples) == sampled.samples
    assert (clocked.name, clocked.description) == ("sliding_mode_clocked", f"{sampled.description}, on a clock")


@pytest.mark.parametrize("engine", ["native", "numpy"])
@pytest.mark.parametrize("options", OPTIONS)
def test_alone_it_simulates_as_the_sampled_block(options: dict[str, object], engine: str) -> None:
    sampled, clocked = B.sliding_mode_sampled(**options), B.sliding_mode_clocked(**options)
    inputs = {one.name: (lambda t, k=k: 0.1 * np.sin(3 * t + k)) for k, one in enumerate(sampled.inputs)}
    run = {"inputs": inputs, "engine": engine, "parameters": {"sampling_period": 0.013}}
    assert br.simulate(clocked, 0.2, **run).equals(br.simulate(sampled, 0.2, **run))


@pytest.mark.parametrize("solver", ["rk4", "dormand_prince"])
@pytest.mark.parametrize("engine", ["native", "numpy"])
def test_in_the_closed_loop_it_simulates_as_the_sampled_block(engine: str, solver: str) -> None:
    found = []
    for law in (B.sliding_mode_sampled, B.sliding_mode_clocked):
        loop = chain_loop(law(chain_plant(), SURFACE))
        run = {"parameters": {"amplitude": 0.5, "sampling_period": 0.015}, "inputs": {"d": lambda t: np.sin(7 * t)}}
        found.append(br.simulate(loop, 0.6, step_size=2e-3, engine=engine, solver=solver, **run))
    assert found[0].equals(found[1])
    assert len(np.unique(found[1]["v[1]"])) == 41  # at 0, 15, ..., 600 ms


def test_the_robots_loop_has_its_clock_and_the_sampled_run() -> None:
    sampled, clocked = (B.closed_loop(law()) for law in (B.sliding_mode_sampled, B.sliding_mode_clocked))
    assert [(one.name, str(one.period)) for one in clocked.clocks] == [("controller.sampling", "sampling_period")]
    assert [(one.name, one.clock) for one in clocked.samples] == [(f"v[{i}]", "controller.sampling") for i in (1, 2)]
    assert br.simulate(clocked, 1.0).equals(br.simulate(sampled, 1.0))


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"period": 0.2}, ParameterError, "sliding_mode_clocked: sampling_period is too long: on the surface"),
        ({"period": -1.0}, ParameterError, "sliding_mode_clocked: the sampling period -1.0 s is not"),
        ({"scheme": "euler"}, ModelError, "scheme"),
        ({"surface": [1.0, -2.0, 1.0]}, ParameterError, "sliding_mode_clocked: the surface"),
        ({"preview": True}, ModelError, "sliding_mode_clocked: preview gives the reference exactly"),
    ],
)
def test_refusals_name_the_block(options: dict[str, object], error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        B.sliding_mode_clocked(**options)


@pytest.mark.parametrize("law", ["sliding_mode_sampled", "sliding_mode_clocked"])
def test_warnings_point_to_who_called(law: str) -> None:
    with pytest.warns(UserWarning, match=f"{law}: sampling_period is too long: off the surface") as caught:
        getattr(B, law)(period=0.045)
    assert [one.filename for one in caught] == [__file__]
