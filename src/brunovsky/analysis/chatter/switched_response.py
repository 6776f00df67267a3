"""Trajectories of a switching loop, to measure what the frequency domain predicts: nothing here is harmonic.

Each function yields pieces (t, S) of a trajectory without end. Without a delay the loop is piecewise linear and is
followed by matrix exponentials from one located switching to the next; with a delay the chain and its lags are exact
and v is averaged over each of many small steps; a sampled law is its exact discrete model.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.optimize import brentq

from brunovsky.analysis.chatter.sampled_relay import held_input, sampled_model
from brunovsky.analysis.chatter.switching_loop import SwitchingLoop

Array = NDArray[np.float64]
Piece = tuple[NDArray[np.floating[Any]], NDArray[np.floating[Any]]]

_BLOCK = 64  # steps that are taken at once
_ORDER = 10  # of the Taylor series in which a switching is located


def trajectory(loop: SwitchingLoop, start: Array) -> Iterator[Piece]:
    """Pieces (t, S) of the trajectory from the errors and lag outputs `start`, v having been 0 before.

    Ends only where a relay switches again within a fraction of the loop's fastest time constant: it slides.
    """
    if loop.sampling is not None:
        return _sampled(loop, start)
    return _delayed(loop, start) if loop.delay > 0.0 else _piecewise_linear(loop, start)


def _step(loop: SwitchingLoop) -> float:
    """Step (s) that is short for the modes of the loop, with and without its feedback, and for the element's width."""
    A, B = loop.actuated_chain()
    K = np.r_[loop.gain, np.zeros(len(loop.lags))]
    inner = K if loop.boundary_layer == 0.0 else K + _switching_row(loop) / loop.boundary_layer
    rates = [np.max(np.abs(np.linalg.eigvals(one))) for one in (A, A - np.outer(B, K), A - np.outer(B, inner))]
    if loop.hysteresis > 0.0:  # crossed no faster than by the integrators that W is at high frequency
        rates.append((loop.switching_gain / loop.hysteresis / np.prod(loop.lags)) ** (1.0 / (1 + len(loop.lags))))
    return float(0.1 / (max(rates) or 1.0 / (loop.dead_time or 1.0)))


def _switching_row(loop: SwitchingLoop) -> Array:
    """P/cn C, by which the states act on v in the boundary layer, times phi."""
    C = np.r_[loop.surface, np.zeros(len(loop.lags))]
    return np.asarray(loop.switching_gain / loop.surface[-1] * C)


class _Flow:
    """Linear flow of z = (x, 1) between two switchings, and the S between which it holds."""

    def __init__(self, A: Array, constant: Array, row: Array, step: float, low: float, high: float) -> None:
        size = constant.size
        self.matrix = np.zeros((size + 1, size + 1))
        self.matrix[:size, :size], self.matrix[:size, size] = A, constant
        one, powers = expm(self.matrix * step), [np.eye(size + 1)]
        for _ in range(_BLOCK):
            powers.append(one @ powers[-1])
        self.states = np.array(powers)
        self.row = np.r_[row, 0.0]
        self.samples = self.row @ self.states
        taylor = [np.eye(size + 1)]
        for k in range(1, _ORDER + 1):
            taylor.append(self.matrix @ taylor[-1] / k)
        self.taylor = np.array(taylor)[::-1]
        self.step, self.low, self.high = step, low, high

    def leaves(self, z: Array) -> tuple[Array, int]:
        """S at the steps, and the first of them at which the flow no longer holds (0: at none)."""
        S = self.samples @ z
        outside = (S[1:] < self.low) | (S[1:] > self.high)
        return S, int(np.argmax(outside)) + 1 if outside.any() else 0

    def locate(self, z: Array, above: bool) -> float | None:
        """Time within one step from z at which S passes the bound; None where it starts on it."""
        coefficients = self.taylor @ z @ self.row
        coefficients[-1] -= self.high if above else self.low
        first, last = coefficients[-1], np.polyval(coefficients, self.step)
        if first * last >= 0.0:
            return None
        return float(brentq(lambda t: np.polyval(coefficients, t), 0.0, self.step, xtol=1e-15 * self.step))

    def after(self, z: Array, t: float) -> Array:
        """State a part t of one step after z."""
        return np.asarray(np.polyval(self.taylor @ z, t))


