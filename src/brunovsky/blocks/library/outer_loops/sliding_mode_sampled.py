"""Sampled sliding mode: explicit, and implicit (proximal), which does not chatter."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, get_args

import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.gains import Gains, scalar_gains
from brunovsky.blocks.library.outer_loops.sampled_law import held_law, sampled_inputs, sampling_period, warned
from brunovsky.blocks.library.outer_loops.surface import (
    sliding_outputs,
    sliding_variables,
    surface_checks,
    surface_gains,
)
from brunovsky.blocks.library.outer_loops.surface_map import PERIOD, SurfaceMap, mean_rates, period_checks
from brunovsky.blocks.library.outer_loops.switching import (
    bound_of,
    gain_of_switching,
    known_option,
    with_sound_defaults,
)
from brunovsky.blocks.variables import Check, Clock
from brunovsky.errors import ModelError

Scheme = Literal["implicit", "explicit"]


def sliding_mode_sampled(
    chains: Chains | Block = ROBOT_CHAINS,
    surface: Sequence[ArrayLike] | None = None,
    *,
    Q: ArrayLike = 5.0,
    P: ArrayLike = 2.5,
    period: float = 0.01,
    scheme: Scheme = "implicit",
    surface_map: SurfaceMap = "euler",
    preview: bool = False,
    disturbance: ArrayLike | None = None,
) -> Block:
    """Sampled law that makes S[k+1] = (1 - h Q) S[k] - h P s, with s = sign(S[k]) or s in sign(S[k+1]); v is held.

    *Explicit*, S ends in a chatter band of half-width h P/(2 - h Q) and v switches by about 2 P at each sample.
    *Implicit*, the set-valued sign is solved in closed form: P s is (1 - h Q) S/h, limited to +-P. Once it is not
    limited, S[k+1] = 0 without chatter; a disturbance d at the level of v leaves S[k+1] = h b d, and v answers a sample
    later.

    How v moves S over a sample is taken by Euler's rule, as in the source (``surface_map="euler"``), or exactly from
    the integrals of the held v (``"exact"``). Conditions under which it works:

    * the linear part stays stable on the surface, v = y_d^(r) - (S/h + m e)/b: for the paper's C up to h = 57 ms by
      Euler's rule and 155 ms by the exact map, where the zeros of the sampled chain leave the unit circle
      (``brunovsky.analysis.largest_sampling_period``); beyond that the block is refused. Off the surface, and
      everywhere for the explicit scheme, Q takes the place of 1/h: with Euler's rule and Q = 5/s errors too large for P
      grow from 41 ms on, of which the implicit block warns and for which the explicit one is refused;
    * P > b D for disturbances up to D at the level of v, where b is the gain of v in the mean of S', a little above
      c_r; beyond that S is not held;
    * S = 0 at the samples to rounding needs the exact map and a reference known one sample ahead (``preview``), or a
      constant one; otherwise what the reference moves within a sample is left. Between samples S is not zero.

    Parameters
    ----------
    chains : Chains or Block
        The chains, or the linearised plant that has them; the robot's by default.
    surface : sequence of float, or one sequence per chain
        C = (c_1, ..., c_r), as for :func:`sliding_mode`.
    Q, P : float, or one per chain
        Gain of the exponential part (1/s) and of the switching part (unit of S per s).
    period : float
        Default of the fixed parameter ``sampling_period`` h, s.
    scheme : {"implicit", "explicit"}
        Whether the sign is that of the next sample or of this one.
    surface_map : {"euler", "exact"}
        Effect of v on S over a sample.
    preview : bool
        Whether the reference at the next sample is an input, ``Zid_next[k]``; :func:`preview` adds it to a reference.
        With the exact map only: Euler's rule errs in the chain as in the reference, and must not in one alone.
    disturbance : float, or one per chain, optional
        Stated bound D of the disturbance at the level of v, a parameter; P must exceed b D.

    Returns
    -------
    Block
        Inputs those of :class:`Chains` and ``Zid_next[k]`` with ``preview``; outputs ``v[i]``, held, and ``S[i]``, not
        sampled; parameters ``sampling_period``, ``C[k]``, ``Q``, ``P``, and ``D`` where it is stated.

    Raises
    ------
    ModelError
        If the numbers do not fit the chains, an option is unknown, or options do not go together.
    ParameterError
        If the surface is not stable, c_r zero, the period not positive or too long, or P too small for D.

    References
    ----------
    V. Acary and B. Brogliato, "Implicit Euler numerical scheme and chattering-free implementation of sliding mode
    systems", Systems & Control Letters 59(5), 284-293, 2010, doi:10.1016/j.sysconle.2010.03.002; exact map: B. Wang,
    X. Yu and G. Chen, "ZOH discretization effect on single-input sliding mode control systems with matched
    uncertainties", Automatica 45(1), 118-125, 2009, doi:10.1016/j.automatica.2008.05.028.
    """
    return sampled_sliding_mode(
        "sliding_mode_sampled",
        chains,
        surface,
        Q=Q,
        P=P,
        period=period,
        scheme=scheme,
        surface_map=surface_map,
        preview=preview,
        disturbance=disturbance,
    )


def sampled_sliding_mode(
    name: str,
    chains: Chains | Block,
    surface: Sequence[ArrayLike] | None,
    *,
    Q: ArrayLike,
    P: ArrayLike,
    period: float,
    scheme: Scheme,
    surface_map: SurfaceMap,
    preview: bool,
    disturbance: ArrayLike | None,
    clock: Clock | None = None,
) -> Block:
    """The block of :func:`sliding_mode_sampled` under this name, its samples those of the clock if there is one."""
    chains = Chains.of(chains)
    known_option("scheme", scheme, get_args(Scheme))
    known_option("surface_map", surface_map, get_args(SurfaceMap))
    if preview and surface_map != "exact":
        raise ModelError(
            f"{name}: preview gives the reference exactly, which Euler's rule for the chain spoils; choose "
            "surface_map='exact' as well"
        )
    c = surface_gains(chains, surface, name)
    q = scalar_gains(chains, "Q", Q, lambda i: "1/s", "gain of the exponential part of the reaching law", 0.0)
    p = gain_of_switching(chains, P)
    bound = bound_of(chains, disturbance)
    h = PERIOD.symbol
    variables = sliding_variables(chains, c)

    def reaching(i: int) -> sp.Expr:
        s, (rate,), (gain,) = variables[i], q[i], p[i]
        force = gain * sp.sign(s) if scheme == "explicit" else _limited((1 - h * rate) * s / h, gain)
        return -rate * s - force

    wanted = {i: reaching(i) for i in chains.numbers}
    samples, held = held_law(chains, wanted, c, surface_map, preview=preview, clock=clock)
    linear = (
        *(() if scheme == "explicit" else period_checks(c, surface_map)),
        *period_checks(c, surface_map, q=q, when="start" if scheme == "explicit" else "failure"),
    )
    block = with_sound_defaults(
        Block(
            name,
            f"sampled sliding-mode outer loop, {scheme}" + (", on a clock" if clock else ""),
            inputs=sampled_inputs(chains, preview=preview),
            parameters=(
                sampling_period(period, name),
                *c.parameters,
                *q.parameters,
                *p.parameters,
                *(bound.parameters if bound else ()),
            ),
            samples=samples,
            outputs=(*held, *sliding_outputs(chains, variables)),
            checks=(*surface_checks(c), *linear, *_bound_checks(c, p, bound)),
            clocks=(clock,) if clock else (),
        )
    )
    return warned(block, depth=4)


def _limited(value: sp.Expr, limit: sp.Expr) -> sp.Expr:
    """The element of limit sign(S+) that the proximal step picks."""
    return sp.Piecewise((limit, value > limit), (-limit, value < -limit), (value, True))


def _bound_checks(c: Gains, p: Gains, bound: Gains | None) -> tuple[Check, ...]:
    """P > b D, with the exact b, whatever the law takes for it."""
    if bound is None:
        return ()
    checks = {}
    for row, (gain,), (stated,) in zip(c.rows, p.rows, bound.rows, strict=True):
        b = mean_rates([one.symbol for one in row], PERIOD.symbol, "exact")[-1]
        checks[row, gain, stated] = Check(
            "switching gain",
            gain.symbol > sp.Abs(b) * stated.symbol,
            f"{gain.name} does not exceed b {stated.name}, where b is the gain of v in the mean of S' over a sample (a "
            f"little above {row[-1].name}), so that a disturbance within its stated bound drives S away; raise "
            f"{gain.name}, or state a smaller {stated.name}",
        )
    return tuple(checks.values())
