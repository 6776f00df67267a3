"""Super-twisting outer loop: a continuous v that removes disturbances of bounded slope."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.outer_loops.sampled_law import warned
from brunovsky.blocks.library.outer_loops.surface import (
    sliding_outputs,
    sliding_variables,
    surface_checks,
    surface_gains,
    surface_law,
)
from brunovsky.blocks.library.outer_loops.switching import with_sound_defaults
from brunovsky.blocks.library.outer_loops.twisting_gains import (
    WELL_ESTABLISHED,
    slope_bounds,
    twisting_checks,
    twisting_gains,
)
from brunovsky.blocks.variables import Check, State

_WIDTH = sp.Float("1e-12")


def super_twisting(
    chains: Chains | Block = ROBOT_CHAINS,
    surface: Sequence[ArrayLike] | None = None,
    *,
    k: ArrayLike = WELL_ESTABLISHED,
    L: ArrayLike = 100.0,
) -> Block:
    """Law that makes S' = -k1 sqrt(L abs(S)) sign(S) + w, w' = -k2 L sign(S), for each chain; w starts at zero.

    v is continuous. S and S' vanish after a finite time for every disturbance of S' (c_r times that at the level of v)
    whose slope stays within L, if k2 > 1 and k1 > sqrt(k2 + 1) (Seeber and Horn). k2 > 1 is necessary and a smaller one
    refused; the other is not, and a smaller k1 is warned of. The default is Levant's;
    ``brunovsky.analysis.super_twisting_slope_bound`` gives the slope that other gains bear. L says how fast as well:
    S0 takes some 2 sqrt(abs(S0)/L)/k1, and S may overshoot.

    The square root is that of abs(S) but for abs(S) near 1e-12 (unit of S), where S/(S^2 + 1e-24)^(1/4) takes its
    place: it has no branch that a step frozen on one side could leave, differs by at most 2.6e-7 sqrt(unit of S), and
    w removes the difference. sign(S) is a relation, frozen over a step of size h: S then stays within a few k2 L h^2.

    Parameters
    ----------
    chains : Chains or Block
        The chains, or the linearised plant that has them; the robot's by default.
    surface : sequence of float, or one sequence per chain
        C = (c_1, ..., c_r), as for :func:`sliding_mode`.
    k : sequence of float, shape (2,)
        k1 and k2.
    L : float, or one per chain
        Bound of the slope of the disturbance of S' (unit of S per s^2; m/s4 for the robot).

    Returns
    -------
    Block
        Inputs those of :class:`Chains`, outputs ``v[i]`` and ``S[i]``, states ``w[i]``; parameters ``C[k]``, or
        ``Ci[k]``, ``k[1]``, ``k[2]``, ``L`` or ``L[i]``. Its FMU has no model exchange: sign(S) has no end of
        events there.

    Raises
    ------
    ModelError
        If the numbers do not fit the chains.
    ParameterError
        If the surface is not stable, c_r or L zero, or k2 not above 1.

    References
    ----------
    A. Levant, "Robust exact differentiation via sliding mode technique", Automatica 34(3), 379-384, 1998; R. Seeber
    and M. Horn, "Stability proof for a well-established super-twisting parameter setting", Automatica 84, 241-243,
    2017, doi:10.1016/j.automatica.2017.07.002.
    """
    name = "super_twisting"
    chains = Chains.of(chains)
    c = surface_gains(chains, surface, name)
    gains = twisting_gains(k)
    slopes = slope_bounds(chains, L)
    k1, k2 = (one.symbol for one in gains)
    variables = sliding_variables(chains, c)
    states = tuple(
        State(
            f"w[{i}]",
            chains.unit(i, chains.orders[i - 1]),
            f"integral of sign(S[{i}])",
            -k2 * slopes[i][0] * sp.sign(variables[i]),
        )
        for i in chains.numbers
    )
    law = {
        i: surface_law(chains, i, c[i], -k1 * sp.sqrt(slopes[i][0]) * _signed_root(variables[i]) + w.symbol)
        for i, w in zip(chains.numbers, states, strict=True)
    }
    block = with_sound_defaults(
        Block(
            name,
            "super-twisting outer loop",
            inputs=chains.inputs,
            parameters=(*c.parameters, *gains, *slopes.parameters),
            states=states,
            outputs=(*chains.outer_inputs(law), *sliding_outputs(chains, variables)),
            checks=(
                *surface_checks(c),
                *twisting_checks(gains, slopes),
                Check(
                    "sign function",
                    sp.false,
                    "sign(S) in super-twisting has no end of events in model exchange; use co-simulation, which "
                    "samples it once an internal step, or super_twisting_sampled",
                    when="model exchange",
                ),
            ),
        )
    )
    return warned(block)


def _signed_root(s: sp.Expr) -> sp.Expr:
    """sqrt(abs(s)) sign(s), smooth near 0."""
    return s / (s**2 + _WIDTH**2) ** sp.Rational(1, 4)
