"""Set point of any chains."""

from __future__ import annotations

from collections.abc import Sequence

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.gains import numbers
from brunovsky.blocks.variables import Parameter
from brunovsky.errors import ModelError


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

    Raises
    ------
    ModelError
        If there is not one number for each chain.
    """
    chains = Chains.of(chains)
    values = numbers("targets", targets) if len(targets) else [0.0] * len(chains.orders)
    if len(values) != len(chains.orders):
        raise ModelError(f"set_point: {len(values)} target(s) for {len(chains.orders)} chain(s); give one for each")
    parameters = tuple(
        Parameter(f"target[{i}]", unit, f"set point of output {i}", value, tunable=True)
        for i, (unit, value) in enumerate(zip(chains.units, values, strict=True), 1)
    )
    return Block(
        "set_point",
        "constant reference",
        parameters=parameters,
        outputs=chains.reference([one.symbol for one in parameters]),
    )
