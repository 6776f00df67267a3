"""What all laws with a linear part share: its gains, and v = -K e + feedforward."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.gains import Gains, vector_gains
from brunovsky.errors import ModelError

_ROBOT_GAINS = (2500.0, 550.0, 15.0)


def linear_gains(chains: Chains, gains: Sequence[ArrayLike] | None, law: str) -> Gains:
    """Parameters ``K[k]``, by default, for the robot's chains alone, the linear part of the paper's law.

    Raises
    ------
    ModelError
        If they are missing or do not fit the chains; ``law`` names the block.
    """
    if gains is None:
        if chains != ROBOT_CHAINS:
            raise ModelError(
                f"{law}: gains are missing; brunovsky.analysis.place(poles) or lqr_gain(order, weights) gives them for "
                "each chain"
            )
        gains = _ROBOT_GAINS
    return vector_gains(chains, "K", gains, lambda r, k: r - k + 1, "gain of the error's derivative {k}")


def linear_law(chains: Chains, gain: Gains) -> dict[int, sp.Expr]:
    """Law v_i = -K e_i + y_d^(r_i), by number of the chain."""
    return {i: chains.feedforward(i) - (sp.Matrix([gain[i]]) * chains.error(i))[0] for i in chains.numbers}
