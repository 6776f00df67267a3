"""Set point of any chains."""

from __future__ import annotations

from collections.abc import Sequence

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.variables import Parameter


def set_point(chains: Chains | Block = ROBOT_CHAINS, targets: Sequence[float] = ()) -> Block:
    """Constant reference ``Zid[1] = target[i]``, its derivatives zero.

    Parameters
    ----------
    chains : Chains or Block
        The chains, or the linearised plant that has them.
    targets : sequence of float, shape (m,)
        Default of the tunable parameters ``target[i]``, in the units of the outputs; zero where not given.

    Returns
    -------
    Block
        A reference for :func:`closed_loop`.
    """
    chains = Chains.of(chains)
    parameters = tuple(
        Parameter(
            f"target[{i}]", unit, f"set point of output {i}", float(targets[i - 1]) if targets else 0.0, tunable=True
        )
        for i, unit in enumerate(chains.units, 1)
    )
    return Block(
        "set_point",
        "constant reference",
        parameters=parameters,
        outputs=chains.reference([one.symbol for one in parameters]),
    )
