"""How far from rest a switching loop may start and still end in its stable limit cycle."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import expm

from brunovsky.analysis._checks import finite_scalar, finite_vector
from brunovsky.analysis.chatter.sampled_relay import held_input
from brunovsky.analysis.chatter.simulated_cycle import simulated_cycle
from brunovsky.analysis.chatter.switching_loop import SwitchingLoop
from brunovsky.errors import ParameterError

_DOUBLINGS = 60


def cycle_state(loop: SwitchingLoop, frequency: float) -> NDArray[np.float64]:
    """State of the chain and its lags where a symmetric cycle of the given frequency switches up.

    x = -(I + exp(A h))^-1 (integral of exp(A s) b over a half period h), with A the closed linear part: a fixed point
    of the half period with its sign reversed. It is on a trajectory of the loop only at a frequency of `relay_cycles`.

    Parameters
    ----------
    loop : SwitchingLoop
        Continuous, without delay.
    frequency : float
        w > 0 (rad/s).

    Returns
    -------
    ndarray, shape (n + m,)
        The n errors and the outputs of the m lags, as `simulated_cycle` takes them.

    Raises
    ------
    ParameterError
        If the loop has a delay or is sampled, or `frequency` is not positive.

    References
    ----------
    K. J. Åström, "Oscillations in systems with relay feedback", in *Adaptive Control, Filtering, and Signal
    Processing*, Springer, 1995.
    """
    w = finite_scalar(frequency, "frequency", "cycle_state", minimum=0.0, strict=True)
    if loop.delay > 0.0 or loop.sampling is not None:
        raise ParameterError(
            "cycle_state: a delay or a held law adds to the state; pass a continuous loop with lags only"
        )
    A, B = loop.actuated_chain()
    closed = A - np.outer(B, np.r_[loop.gain, np.zeros(len(loop.lags))])
    push = -loop.switching_gain / loop.surface[-1] * B
    half = np.pi / w
    whole = np.eye(B.size) + expm(closed * half)
    forced = held_input(closed, push, half)
    if not (np.all(np.isfinite(whole)) and np.all(np.isfinite(forced)) and np.linalg.cond(whole) < 1e14):
        raise ParameterError(f"cycle_state: there is no such cycle at frequency = {w:g}; pass one of relay_cycles")
    return np.asarray(-np.linalg.solve(whole, forced))


def basin_edge(loop: SwitchingLoop, direction: ArrayLike, tolerance: float = 1e-2) -> float:
    """Factor of a start up to which simulations stay bounded, by bisection.

    Where the linear part is unstable and a stable limit cycle exists, an unstable, larger one bounds its basin.

    Parameters
    ----------
    loop : SwitchingLoop
        Any.
    direction : array_like, shape (n,) or (n + m,)
        Start, as `simulated_cycle` takes it, of which multiples are tried. With a multiple tending to zero the response
        must be bounded.
    tolerance : float
        Relative width of the last bracket, in (0, 1).

    Returns
    -------
    float
        The factor; inf if no multiple up to 2^60 diverges, 0 if multiples down to 2^-60 do.

    Raises
    ------
    ParameterError
        If `direction` is no start, or `tolerance` is out of range.

    References
    ----------
    A. Gelb and W. E. Vander Velde, *Multiple-Input Describing Functions and Nonlinear System Design*, McGraw-Hill,
    1968, on unstable limit cycles as boundaries.
    """
    ray = finite_vector(direction, "direction", "basin_edge")
    width = finite_scalar(tolerance, "tolerance", "basin_edge", minimum=0.0, strict=True)
    if width >= 1.0:
        raise ParameterError(f"basin_edge: tolerance = {width:g} is no fraction; pass one below 1, such as 0.01")

    def bounded(factor: float) -> bool:
        return simulated_cycle(loop, factor * ray).outcome != "diverges"

    factor, first = 1.0, bounded(1.0)
    for _ in range(_DOUBLINGS):
        factor *= 2.0 if first else 0.5
        if bounded(factor) != first:
            break
    else:
        return float("inf") if first else 0.0
    low, high = (0.5 * factor, factor) if first else (factor, 2.0 * factor)
    while high > (1.0 + width) * low:
        middle = float(np.sqrt(low * high))
        low, high = (middle, high) if bounded(middle) else (low, middle)
    return float(np.sqrt(low * high))
