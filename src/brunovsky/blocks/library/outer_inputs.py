"""What acts of the outer loop's v on the inner loop: held between samples, with a matched disturbance."""

from __future__ import annotations

from brunovsky.blocks.block import Block
from brunovsky.blocks.hardware import acting
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.sampling import held_sample, hold_period
from brunovsky.blocks.variables import Input, Output, described, symbol


def outer_inputs(
    chains: Chains | Block = ROBOT_CHAINS,
    *,
    matched: bool = True,
    period: float | None = None,
    name: str = "outer_inputs",
) -> Block:
    """Each v[i], held between samples where there is a period, plus a disturbance ``dv[i]``: matched, as it is at v.

    Parameters
    ----------
    chains : Chains or Block
        The chains, or the linearised plant that has them; the robot's by default.
    matched : bool
        Whether there are inputs ``dv[i]``, in the unit of ``v[i]``, 0 unless given; they are not sampled.
    period : float, optional
        Default of the fixed parameter ``sampling_period``, s; without it ``v[i]`` is not sampled.
    name : str
        Of the block.

    Returns
    -------
    Block
        Inputs ``v[i]`` and ``dv[i]``, outputs ``v_acting[i]``. For ``inputs`` of :func:`linearized_block`.

    Raises
    ------
    ModelError
        If `chains` has none.
    ParameterError
        If the period is not positive and finite.
    """
    chains = Chains.of(chains)
    outer = [
        Input(f"v[{i}]", chains.unit(i, order), f"input of chain {i}: derivative {order} of output {i}")
        for i, order in enumerate(chains.orders, 1)
    ]
    disturbances = [
        Input(f"dv[{i}]", one.unit, f"matched disturbance of chain {i}, added to {one.name}")
        for i, one in enumerate(outer, 1)
        if matched
    ]
    samples = [  # after the sensors of the same instant, which v is computed from
        held_sample(Input(f"v_held[{i}]", one.unit, f"{one.description}, held"), one.symbol, rank=1)
        for i, one in enumerate(outer, 1)
        if period is not None
    ]
    return Block(
        name,
        "inputs of the chains" + (", sampled" if samples else "") + (", disturbed" if matched else ""),
        inputs=(*outer, *disturbances),
        parameters=(hold_period(period, name),) if period is not None else (),
        samples=tuple(samples),
        outputs=tuple(
            Output(
                **described(acting(one)),
                expression=(symbol(f"v_held[{i}]") if samples else one.symbol) + (symbol(f"dv[{i}]") if matched else 0),
            )
            for i, one in enumerate(outer, 1)
        ),
    )
