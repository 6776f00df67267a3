"""Implicit super-twisting: sampled, in closed form, without chatter."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.outer_loops.sampled_law import held_law, sampled_inputs, sampling_period, warned
from brunovsky.blocks.library.outer_loops.surface import (
    sliding_outputs,
    sliding_variables,
    surface_checks,
    surface_gains,
)
from brunovsky.blocks.library.outer_loops.surface_map import PERIOD, period_checks
from brunovsky.blocks.library.outer_loops.switching import with_sound_defaults
from brunovsky.blocks.library.outer_loops.twisting_gains import (
    WELL_ESTABLISHED,
    slope_bounds,
    twisting_checks,
    twisting_gains,
)
from brunovsky.blocks.variables import Sample, symbol


def super_twisting_sampled(
    chains: Chains | Block = ROBOT_CHAINS,
    surface: Sequence[ArrayLike] | None = None,
    *,
    k: ArrayLike = WELL_ESTABLISHED,
    L: ArrayLike = 100.0,
    period: float = 0.01,
    compensated: bool = True,
    preview: bool = False,
) -> Block:
    """Law that makes S+ = S - h k1 sqrt(L abs(S+)) sign(S+) + h w+, w+ = w - h k2 L sign(S+); v is held.

    That is the implicit scheme of the source, ``compensated=False``, where S+ is what v alone would make of S. With
    q = S + h w the solution is S+ = 0 and w+ = -S/h where abs(q) <= h^2 k2 L, else sqrt(abs(S+)) is the positive root
    of x^2 + h k1 sqrt(L) x = abs(q) - h^2 k2 L and S+ has the sign of q. It does not chatter, but a disturbance d of
    S', even a constant one, leaves S = h d, as by :func:`sliding_mode_sampled`.

    ``compensated`` lets S+ be what v makes of S together with the disturbance -w+ that w stands for: q = S, and
    h (w+ - w) is added to h v. Once S is within h^2 k2 L the step is dead-beat and leaves L h^2, the least that a
    disturbance of that slope can leave between two samples. The bound is tested here, by simulation; a scheme proven to
    have it is that of Seeber and Andritsch.

    How v moves S over a sample is taken exactly, so that the conditions of :func:`sliding_mode_sampled` with the exact
    map hold: h below the limit of the surface (155 ms for the paper's C), and for S = 0 at the samples to rounding a
    reference that is constant or known one sample ahead. The gains must satisfy what :func:`super_twisting` says.

    Parameters
    ----------
    chains, surface, k, L
        As for :func:`super_twisting`.
    period, preview
        As for :func:`sliding_mode_sampled`.
    compensated : bool
        Whether the predicted S+ takes the disturbance into account that w stands for.

    Returns
    -------
    Block
        Inputs those of :class:`Chains` and ``Zid_next[k]`` with ``preview``; outputs ``v[i]``, held, and ``S[i]``, not
        sampled; samples ``w[i]``; parameters ``sampling_period``, ``C[k]``, ``k[1]``, ``k[2]``, ``L``.

    Raises
    ------
    ModelError
        If the numbers do not fit the chains.
    ParameterError
        If the surface is not stable, c_r or L zero, k2 not above 1, or the period not positive or too long.

    References
    ----------
    B. Brogliato, A. Polyakov and D. Efimov, "The implicit discretization of the supertwisting sliding-mode control
    algorithm", IEEE Trans. Autom. Control 65(8), 3707-3713, 2020, doi:10.1109/TAC.2019.2953091; R. Seeber and
    B. Andritsch, "Proper implicit discretization of the super-twisting controller - without and with actuator
    saturation", Automatica 173, 112027, 2025, doi:10.1016/j.automatica.2024.112027.
    """
    name = "super_twisting_sampled"
    chains = Chains.of(chains)
    c = surface_gains(chains, surface, name)
    gains = twisting_gains(k)
    slopes = slope_bounds(chains, L)
    variables = sliding_variables(chains, c)
    solved = {
        i: _step(variables[i], symbol(f"w[{i}]"), gains[0].symbol, gains[1].symbol, slopes[i][0], compensated)
        for i in chains.numbers
    }
    rates = {i: rate for i, (rate, _) in solved.items()}
    samples, held = held_law(chains, rates, c, "exact", preview=preview)
    integrals = tuple(
        Sample(
            f"w[{i}]",
            chains.unit(i, chains.orders[i - 1]),
            f"integral of sign(S[{i}])",
            following,
            period=PERIOD.symbol,
        )
        for i, (_, following) in solved.items()
    )
    block = with_sound_defaults(
        Block(
            name,
            "implicit sampled super-twisting outer loop",
            inputs=sampled_inputs(chains, preview=preview),
            parameters=(sampling_period(period, name), *c.parameters, *gains, *slopes.parameters),
            samples=(*samples, *integrals),
            outputs=(*held, *sliding_outputs(chains, variables)),
            checks=(*surface_checks(c), *twisting_checks(gains, slopes), *period_checks(c, "exact")),
        )
    )
    return warned(block)


def _step(
    s: sp.Expr, w: sp.Symbol, k1: sp.Symbol, k2: sp.Symbol, slope: sp.Symbol, compensated: bool
) -> tuple[sp.Expr, sp.Expr]:
    """(S+ - S)/h without disturbance, and w+."""
    h = PERIOD.symbol
    q, limit, root_gain = s if compensated else s + h * w, h**2 * k2 * slope, k1 * sp.sqrt(slope)

    def solution(following: sp.Expr, root: sp.Expr) -> tuple[sp.Expr, sp.Expr]:
        return following - root_gain * root + (following - w if compensated else 0), following

    def beyond(side: int) -> tuple[sp.Expr, sp.Expr]:
        excess = side * q - limit
        root = 2 * excess / (h * root_gain + sp.sqrt((h * root_gain) ** 2 + 4 * excess))
        return solution(w - side * h * k2 * slope, side * root)

    branches = zip(beyond(1), beyond(-1), solution(w - q / h, sp.S.Zero), strict=True)
    rate, following = (
        sp.Piecewise((above, q > limit), (below, q < -limit), (within, True)) for above, below, within in branches
    )
    return rate, following
