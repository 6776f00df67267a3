"""Short scenarios that make the supervisor from rest to rest take each of its transitions, for every target."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

STEP = 1e-3


@dataclass(frozen=True)
class Scenario:
    """What is driven: ``start`` and later ``changes`` (by time, s) of parameters; ``push``: input, begin, end, value.

    No end of a leg falls on a step, where rounding decides which of two steps has it.
    """

    duration: float
    start: Mapping[str, float]
    changes: Mapping[float, Mapping[str, float]] = field(default_factory=dict)
    push: tuple[str, float, float, float] | None = None


def at(x: float, y: float, theta: float, heading: float, **others: float) -> dict[str, float]:
    """Parameters of a pose from which to drive to the origin."""
    pose = {"x_start": x, "y_start": y, "theta_start": theta, "goal_heading": heading}
    return {"goal[1]": 0.0, "goal[2]": 0.0} | pose | others


AHEAD = at(0.0, -0.5, 0.0, 0.0)
SCENARIOS = {
    "forward": Scenario(1.3, at(0.0, -0.1, 0.0, 0.0)),
    "forward, wide": Scenario(0.05, at(-0.5, -0.6, 0.5, -1.9)),
    "backward": Scenario(0.05, at(0.0, 0.1, 0.0, 0.0)),
    "backward, wide": Scenario(0.05, at(-0.6, 0.4, 2.2, -0.2)),
    "reversal, forward first": Scenario(0.05, at(0.9, 0.38, 1.66, -1.54)),
    "reversal, backward first": Scenario(0.05, at(0.62, 2.01, -0.19, 2.24)),
    "turn, then forward": Scenario(0.4, at(-0.1, -0.4, -0.4, -2.8)),
    "turn, then backward": Scenario(0.4, at(0.1, -0.5, -3.0, -0.1)),
    "another heading": Scenario(1.2, at(0.0, 0.0, 0.4, 1.0)),
    "goal moves": Scenario(1.5, AHEAD, {0.2: {"goal[2]": 1.0}}),
    "goal turns": Scenario(1.2, AHEAD, {0.3: {"goal_heading": 0.5}}),
    "new goal at rest": Scenario(0.2, at(0.0, 0.0, 0.0, 0.0), {0.1: {"goal[1]": 0.3}}),
    "moving at the start": Scenario(1.5, AHEAD | {"eta_start[1]": 0.6173, "eta_start[2]": 1.0}),
    "pushed off the path": Scenario(0.9, AHEAD, push=("d[1]", 0.3, 0.5, 40.0)),
    "turned off the path": Scenario(0.9, AHEAD, push=("d[2]", 0.3, 0.6, 400.0)),
    "pushed at the end of a turn": Scenario(0.9, at(0.0, 0.0, 0.4, 1.0), push=("d[2]", 0.3, 0.42, 15.0)),
    "pushed at rest": Scenario(0.5, at(0.0, 0.0, 0.0, 0.0), push=("d[1]", 0.0, 0.1, 3.0)),
}


class Target(Protocol):
    """What runs the block: set parameters and inputs, make a step, read all outputs."""

    def set_parameters(self, values: Mapping[str, float]) -> None: ...

    def set_inputs(self, values: Mapping[str, float]) -> None: ...

    def step(self) -> None: ...

    def outputs(self) -> list[float]: ...


def driven(target: Target, scenario: Scenario) -> Iterator[list[float]]:
    """Outputs after each step of an initialised target, before the events of the next one."""
    changes = {round(time / STEP): values for time, values in scenario.changes.items()}
    for k in range(round(scenario.duration / STEP)):
        if k in changes:
            target.set_parameters(changes[k])
        if scenario.push:
            name, begin, end, value = scenario.push
            target.set_inputs({name: value if round(begin / STEP) <= k < round(end / STEP) else 0.0})
        target.step()
        yield target.outputs()


def compared(found: np.ndarray, expected: np.ndarray, tolerance: float) -> None:
    """Each output within a part of 1 plus its size."""
    apart = np.abs(found - expected) / (1.0 + np.abs(expected))
    assert found.shape == expected.shape and apart.max() <= tolerance, np.unravel_index(apart.argmax(), apart.shape)
