"""The scenarios take every transition of the supervisor, and both engines do the same at each and between them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest
from rest_to_rest_scenarios import SCENARIOS, STEP, Scenario, compared, driven

import brunovsky as br
from brunovsky.blocks import Block, NumpyEngine
from brunovsky.native import NativeEngine

GROUPS = ("states", "samples", "modes")


CAUSES = {"off", "turned_away", "goal_moved", "goal_turned"}
"""Relations that make it give up a leg."""


def last(name: str) -> str:
    """Name within its component."""
    return name.rpartition(".")[2]


class Observed(NumpyEngine):
    """The readable engine, which notes the transitions that it takes and why it gives up."""

    def __init__(self, block: Block) -> None:
        super().__init__(block, STEP)
        self.taken: set[str] = set()
        self.causes: set[str] = set()

    def _run_transitions(self) -> bool:
        guards = zip(self.block.transitions, self._guards(), strict=True)
        now = [last(one.name) for one, holds in guards if holds]
        if "give_up" in now:
            relations = zip(self.block.relations, self.relations, strict=True)
            self.causes |= {last(one.name) for one, holds in relations if holds} & CAUSES
        self.taken |= set(now)
        return super()._run_transitions()


class Engine:
    """Either engine as a target of a scenario."""

    def __init__(self, engine: NativeEngine | NumpyEngine, scenario: Scenario) -> None:
        self.engine = engine
        engine.reset()
        engine.set_parameters(scenario.start)
        self._begin()

    def _begin(self) -> None:
        self.engine.initialize()

    def set_parameters(self, values: Mapping[str, float]) -> None:
        self.engine.set_parameters(values)

    def set_inputs(self, values: Mapping[str, float]) -> None:
        names = [one.name for one in self.engine.block.inputs]
        for name, value in values.items():
            self.engine.inputs[names.index(name)] = value

    def step(self) -> None:
        self.engine.advance(STEP)

    def outputs(self) -> list[float]:
        return self.engine.outputs()


class Followed(Engine):
    """Compiled code whose events are gone through again by the readable engine, wherever they change something."""

    def __init__(self, engine: NativeEngine, plain: Observed, scenario: Scenario) -> None:
        self.plain = plain
        super().__init__(engine, scenario)

    def _begin(self) -> None:
        self.plain.reset()
        self.plain.parameters = self.engine.parameters.copy()
        self.plain.initialize()
        self.engine.initialize()
        self._same()

    def step(self) -> None:
        before = {group: getattr(self.engine, group).copy() for group in GROUPS}
        self.engine.event()
        if any((before[group] != getattr(self.engine, group)).any() for group in GROUPS):
            for group in ("inputs", "parameters"):
                setattr(self.plain, group, getattr(self.engine, group).copy())
            for group in GROUPS:
                setattr(self.plain, group, before[group])
            self.plain.time = self.engine.time
            self.plain.event()
            self._same()
        super().step()

    def _same(self) -> None:
        for group in GROUPS:
            np.testing.assert_allclose(getattr(self.engine, group), getattr(self.plain, group), rtol=1e-9, atol=1e-9)


@pytest.fixture(scope="module")
def loop() -> Block:
    return br.blocks.rest_to_rest()


@pytest.fixture(scope="module")
def plain(loop: Block) -> Observed:
    return Observed(loop)


def test_the_scenarios_take_every_transition_and_the_engines_agree_at_each(loop: Block, plain: Observed) -> None:
    native = NativeEngine(loop, STEP)
    for scenario in SCENARIOS.values():
        for outputs in driven(Followed(native, plain, scenario), scenario):
            assert np.isfinite(outputs).all()
    assert {last(one.name) for one in loop.transitions} - plain.taken == set()
    assert plain.causes == CAUSES


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENARIOS)
def test_the_engines_agree_all_along(loop: Block, plain: Observed, name: str) -> None:
    scenario = SCENARIOS[name]
    native, slow = (
        np.array(list(driven(Engine(one, scenario), scenario))) for one in (NativeEngine(loop, STEP), plain)
    )
    compared(slow, native, 1e-9)
