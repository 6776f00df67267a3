"""Integral sliding mode: a linear law, and a switching part that keeps its nominal motion from the first instant."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.outer_loops.linear import linear_gains, linear_law, refuse_unstable
from brunovsky.blocks.library.outer_loops.nominal import STARTED, deviations, nominal_states, start_transition
from brunovsky.blocks.library.outer_loops.surface import sliding_outputs
from brunovsky.blocks.library.outer_loops.switching import (
    Switching,
    SwitchingFunction,
    bound_checks,
    bound_of,
    with_sound_defaults,
)


def integral_sliding_mode(
    chains: Chains | Block = ROBOT_CHAINS,
    gains: Sequence[ArrayLike] | None = None,
    *,
    P: ArrayLike = 2.5,
    phi: ArrayLike | None = None,
    switching: SwitchingFunction = "saturation",
    disturbance: ArrayLike | None = None,
) -> Block:
    """Integral sliding-mode law v_i = -K e_i + y_d^(r_i) - P f(S_i), S_i = Z_ir - integral of (-K e_i + y_d^(r_i)).

    S is zero at the start, so that there is no reaching phase, and S' = -P f(S) + d with the disturbance d at the level
    of v. On S = 0 the chain moves as under the linear law without disturbance. With a boundary layer
    abs(S) <= phi D/P for abs(d) <= D < P, and the error differs from the nominal one by S' filtered by
    1/(s^r + k_r s^(r-1) + ... + k_1). There, P sat(S/phi) is that of :func:`disturbance_observer` with the bandwidth
    P/phi.

    Conditions: the linear law is stable, P > D. The measured chain must be there at initialisation, where the nominal
    motion takes its start from it. Unmatched disturbances are not seen. The sign function is sampled once a step in
    co-simulation and refused in model exchange.

    Parameters
    ----------
    chains : Chains or Block
        The chains, or the linearised plant that has them; the robot's by default.
    gains : sequence of float, or one sequence per chain
        K = (k_1, ..., k_r) of the linear law, as for :func:`pole_placement`.
    P, phi : float, or one per chain
        Gain of the switching part (unit of v), half-width of the boundary layer (unit of S, that of the output's
        derivative r - 1; by default 0.05, under ``"sign"`` there is none).
    switching : {"saturation", "sign", "tanh"}
        f(S) = sat(S/phi), sign(S) or tanh(S/phi).
    disturbance : float, or one per chain, optional
        Stated bound D of the disturbance at the level of v (unit of v).

    Returns
    -------
    Block
        Inputs those of :class:`Chains`, outputs ``v[i]`` and ``S[i]``; states ``nominal[i]``; parameters ``K[k]``,
        ``P``, ``phi``, ``D``, those that there are, or ``Ki[k]``, ``P[i]``, ... where chains differ.

    Raises
    ------
    ModelError
        If the numbers do not fit the chains, or ``switching`` is unknown.
    ParameterError
        If P does not exceed the stated bound.

    References
    ----------
    V. Utkin and J. Shi, "Integral sliding mode in systems operating under uncertainty conditions", Proc. 35th IEEE
    Conf. Decision and Control, 4591-4596, 1996.
    """
    chains = Chains.of(chains)
    gain = linear_gains(chains, gains, "integral_sliding_mode")
    refuse_unstable(gain, "integral_sliding_mode")
    part = Switching.of(chains, switching, P, phi)
    bound = bound_of(chains, disturbance)
    nominal, variables = linear_law(chains, gain), deviations(chains)
    return with_sound_defaults(
        Block(
            "integral_sliding_mode",
            "linear law with integral sliding mode against matched disturbances",
            inputs=chains.inputs,
            parameters=(*gain.parameters, *part.parameters, *(bound.parameters if bound else ())),
            states=nominal_states(chains, nominal),
            modes=(STARTED,),
            outputs=(
                *chains.outer_inputs({i: v - part.force(i, variables[i]) for i, v in nominal.items()}),
                *sliding_outputs(chains, variables),
            ),
            transitions=(start_transition(chains),),
            checks=(*part.checks, *bound_checks(part.gain, bound, {})),
        )
    )
