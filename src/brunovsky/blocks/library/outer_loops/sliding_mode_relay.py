"""Sliding-mode outer loop with a relay that has hysteresis and a minimum dwell time."""

from __future__ import annotations

from collections.abc import Sequence

import sympy as sp
from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.gains import Gains, scalar_gains
from brunovsky.blocks.library.outer_loops.reaching import exponential_gain
from brunovsky.blocks.library.outer_loops.surface import (
    sliding_outputs,
    sliding_variables,
    surface_checks,
    surface_gains,
    surface_law,
    surface_unit,
)
from brunovsky.blocks.library.outer_loops.switching import (
    bound_checks,
    bound_of,
    gain_of_switching,
    with_sound_defaults,
)
from brunovsky.blocks.variables import Check, Mode, Output, State, Transition, symbol

LEAST_TIME = 1e-6
"""Least time between two switches in model exchange, s; S crosses the hysteresis in 2 hysteresis/P."""


def sliding_mode_relay(
    chains: Chains | Block = ROBOT_CHAINS,
    surface: Sequence[ArrayLike] | None = None,
    *,
    Q: ArrayLike = 5.0,
    P: ArrayLike = 2.5,
    hysteresis: ArrayLike = 0.05,
    dwell: ArrayLike = 0.0,
    disturbance: ArrayLike | None = None,
) -> Block:
    """Sliding-mode law with S_i' = -Q S_i - P relay_i, a relay that keeps its value for a while: finite switching.

    relay_i goes to 1 where S_i > ``hysteresis``, to -1 where S_i < -``hysteresis``, and keeps each value for ``dwell``
    at least. It has an end of events and runs in model exchange too, where 2 ``hysteresis``/P, the time in which S
    crosses the hysteresis, or ``dwell`` is a microsecond at least. It does not come to rest, for P > Q ``hysteresis``:
    S cycles between +- ``hysteresis``, or further where the dwell time is what holds it, with the period of
    :func:`brunovsky.analysis.relay_cycle`; with fixed steps it switches up to one step late.

    Conditions: as for :func:`sliding_mode`: a stable surface, c_r != 0, and P above abs(c_r) times the disturbance at
    the level of v. The relay starts at 1 and switches at once where S_i < -``hysteresis`` at the start.

    Parameters
    ----------
    chains : Chains or Block
        The chains, or the linearised plant that has them; the robot's by default.
    surface : sequence of float, or one sequence per chain
        C = (c_1, ..., c_r), as for :func:`sliding_mode`.
    Q, P : float, or one per chain
        Gain of the exponential part (1/s) and of the relay (unit of S per s).
    hysteresis : float, or one per chain
        Half-width of the hysteresis (unit of S).
    dwell : float, or one per chain
        Minimum dwell time (s).
    disturbance : float, or one per chain, optional
        Stated bound D of the disturbance at the level of v (unit of v).

    Returns
    -------
    Block
        Inputs those of :class:`Chains`, outputs ``v[i]``, ``S[i]`` and ``relay[i]``; states ``timer[i]``, the time
        since the last switch; parameters ``C[k]``, ``Q``, ``P``, ``hysteresis``, ``dwell``, ``D`` if stated, or
        ``Ci[k]``, ``Q[i]``, ... where chains differ.

    Raises
    ------
    ModelError
        If the numbers do not fit the chains.
    ParameterError
        If a condition does not hold; the message names poles or gains, and the remedy.

    References
    ----------
    The paper's (20)-(23); relays with hysteresis in sliding mode: V. I. Utkin, "Variable structure systems with sliding
    modes", IEEE Trans. Autom. Control 22(2), 212-222, 1977, doi:10.1109/TAC.1977.1101446.
    """
    chains = Chains.of(chains)
    c = surface_gains(chains, surface, "sliding_mode_relay")
    q, p = exponential_gain(chains, Q), gain_of_switching(chains, P)
    band = scalar_gains(
        chains, "hysteresis", hysteresis, lambda i: surface_unit(chains, i), "half-width of the relay's hysteresis", 0.0
    )
    least = scalar_gains(chains, "dwell", dwell, lambda i: "s", "least time between two switches of a relay", 0.0)
    bound = bound_of(chains, disturbance)
    variables = sliding_variables(chains, c)
    relays = {i: symbol(f"relay[{i}]") for i in chains.numbers}
    law = {i: surface_law(chains, i, c[i], -q[i][0] * s - p[i][0] * relays[i]) for i, s in variables.items()}
    return with_sound_defaults(
        Block(
            "sliding_mode_relay",
            "sliding-mode outer loop with a relay that has hysteresis and dwell time",
            inputs=chains.inputs,
            parameters=tuple(one for group in (c, q, p, band, least, bound) if group for one in group.parameters),
            states=tuple(
                State(f"timer[{i}]", "s", f"time since relay {i} switched", sp.S.One, least[i][0]) for i in relays
            ),
            modes=tuple(Mode(f"relay[{i}]", "1", f"relay of chain {i}", start=1) for i in relays),
            outputs=(
                *chains.outer_inputs(law),
                *sliding_outputs(chains, variables),
                *(Output(f"relay[{i}]", "1", f"relay of chain {i}", one) for i, one in relays.items()),
            ),
            transitions=tuple(
                one for i, s in variables.items() for one in _switches(i, s, relays[i], band[i][0], least[i][0])
            ),
            checks=(
                *surface_checks(c),
                *bound_checks(p, bound, {i: c.rows[i - 1][-1] for i in chains.numbers}),
                *_idle_checks(q, p, band),
                *_endless_checks(band, least, p),
            ),
        )
    )


