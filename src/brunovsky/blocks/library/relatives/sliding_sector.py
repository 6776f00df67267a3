"""Variable structure control with a sliding sector: no control while the norm of the error decreases by itself."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS
from brunovsky.blocks.variables import Check, Mode, Output, Parameter, Transition
from brunovsky.errors import ParameterError

_ORDER = ROBOT_CHAINS.orders[0]
_WEIGHTS = (4096.0, 512.0, 16.0)
_K = Parameter("K", "1/s", "rate at which s decays while the control is on", 60.0, 0.0, tunable=True)
_INNER = Parameter("inner", "1", "ratio of the inner sector to the sector", 0.5, 0.0, 0.9)


def sliding_sector(weights: Sequence[float] = _WEIGHTS, ratio: float = 0.5) -> Block:
    """Sliding-sector law: v_i = zd3_i inside the sector, v_i = zd3_i - (S A e_i + K s_i)/(S b) outside, s_i = S e_i.

    With Q = diag(weights), P from the Riccati equation A'P + PA - P b b'P + Q = 0 of one chain, and S = b'P, the
    derivative of e'Pe without control is s^2 - e'Qe. So in the sector s^2 <= (1 - ratio) e'Qe the norm of the error
    decreases by itself, at least as -ratio e'Qe, and nothing is done. Outside the control makes s' = -K s, which
    brings the error into the inner sector, s^2 <= inner^2 (1 - ratio) e'Qe, where it is switched off (mode
    ``active[i]``); the two boundaries keep it from chattering. Outside the norm decreases as well, as -e'Qe or faster,
    if K >= S b/2 + sqrt(S A D^-1 A'S')/inner with D = (1 - ratio) Q (checked; derived here).

    Needs that K and the chains without disturbances; rejects none by construction, since within the sector nothing is
    done. Needs eta[1] != 0 for the inner loop. Tracks, and regulates the position but not the heading.

    Parameters
    ----------
    weights : sequence of float, shape (3,)
        Diagonal of Q, for position, velocity and acceleration error, in 1/s6, 1/s4, 1/s2; positive.
    ratio : float
        Between 0 and 1, without them: the share of Q that is left as rate of decrease, R = ratio Q.

    Raises
    ------
    ParameterError
        If ``weights`` or ``ratio`` are not numbers in range, or the equation has no solution for them.

    References
    ----------
    Reference [14] of the paper is taken to be K. Furuta and Y. Pan, Variable structure control with sliding sector,
    Automatica 36 (2000) 211-228. Sector, inner and outer sector as in Y. Pan and K. Furuta, Second-order sliding
    sector for variable structure control, in: Modern Sliding Mode Control Theory, LNCIS 375, Springer 2008, 97-118.
    Their exact law outside the sector could not be had; this one is the standard law of the class.
    """
    q, share = _checked(weights, ratio)
    gain = _sector_gain(q)
    modes = {i: Mode(f"active[{i}]", "1", f"1 while the control of chain {i} is on") for i in ROBOT_CHAINS.numbers}
    surface, width, law = {}, {}, {}
    for i in ROBOT_CHAINS.numbers:
        e = ROBOT_CHAINS.error(i)
        surface[i] = sum(a * b for a, b in zip(gain, e, strict=True))
        width[i] = sum((1 - share) * weight * one**2 for weight, one in zip(q, e, strict=True))
        drift = sum(a * b for a, b in zip(gain[:-1], e[1:], strict=True))
        control = -(drift + _K.symbol * surface[i]) / gain[-1]
        law[i] = ROBOT_CHAINS.feedforward(i) + sp.Piecewise((control, sp.Eq(modes[i].symbol, 1)), (0, True))
    bound = math.sqrt(sum(a**2 / ((1 - share) * weight) for a, weight in zip(gain[:-1], q[1:], strict=True)))
    return Block(
        "sliding_sector",
        "variable structure control with a sliding sector",
        inputs=ROBOT_CHAINS.inputs,
        parameters=(_K, _INNER),
        modes=tuple(modes.values()),
        outputs=(
            *ROBOT_CHAINS.outer_inputs(law),
            *(Output(f"S[{i}]", "m/s3", f"sliding variable of chain {i}", surface[i]) for i in ROBOT_CHAINS.numbers),
            *(Output(one.name, one.unit, one.description, one.symbol) for one in modes.values()),
        ),
        transitions=tuple(
            transition
            for i, mode in modes.items()
            for transition in (
                Transition(
                    f"leaves_sector_{i}",
                    sp.And(sp.Eq(mode.symbol, 0), surface[i] ** 2 > width[i]),
                    {mode.symbol: sp.S.One},
                ),
                Transition(
                    f"enters_inner_sector_{i}",
                    sp.And(sp.Eq(mode.symbol, 1), surface[i] ** 2 <= _INNER.symbol**2 * width[i]),
                    {mode.symbol: sp.S.Zero},
                ),
            )
        ),
        checks=(
            Check(
                "sector",
                _K.symbol * _INNER.symbol >= gain[-1] / 2 * _INNER.symbol + bound,
                f"outside the sector the norm decreases for K >= {gain[-1] / 2:.4g} 1/s + ({bound:.4g} 1/s)/inner "
                "only; set a larger K, or an inner sector nearer to the sector",
            ),
        ),
    )


def _checked(weights: Sequence[float], ratio: float) -> tuple[list[float], float]:
    try:
        q, share = [float(one) for one in weights], float(ratio)
    except (TypeError, ValueError):
        raise ParameterError(f"sliding_sector: weights = {weights!r}, ratio = {ratio!r} are not numbers") from None
    if len(q) != _ORDER or not all(math.isfinite(one) and one > 0 for one in q):
        raise ParameterError(f"sliding_sector: weights = {q} must be {_ORDER} positive numbers, the diagonal of Q")
    if not 0 < share < 1:
        raise ParameterError(f"sliding_sector: ratio = {share} must lie between 0 and 1, without them; take 0.5, say")
    return q, share


def _sector_gain(weights: Sequence[float]) -> list[float]:
    """S = b'P of a chain of integrators, P from the Riccati equation with Q = diag(weights) and R = 1."""
    from scipy.linalg import solve_continuous_are  # here, since it is slow to import

    shift, last = np.eye(_ORDER, k=1), np.eye(_ORDER)[:, -1:]
    try:
        with np.errstate(all="ignore"):
            P = solve_continuous_are(shift, last, np.diag(weights), np.eye(1))
    except np.linalg.LinAlgError as error:
        raise ParameterError(
            f"sliding_sector: no solution of the Riccati equation for weights = {list(weights)} ({error}); "
            "choose weights nearer to each other"
        ) from error
    return [float(one) for one in P[-1]]
