"""Which interfaces the FMU of a block has: those in which it runs with the values it starts with."""

from __future__ import annotations

from collections.abc import Mapping

from brunovsky.blocks import Block
from brunovsky.fmi.clocking import is_clocked

INTERFACES = ("CoSimulation", "ModelExchange", "ScheduledExecution")
"""In the order of the runtime; FMI 2 has the first two."""

_FOR_CLOCKS = "scheduled execution is for blocks with clocks, without continuous states or other samples"


def refused_interfaces(block: Block) -> Mapping[str, str]:
    """The interfaces that the FMU of a block doesn't have, each with the reason.

    Model exchange is refused where a check for it fails with the default values of the parameters: a sign function
    without a width, which has no end of events. Scheduled execution is for blocks that clocks alone make act.
    """
    failed = block.failed_checks(block.parameter_values(), "model exchange")
    found = {"ModelExchange": failed[0].message} if failed else {}
    return found if is_clocked(block) else found | {"ScheduledExecution": _FOR_CLOCKS}


def has_model_exchange(block: Block) -> bool:
    """Whether the FMU of a block has model exchange, and with it event indicators and states marked as reset."""
    return "ModelExchange" not in refused_interfaces(block)
