"""A sampled and held switching law: its exact discrete model, symmetric limit cycles, and chatter band."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from brunovsky.analysis._checks import finite_scalar
from brunovsky.analysis.chatter.limit_cycles import LimitCycle, predicted_cycles, require_switching
from brunovsky.analysis.chatter.switching_loop import SwitchingLoop
from brunovsky.errors import ParameterError

Array = NDArray[np.float64]

_LONGEST = 20_000  # samples of a half period
_ILL_CONDITIONED = 1e12


@dataclass(frozen=True, eq=False)
class SampledModel:
    """Exact model of the sampled loop, X[k+1] = A X[k] + B f[k], S[k] = C X[k].

    Attributes
    ----------
    A, B, C : ndarray, shape (N, N), (N,) and (N,)
        X holds the errors, the lags' outputs and the values of v still on their way; the linear feedback is closed.
    between : ndarray, shape (J, N)
        S at J instants after the sample, as a function of X[k].
    between_f : ndarray, shape (J,)
        The same, of f[k].
    """

    A: Array
    B: Array
    C: Array
    between: Array
    between_f: Array


def sampled_model(loop: SwitchingLoop, instants: int = 16) -> SampledModel:
    """Exact discrete model of a loop whose v is computed every period and held.

    Parameters
    ----------
    loop : SwitchingLoop
        With a sampling period.
    instants : int
        Number J of instants in a period at which S is given.

    Returns
    -------
    SampledModel

    Raises
    ------
    ParameterError
        If the loop is not sampled.

    References
    ----------
    K. J. Åström and B. Wittenmark, *Computer-Controlled Systems*, 3rd ed., Prentice Hall, 1997, section 2.3.
    """
    h = _period(loop, "sampled_model")
    A, B = loop.actuated_chain()
    size = B.size
    whole = int(np.floor(loop.delay / h * (1.0 + 1e-12)))
    rest = max(loop.delay - whole * h, 0.0)
    rest = rest if rest > 1e-12 * h else 0.0
    waiting = whole + (1 if rest else 0)
    steps = np.arange(1, instants + 1) * h / instants
    # response to X and to the new v: columns x, v[k-1], ..., v[k-waiting], v[k]
    blocks = np.array([_held_response(A, B, t, rest, whole, waiting) for t in steps])
    shift = np.zeros((waiting, size + waiting + 1))
    if waiting:
        shift[0, -1] = 1.0
        shift[1:, size : size + waiting - 1] = np.eye(waiting - 1)
    step = np.vstack([blocks[-1], shift])
    law = np.zeros(size + waiting)
    law[: loop.order] = -loop.gain
    C = np.zeros(size + waiting)
    C[: loop.order] = loop.surface
    switching = -loop.switching_gain / loop.surface[-1]
    surface = blocks[:, : loop.order].transpose(0, 2, 1) @ np.asarray(loop.surface)
    return SampledModel(
        A=step[:, :-1] + np.outer(step[:, -1], law),
        B=switching * step[:, -1],
        C=C,
        between=surface[:, :-1] + np.outer(surface[:, -1], law),
        between_f=switching * surface[:, -1],
    )


def sampled_cycles(loop: SwitchingLoop) -> tuple[LimitCycle, ...]:
    """Exact symmetric limit cycles of a sampled relay: its half periods are whole numbers of samples.

    Several may exist side by side, each with its own basin: the relay sees S only at the samples, so a small
    perturbation doesn't move the switchings, and a cycle is stable where the linear part is.

    Parameters
    ----------
    loop : SwitchingLoop
        With a sampling period, P > 0 and no boundary layer.

    Returns
    -------
    tuple of LimitCycle
        In ascending order of amplitude, which includes what S does between the samples.

    Raises
    ------
    ParameterError
        If P is zero, the loop is not sampled or the element is no relay.

    References
    ----------
    Ya. Z. Tsypkin, *Relay Control Systems*, Cambridge University Press, 1984.
    """
    where = "sampled_cycles"
    require_switching(loop, where)
    h = _period(loop, where)
    if loop.boundary_layer > 0.0:
        raise ParameterError(f"{where}: a boundary layer is no relay; pass phi = 0, or use predicted_cycles")
    model = sampled_model(loop)
    slowest = min((one.frequency for one in predicted_cycles(loop)), default=np.pi / (32.0 * h))
    longest = int(3.0 * np.pi / (slowest * h)) + 4
    if longest > _LONGEST:
        raise ParameterError(
            f"{where}: a half period may last {longest} samples of {h:g} s; so short a period is as good as none: pass "
            "sampling=None"
        )
    powers, totals = _free_and_forced(model, longest)
    stable = bool(np.max(np.abs(np.linalg.eigvals(model.A))) < 1.0)
    cycles = []
    for samples in range(1, len(powers)):
        whole = np.eye(model.B.size) + powers[samples]
        if np.linalg.cond(whole) > _ILL_CONDITIONED:
            continue
        X = totals[:samples] - powers[:samples] @ np.linalg.solve(whole, totals[samples])
        S = X @ model.C
        if S[0] > loop.hysteresis and np.min(S) > -loop.hysteresis:
            values = X @ model.between.T + model.between_f
            cycles.append(_cycle(values.ravel(), np.pi / (samples * h), stable))
    return tuple(sorted(cycles, key=lambda one: one.amplitude))


def _free_and_forced(model: SampledModel, longest: int) -> tuple[Array, Array]:
    """A^k and the sum of A^i B over i < k, for k from 0 to `longest`, or as far as they stay in range."""
    powers, totals = [np.eye(model.B.size)], [np.zeros_like(model.B)]
    while len(powers) <= longest and np.max(np.abs(powers[-1])) < _ILL_CONDITIONED:
        totals.append(model.A @ totals[-1] + model.B)
        powers.append(model.A @ powers[-1])
    return np.array(powers), np.array(totals)


def sampled_chatter_band(reaching_rate: float, switching_gain: float, step: float) -> float:
    """Half-width of the steady chatter band of S[k+1] = S[k] - h (Q S[k] + P sign(S[k])): h P/(2 - h Q).

    The explicit scheme of S' = -Q S - P sign(S), which a chain of one integrator under a held v follows exactly: S ends
    in the cycle of two samples +-a with a (2 - h Q) = h P. With Q = 0 the cycle may be off-centre, half of peak to peak
    is the same. A longer chain adds what its other feedback does within a period: see `sampled_cycles`.

    Parameters
    ----------
    reaching_rate, switching_gain : float
        Q >= 0 (1/s) and P >= 0 (unit of S per second).
    step : float
        h > 0 (s), with h Q < 2.

    Returns
    -------
    float
        Half of peak to peak of S (unit of S).

    Raises
    ------
    ParameterError
        If a number is not finite or out of its range, or h Q >= 2, where the scheme diverges.

    References
    ----------
    W. Gao, Y. Wang and A. Homaifa, "Discrete-time variable structure control systems", IEEE Trans. Ind. Electron.
    42(2), 117-122, 1995.
    """
    where = "sampled_chatter_band"
    Q = finite_scalar(reaching_rate, "Q", where, minimum=0.0)
    P = finite_scalar(switching_gain, "P", where, minimum=0.0)
    h = finite_scalar(step, "step", where, minimum=0.0, strict=True)
    if h * Q >= 2.0:
        raise ParameterError(f"{where}: h Q = {h * Q:g} makes the explicit scheme diverge; pass step < {2.0 / Q:g}")
    return h * P / (2.0 - h * Q)


def _cycle(half: Array, frequency: float, stable: bool) -> LimitCycle:
    angle = np.pi * np.arange(1, half.size + 1) / half.size
    fundamental = float(2.0 * np.abs(np.mean(half * np.exp(-1j * angle))))
    return LimitCycle(float(np.max(np.abs(half))), frequency, fundamental, stable, "sampled relay")


def _held_response(A: Array, B: Array, t: float, rest: float, whole: int, waiting: int) -> Array:
    """Response of x after t to (x, v[k-1], ..., v[k-waiting], v[k]), shape (size, size + waiting + 1)."""
    size = B.size
    response = np.zeros((size, size + waiting + 1))
    response[:, :size] = expm(A * t)
    column = {0: size + waiting}  # of v[k - i]
    column.update({i: size + i - 1 for i in range(1, waiting + 1)})
    if rest:
        early = min(t, rest)
        response[:, column[whole + 1]] += expm(A * (t - early)) @ held_input(A, B, early)
    if t > rest:
        response[:, column[whole]] += held_input(A, B, t - rest)
    return response


def held_input(A: Array, B: Array, t: float) -> Array:
    """Integral of exp(A s) B over s from 0 to t."""
    augmented = np.zeros((B.size + 1, B.size + 1))
    augmented[:-1, :-1], augmented[:-1, -1] = A * t, B * t
    return np.asarray(expm(augmented)[:-1, -1])


def _period(loop: SwitchingLoop, where: str) -> float:
    if loop.sampling is None:
        raise ParameterError(f"{where}: the law is continuous; pass a SwitchingLoop with a sampling period")
    return loop.sampling
