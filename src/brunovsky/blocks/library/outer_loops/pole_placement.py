"""Linear state feedback per chain, the paper's "DFL" outer loop."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.gains import vector_gains
from brunovsky.errors import ModelError

_ROBOT_GAINS = (2500.0, 550.0, 15.0)


def pole_placement(chains: Chains | Block = ROBOT_CHAINS, gains: Sequence[ArrayLike] | None = None) -> Block:
    """Linear law v_i = -K e_i + y_d^(r_i) for each chain; the error obeys s^r + k_r s^(r-1) + ... + k_1.

    Parameters
    ----------
    chains : Chains or Block
        The chains, or the linearised plant that has them; the robot's by default.
    gains : sequence of float, or one sequence per chain
        K = (k_1, ..., k_r) in 1/s^r, ..., 1/s: :func:`brunovsky.analysis.place` gives it for poles. The default, for
        the robot's chains alone, is the linear part of the paper's sliding-mode law (C = [500, 10, 1], Q = 5): poles
        -5 and -5 +- 21.79j, since K = [Q c1, c1 + Q c2, c2 + Q c3]/c3.

    Returns
    -------
    Block
        Inputs those of :class:`Chains`, outputs ``v[i]``; parameters ``K[k]``, or ``Ki[k]`` where chains differ.

    Raises
    ------
    ModelError
        If the gains do not fit the chains.

    References
    ----------
    The paper's eq. (19); J. Ackermann, "Der Entwurf linearer Regelungssysteme im Zustandsraum",
    at - Automatisierungstechnik 20, 297-300, 1972, doi:10.1524/auto.1972.20.112.297.
    """
    chains = Chains.of(chains)
    if gains is None:
        if chains != ROBOT_CHAINS:
            raise ModelError(
                "pole_placement: gains are missing; brunovsky.analysis.place(poles) gives them for each chain"
            )
        gains = _ROBOT_GAINS
    gain = vector_gains(chains, "K", gains, lambda r, k: r - k + 1, "gain of the error's derivative {k}")
    law = {i: chains.feedforward(i) - (sp.Matrix([gain[i]]) * chains.error(i))[0] for i in chains.numbers}
    return Block(
        "pole_placement",
        "pole placement per chain",
        inputs=chains.inputs,
        parameters=gain.parameters,
        outputs=chains.outer_inputs(law),
    )
