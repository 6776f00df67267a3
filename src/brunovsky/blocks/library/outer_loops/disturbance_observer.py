"""Disturbance observer on the chains: what v does not explain is estimated and taken off."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.gains import scalar_gains
from brunovsky.blocks.library.outer_loops.linear import linear_gains, linear_law, refuse_unstable
from brunovsky.blocks.library.outer_loops.nominal import STARTED, deviations, nominal_states, start_transition
from brunovsky.blocks.library.outer_loops.switching import with_sound_defaults
from brunovsky.blocks.variables import Check, Output


def disturbance_observer(
    chains: Chains | Block = ROBOT_CHAINS, gains: Sequence[ArrayLike] | None = None, *, bandwidth: ArrayLike = 20.0
) -> Block:
    """Linear law less the estimate of the disturbance at the level of v: v_i = -K e_i + y_d^(r_i) - d_hat_i.

    The last element of a chain obeys Z_r' = v + d; the observer d_hat = L (Z_r - p), p' = v + d_hat, gives
    d_hat' = L (d - d_hat), L the ``bandwidth``: no residual d - d_hat for a constant disturbance, R/L at most for one
    that changes at up to R per second. The loop has the poles of K and -L. From the same K it is the integral action of
    :func:`pole_placement` with the poles of K and -L, apart from the start: d_hat is zero there whatever the error,
    which thus does not wind up.

    Conditions: the linear law is stable, L > 0; what delays v (actuators, sampling) must be fast against L, for the
    observer takes it for a disturbance, and it amplifies noise of Z_r by L. The measured chain must be there at
    initialisation. Unmatched disturbances are not seen.

    Parameters
    ----------
    chains : Chains or Block
        The chains, or the linearised plant that has them; the robot's by default.
    gains : sequence of float, or one sequence per chain
        K = (k_1, ..., k_r) of the linear law, as for :func:`pole_placement`.
    bandwidth : float, or one per chain
        L (1/s).

    Returns
    -------
    Block
        Inputs those of :class:`Chains`, outputs ``v[i]`` and ``d_hat[i]``, the estimate in the unit of v; states
        ``nominal[i]``, which is p; parameters ``K[k]`` and ``bandwidth``, or ``Ki[k]``, ... where chains differ.

    Raises
    ------
    ModelError
        If the numbers do not fit the chains.
    ParameterError
        If the bandwidth is not positive.

    References
    ----------
    W.-H. Chen, D. J. Ballance, P. J. Gawthrop and J. O'Reilly, "A nonlinear disturbance observer for robotic
    manipulators", IEEE Trans. Ind. Electron. 47(4), 932-938, 2000, doi:10.1109/41.857974.
    """
    chains = Chains.of(chains)
    gain = linear_gains(chains, gains, "disturbance_observer")
    refuse_unstable(gain, "disturbance_observer")
    observer = scalar_gains(chains, "bandwidth", bandwidth, lambda i: "1/s", "bandwidth of the observer", 0.0)
    nominal = linear_law(chains, gain)
    estimates = {i: observer[i][0] * one for i, one in deviations(chains).items()}
    return with_sound_defaults(
        Block(
            "disturbance_observer",
            "linear law with a disturbance observer",
            inputs=chains.inputs,
            parameters=(*gain.parameters, *observer.parameters),
            states=nominal_states(chains, nominal),
            modes=(STARTED,),
            outputs=(
                *chains.outer_inputs({i: v - estimates[i] for i, v in nominal.items()}),
                *(
                    Output(
                        f"d_hat[{i}]", chains.unit(i, chains.orders[i - 1]), f"disturbance of chain {i}, estimated", e
                    )
                    for i, e in estimates.items()
                ),
            ),
            transitions=(start_transition(chains),),
            checks=tuple(
                Check(
                    "bandwidth",
                    sp.Gt(one.symbol, 0),
                    f"{one.name} = 0 observes nothing; set it > 0, or use pole_placement, the law without observer",
                )
                for one in observer.parameters
            ),
        )
    )
