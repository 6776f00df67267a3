"""What all outer loops of the robot's two chains share: their inputs and the tracking error."""

from __future__ import annotations

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.units import derivative_unit
from brunovsky.blocks.variables import Input, Output, symbol

CHAINS = (1, 2)
ORDER = 3

INPUTS = (
    *(
        Input(f"Z{i}{suffix}[{k}]", derivative_unit("m", k - 1), f"{what} {i}, element {k}")
        for suffix, what in (("", "chain"), ("d", "reference of chain"))
        for i in CHAINS
        for k in range(1, ORDER + 1)
    ),
    *(Input(f"zd3[{i}]", "m/s3", f"third derivative of the reference of chain {i}") for i in CHAINS),
)


def tracking_error(chain: int) -> sp.Matrix:
    """Error of a chain, Z - Zd (eq. 19 of the paper), shape (3, 1), in m, m/s, m/s2."""
    return sp.Matrix([symbol(f"Z{chain}[{k}]") - symbol(f"Z{chain}d[{k}]") for k in range(1, ORDER + 1)])


def outer_inputs(law: dict[int, sp.Expr]) -> tuple[Output, ...]:
    """Outputs ``v[1..2]`` of a law given per chain, in m/s3."""
    return tuple(Output(f"v[{i}]", "m/s3", f"input of chain {i}", law[i]) for i in CHAINS)


def errors() -> Block:
    """Tracking errors ``e1[1..3]``, ``e2[1..3]`` from chains and references, for recording."""
    return Block(
        "errors",
        "tracking errors of two chains",
        inputs=INPUTS[:-2],
        outputs=tuple(
            Output(f"e{i}[{k}]", derivative_unit("m", k - 1), f"tracking error of chain {i}, element {k}", error)
            for i in CHAINS
            for k, error in enumerate(tracking_error(i), 1)
        ),
    )
