"""The checks of a run, by name and in order, for each interface."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from brunovsky.fmi.checks import adjoints, derivatives, illegal, references, refinement, runs, states
from brunovsky.fmi.checks.subject import Answer, Subject

__all__ = ["CHECKS", "LIFE_CYCLE", "Behaviour", "Subject"]


@dataclass(frozen=True)
class Behaviour:
    """A check of a run, for FMI from a version on; ``illegal`` where it makes calls that the standard forbids."""

    function: Callable[[Subject], Answer]
    illegal: bool = False
    version: int = 2


LIFE_CYCLE = "life cycle"
_BOTH = {
    LIFE_CYCLE: Behaviour(runs.life_cycle),
    "finite outputs": Behaviour(runs.finite_outputs),
    "run again": Behaviour(runs.rerun),
    "reset": Behaviour(runs.reset),
    "two instances": Behaviour(runs.two_instances),
    "state round trip": Behaviour(states.state_round_trip),
    "serialised state": Behaviour(states.serialized_state),
    "directional derivatives": Behaviour(derivatives.directional_derivatives),
    "adjoint derivatives": Behaviour(adjoints.adjoint_derivatives, version=3),
    "declared dependencies": Behaviour(derivatives.declared_dependencies),
    "step refinement": Behaviour(refinement.step_refinement),
}
_ILLEGAL = {
    "wrong token": Behaviour(illegal.wrong_token, illegal=True),
    "illegal calls": Behaviour(illegal.illegal_calls, illegal=True),
}
CHECKS: Mapping[str, Mapping[str, Behaviour]] = {
    "CoSimulation": {
        **_BOTH,
        "stop time": Behaviour(runs.stop_time),
        "reference results": Behaviour(references.reference_results),
        **_ILLEGAL,
    },
    "ModelExchange": {**_BOTH, **_ILLEGAL},
}