def _piecewise_linear(loop: SwitchingLoop, start: Array) -> Iterator[Piece]:
    A, B = loop.actuated_chain()
    K = np.r_[loop.gain, np.zeros(len(loop.lags))]
    row = np.r_[loop.surface, np.zeros(len(loop.lags))]
    step, closed = _step(loop), A - np.outer(B, K)
    push = -loop.switching_gain / loop.surface[-1] * B
    phi, width = loop.boundary_layer, loop.hysteresis
    flows = {
        1: _Flow(closed, push, row, step, phi or -width, np.inf),
        -1: _Flow(closed, -push, row, step, -np.inf, -phi or width),
    }
    if phi > 0.0:
        flows[0] = _Flow(closed - np.outer(B, _switching_row(loop)) / phi, 0.0 * push, row, step, -phi, phi)
    z, time = np.r_[start, 1.0], 0.0
    S0 = float(row @ start)
    region = (1 if S0 >= 0.0 else -1) if abs(S0) >= phi else 0
    while True:
        flow = flows[region]
        S, exit_at = flow.leaves(z)
        if exit_at == 0:
            yield time + step * np.arange(_BLOCK), S[:-1]
            z, time = flow.states[-1] @ z, time + step * _BLOCK
            continue
        above = bool(S[exit_at] > flow.high)
        before = flow.states[exit_at - 1] @ z
        within = flow.locate(before, above)
        if within is None and phi == 0.0 and loop.switching_gain > 0.0:
            return  # back within a step: faster than any mode of the loop
        within = step if within is None else within
        yield time + step * np.arange(exit_at), S[:exit_at]
        z, time = flow.after(before, within), time + step * (exit_at - 1) + within
        region = -region if phi == 0.0 else region + (1 if above else -1)


def _delayed(loop: SwitchingLoop, start: Array) -> Iterator[Piece]:
    A, B = loop.actuated_chain()
    size, n = B.size, loop.order
    # without lags S has corners, at which its peaks are to be seen
    least = max(8 if loop.lags else 4 * _BLOCK, int(np.ceil(loop.delay / (0.3 * _step(loop)))))
    block = min(least, _BLOCK)
    blocks = -(-least // block)
    step = loop.delay / (blocks * block)
    one, response = expm(A * step), held_input(A, B, step)
    powers, kernel = [np.eye(size)], np.zeros((block + 1, size, block))
    for i in range(block):
        powers.append(one @ powers[-1])
        kernel[i + 1] = one @ kernel[i]
        kernel[i + 1, :, i] += response
    free = np.array(powers)
    waiting = np.zeros((blocks, block))
    x, time, branch = start, 0.0, 1.0 if float(np.dot(loop.surface, start[:n])) >= 0.0 else -1.0
    index = 0
    while True:
        states = free @ x + kernel @ waiting[index]
        S = states[:, :n] @ np.asarray(loop.surface)
        linear = -states[:, :n] @ loop.gain
        f, branch = _averaged(loop, S, branch)
        waiting[index] = 0.5 * (linear[1:] + linear[:-1]) - loop.switching_gain / loop.surface[-1] * f
        yield time + step * np.arange(block), S[:-1]
        x, time, index = states[-1], time + step * block, (index + 1) % blocks


def _averaged(loop: SwitchingLoop, S: Array, branch: float) -> tuple[Array, float]:
    """Average of f over each step between the samples of S, and the relay's branch at the end."""
    if loop.boundary_layer > 0.0:
        f = np.clip(S / loop.boundary_layer, -1.0, 1.0)
        return 0.5 * (f[1:] + f[:-1]), branch
    average = np.empty(S.size - 1)
    done = 0
    while done < average.size:
        crossed = branch * S[done + 1 :] < -loop.hysteresis
        if not crossed.any():
            average[done:] = branch
            break
        i = done + int(np.argmax(crossed))
        average[done:i] = branch
        share = np.clip((S[i] + branch * loop.hysteresis) / (S[i] - S[i + 1]), 0.0, 1.0)
        average[i] = branch * (2.0 * share - 1.0)
        branch, done = -branch, i + 1
    return average, branch


def _sampled(loop: SwitchingLoop, start: Array) -> Iterator[Piece]:
    h = loop.sampling or 0.0
    instants = int(np.clip(np.ceil(h / _step(loop)), 8, 64))
    model = sampled_model(loop, instants)
    X = np.r_[start, np.zeros(model.B.size - start.size)]
    f = 1.0 if model.C @ X >= 0.0 else -1.0
    offsets = h * np.arange(1, instants + 1) / instants
    k = 0
    while True:
        times, values = [], []
        with np.errstate(over="ignore", invalid="ignore"):  # what diverges is seen by its size
            for _ in range(_BLOCK):
                S = float(model.C @ X)
                if loop.boundary_layer > 0.0:
                    f = float(np.clip(S / loop.boundary_layer, -1.0, 1.0))
                elif f * S < -loop.hysteresis:
                    f = -f
                times.append(k * h + offsets)
                values.append(model.between @ X + model.between_f * f)
                X, k = model.A @ X + model.B * f, k + 1
        yield np.concatenate(times), np.concatenate(values)
