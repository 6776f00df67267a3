"""Which communication steps a study can be run with."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from brunovsky.blocks.engine import step_count
from brunovsky.comparison.study.scenario import Scenario

MOST_EXCHANGES = 2e6  # of one run


class Coupled(Protocol):
    """What is asked of a study."""

    step_size_s: float

    @property
    def scenarios(self) -> Sequence[Scenario]:
        """Its tasks."""

    @property
    def communication_step(self) -> float:
        """In s."""


def check_communication(study: Coupled) -> None:
    """Refuse communication points that are no instants of the native simulation, or that miss what the inputs do.

    Raises
    ------
    ValueError
        With the scenario and the remedy.
    """
    step = study.communication_step
    for scenario in study.scenarios:
        place = f"scenario '{scenario.name}': communication_step_s = {step:g}"
        if scenario.duration_s > MOST_EXCHANGES * step:
            raise ValueError(f"{place} is under a {MOST_EXCHANGES:g}th of duration_s; lengthen it")
        steps, exchanges = (step_count(scenario.duration_s, one) for one in (study.step_size_s, step))
        if steps % exchanges and exchanges % steps:
            raise ValueError(
                f"{place} cuts the {scenario.duration_s:g} s into {exchanges} steps and step_size_s into {steps}; "
                "choose one that is a multiple or a fraction of step_size_s and divides the duration"
            )
        held = scenario.noise.period_s or study.step_size_s
        if scenario.noise.acts and held < step * (1 - 1e-9):
            raise ValueError(
                f"{place} is longer than the {held:g} s for which noise is held, so that samples of it would be lost; "
                "give noise.period_s, or shorten the one"
            )
        for k, signal in enumerate(scenario.signals, 1):
            if signal.width_s is not None and signal.width_s < step * (1 - 1e-9):
                raise ValueError(
                    f"{place} is longer than the impulse of signals[{k}], {signal.width_s:g} s, which it would miss or "
                    "lengthen; shorten the one or lengthen the other"
                )
