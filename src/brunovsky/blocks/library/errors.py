"""Tracking errors of chains, for recording."""

from __future__ import annotations

from collections.abc import Sequence

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.variables import Input, Output, symbol
from brunovsky.errors import ModelError


def errors(chains: Chains | Block = ROBOT_CHAINS, positions: Sequence[str] = ()) -> Block:
    """Tracking errors ``e1[1..r_1]``, ``e2[1..r_2]``, ... from chains and references, for recording.

    Parameters
    ----------
    chains : Chains or Block
        The chains, or the linearised plant that has them.
    positions : sequence of str, optional
        Name of the true output that heads each chain, where the chains are measured: ``("x", "y")`` for the robot
        behind sensors. The outputs ``position_error[i]`` are what they differ from the reference.

    Raises
    ------
    ModelError
        If `positions` are given and are not one for each chain.
    """
    chains = Chains.of(chains)
    if positions and len(positions) != len(chains.orders):
        raise ModelError(f"errors: positions = {positions}; give one for each of the {len(chains.orders)} chains")
    true = [Input(name, chains.unit(i, 0), f"true output {i}") for i, name in enumerate(positions, 1)]
    return Block(
        "errors",
        "tracking errors of the chains",
        inputs=(*chains.states, *chains.references, *true),
        outputs=(
            *(
                Output(f"e{i}[{k}]", chains.unit(i, k - 1), f"tracking error of chain {i}, element {k}", error)
                for i in chains.numbers
                for k, error in enumerate(chains.error(i), 1)
            ),
            *(
                Output(
                    f"position_error[{i}]",
                    one.unit,
                    f"true tracking error of {one.name}",
                    one.symbol - symbol(f"Z{i}d[1]"),
                )
                for i, one in enumerate(true, 1)
            ),
        ),
    )
