"""Which variables of a block change only when a clock ticks, as FMI 3 declares them."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks import Block


def is_clocked(block: Block) -> bool:
    """Whether clocks alone make the block act: it has clocks, no continuous states, and no sample without a clock."""
    return bool(block.clocks) and not block.states and all(one.clock for one in block.samples)


def clocks_by_name(block: Block) -> dict[str, tuple[str, ...]]:
    """Clocks of each variable that changes only at their ticks.

    In a block that clocks alone make act these are all inputs, outputs and samples: a sample with its clock; an
    input with the clocks of the samples that read it; an output with the clocks of what it is made of. In other
    blocks they are the samples that have a clock and that no transition assigns, and the outputs that show them.
    """
    of_sample = {one.symbol: {one.clock} for one in block.samples if one.clock}
    if not is_clocked(block):
        reset = {target for one in block.transitions for target in one.assign}
        held = {symbol: names for symbol, names in of_sample.items() if symbol not in reset}
        found = {one.name: held[one.symbol] for one in block.samples if one.symbol in held}
        found |= {one.name: held[one.expression] for one in block.outputs if one.expression in held}
        return {name: _ordered(block, names) for name, names in found.items()}
    everything = {one.name for one in block.clocks}
    of_input: dict[sp.Symbol, set[str]] = {
        one.symbol: {item.clock for item in block.samples if one.symbol in block.depends_on(item.update)}
        for one in block.inputs
    }
    known = of_sample | of_input
    found = {one.name: of_sample[one.symbol] for one in block.samples}
    found |= {one.name: of_input[one.symbol] or everything for one in block.inputs}
    for one in block.outputs:
        behind = set().union(*(known.get(symbol, set()) for symbol in block.depends_on(one.expression)))
        found[one.name] = behind or everything
    return {name: _ordered(block, names) for name, names in found.items()}


def clock_priorities(block: Block) -> dict[str, int]:
    """Priority of each clock, 0 first: where two tick at once, samples that others read come before these."""
    first = {one.name: [item.rank for item in block.samples if item.clock == one.name] for one in block.clocks}
    order = sorted(first, key=lambda name: min(first[name], default=0))
    return {name: priority for priority, name in enumerate(order)}


def _ordered(block: Block, names: set[str]) -> tuple[str, ...]:
    return tuple(one.name for one in block.clocks if one.name in names)
