"""Linear state feedback per chain, the paper's "DFL" outer loop, with or without integral action."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.gains import scalar_gains
from brunovsky.blocks.library.outer_loops.linear import linear_gains, linear_law, warn_unstable
from brunovsky.blocks.units import derivative_unit
from brunovsky.blocks.variables import State
from brunovsky.errors import ModelError


def pole_placement(
    chains: Chains | Block = ROBOT_CHAINS, gains: Sequence[ArrayLike] | None = None, *, integral: bool = False
) -> Block:
    """Linear law v_i = -K e_i + y_d^(r_i) for each chain; the error obeys s^r + k_r s^(r-1) + ... + k_1.

    The block of every linear design: poles by :func:`brunovsky.analysis.place`, a quadratic cost by
    :func:`brunovsky.analysis.lqr_gain`. With ``integral`` the law has -K_I times the integral of e_i1 as well, and the
    error obeys s^(r+1) + k_r s^r + ... + k_1 s + K_I: the same designs for a chain that is one longer. A constant
    disturbance at the level of v then leaves no error, any other one less. The integral starts at zero and has no
    anti-windup: the law does not saturate v, and a plant that does will see it overshoot.

    Parameters
    ----------
    chains : Chains or Block
        The chains, or the linearised plant that has them; the robot's by default.
    gains : sequence of float, or one sequence per chain
        K = (k_1, ..., k_r) in 1/s^r, ..., 1/s; with ``integral`` (K_I, k_1, ..., k_r), K_I in 1/s^(r+1), as ``place``
        gives for r + 1 poles. The default, for the robot's chains alone and without ``integral``, is the linear part
        of the paper's sliding-mode law (C = [500, 10, 1], Q = 5): poles -5 and -5 +- 21.79j, since
        K = [Q c1, c1 + Q c2, c2 + Q c3]/c3.
    integral : bool
        Whether the law has integral action, with the states ``integral[i]``.

    Returns
    -------
    Block
        Inputs those of :class:`Chains`, outputs ``v[i]``; parameters ``K[k]``, or ``Ki[k]`` where chains differ, and
        with ``integral`` ``K_I``, or ``K_I[i]``.

    Raises
    ------
    ModelError
        If the gains do not fit the chains.

    Warns
    -----
    UserWarning
        If the loop is unstable with these gains.

    References
    ----------
    The paper's eq. (19); J. Ackermann, "Der Entwurf linearer Regelungssysteme im Zustandsraum",
    at - Automatisierungstechnik 20, 297-300, 1972, doi:10.1524/auto.1972.20.112.297; integral action: K. J. Åström and
    R. M. Murray, *Feedback Systems*, 2008, section 6.4, doi:10.1515/9781400828739.
    """
    chains = Chains.of(chains)
    if not integral:
        gain = linear_gains(chains, gains, "pole_placement")
        warn_unstable(gain, "pole_placement")
        return Block(
            "pole_placement",
            "pole placement per chain",
            inputs=chains.inputs,
            parameters=gain.parameters,
            outputs=chains.outer_inputs(linear_law(chains, gain)),
        )
    integral_gains, gains = _parted(gains, chains)
    gain = linear_gains(chains, gains, "pole_placement")
    extra = scalar_gains(
        chains,
        "K_I",
        integral_gains,
        lambda i: derivative_unit("1", chains.orders[i - 1] + 1),
        "gain of the integral of the error",
    )
    warn_unstable(gain, "pole_placement", extra)
    states = tuple(
        State(f"integral[{i}]", chains.unit(i, -1), f"integral of the error of chain {i}", chains.error(i)[0])
        for i in chains.numbers
    )
    law = {
        i: one - extra[i][0] * state.symbol
        for (i, one), state in zip(linear_law(chains, gain).items(), states, strict=True)
    }
    return Block(
        "pole_placement",
        "pole placement per chain with integral action",
        inputs=chains.inputs,
        parameters=(*gain.parameters, *extra.parameters),
        states=states,
        outputs=chains.outer_inputs(law),
    )


def _parted(gains: Sequence[ArrayLike] | None, chains: Chains) -> tuple[ArrayLike, Sequence[ArrayLike]]:
    """Gains of the integrals and of the errors, from vectors that begin with the former."""
    if gains is None:
        raise ModelError(
            "pole_placement: gains are missing; with integral action brunovsky.analysis.place(poles), of one pole more "
            "than the chain is long, gives them"
        )
    rows = [np.asarray(row, dtype=float) for row in gains]
    if not rows or any(row.ndim > 1 or row.size == 0 for row in rows) or len({row.ndim for row in rows}) > 1:
        raise ModelError(f"pole_placement: gains {gains!r} are no vector, nor one for each chain")
    found, needed = [len(rows)] if rows[0].ndim == 0 else [one.size for one in rows], [r + 1 for r in chains.orders]
    if found != needed and found != needed[:1]:
        raise ModelError(
            f"pole_placement: gains of the lengths {found} for chains of the lengths {list(chains.orders)}; with "
            "integral action give one more than a chain is long, K_I first"
        )
    if rows[0].ndim == 0:
        return float(rows[0]), [float(one) for one in rows[1:]]
    return [float(row[0]) for row in rows], [row[1:].tolist() for row in rows]