def _switches(i: int, s: sp.Expr, relay: sp.Symbol, band: sp.Symbol, dwell: sp.Symbol) -> tuple[Transition, Transition]:
    timer = symbol(f"timer[{i}]")
    rested = timer >= dwell
    return (
        Transition(f"up_{i}", sp.And(sp.Eq(relay, -1), s > band, rested), {relay: sp.S.One, timer: sp.S.Zero}),
        Transition(
            f"down_{i}", sp.And(sp.Eq(relay, 1), s < -band, rested), {relay: sp.S.NegativeOne, timer: sp.S.Zero}
        ),
    )


def _idle_checks(q: Gains, p: Gains, band: Gains) -> tuple[Check, ...]:
    rows = dict.fromkeys(zip(q.rows, p.rows, band.rows, strict=True))
    return tuple(
        Check(
            "relay at rest",
            sp.Or(sp.Eq(gain.symbol, 0), gain.symbol > rate.symbol * width.symbol),
            f"{gain.name} does not exceed {rate.name} {width.name}, so that S comes to rest within the hysteresis, "
            f"before the relay switches; raise {gain.name} or lower {width.name}",
        )
        for (rate,), (gain,), (width,) in rows
    )


def _endless_checks(band: Gains, dwell: Gains, p: Gains) -> tuple[Check, ...]:
    return tuple(
        Check(
            "sign function",
            sp.Or(time.symbol >= LEAST_TIME, 2 * width.symbol >= LEAST_TIME * gain.symbol, sp.Eq(gain.symbol, 0)),
            f"{width.name} and {time.name} let the relay switch more than once in {LEAST_TIME:g} s (as the sign "
            f"function does, with both at 0), which has no end of events in model exchange; raise {width.name} to "
            f"{gain.name} {LEAST_TIME / 2:g} s at least, or {time.name} to {LEAST_TIME:g} s, or set {gain.name} = 0, "
            "or use co-simulation, which samples it once an internal step",
            when="model exchange",
        )
        for (width,), (time,), (gain,) in dict.fromkeys(zip(band.rows, dwell.rows, p.rows, strict=True))
    )
