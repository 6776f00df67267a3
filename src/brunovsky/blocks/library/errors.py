"""Tracking errors of chains, for recording."""

from __future__ import annotations

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.variables import Output


def errors(chains: Chains | Block = ROBOT_CHAINS) -> Block:
    """Tracking errors ``e1[1..r_1]``, ``e2[1..r_2]``, ... from chains and references, for recording.

    Parameters
    ----------
    chains : Chains or Block
        The chains, or the linearised plant that has them.
    """
    chains = Chains.of(chains)
    return Block(
        "errors",
        "tracking errors of the chains",
        inputs=(*chains.states, *chains.references),
        outputs=tuple(
            Output(f"e{i}[{k}]", chains.unit(i, k - 1), f"tracking error of chain {i}, element {k}", error)
            for i in chains.numbers
            for k, error in enumerate(chains.error(i), 1)
        ),
    )
