"""Linear loops of a study's runs, cut at v, with the hardware that stands there in each scenario."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, minimize_scalar

from brunovsky.analysis import SwitchingLoop
from brunovsky.comparison.analyzed_loops import analyzed_laws, family_runs, gains, loops_by_name
from brunovsky.comparison.chain_hardware import chain_hardware, chain_loop
from brunovsky.comparison.study import Study
from brunovsky.errors import ParameterError

_POINTS = 3000  # of the frequency response in which margins are looked for


@dataclass(frozen=True)
class ResponseMargins:
    """Margins that are read from a frequency response; see :class:`brunovsky.analysis.Margins`."""

    gain_lower: float
    gain_upper: float
    phase: float
    gain_crossover: float
    modulus: float


@dataclass(frozen=True)
class LoopCurve:
    """A linear loop of one chain behind its hardware; `switching` is 0, or 1/phi within a boundary layer."""

    loop: SwitchingLoop
    switching: float = 0.0

    def response(self, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
        """L(j w) at frequencies w (rad/s); not-a-number beyond half of the sampling frequency."""
        top = np.inf if self.loop.sampling is None else np.pi / self.loop.sampling
        return np.where(frequency <= top, self.loop.loop_response(frequency, self.switching), np.nan)

    @cached_property
    def margins(self) -> ResponseMargins | None:
        """None where the closed loop is not stable, or rests on the edge."""
        if self.loop.unstable_poles(self.switching):
            return None
        w = self.loop.frequencies(_POINTS)
        response = self.loop.loop_response(w, self.switching)
        at = partial(self.loop.loop_response, switching=self.switching)
        crossovers = _roots(lambda one: float(np.log(np.abs(at(one)))), w, np.log(np.abs(response)))
        turns = [at(one) for one in _roots(lambda one: float(np.imag(at(one))), w, response.imag)]
        factors = [-1.0 / float(one.real) for one in turns if one.real < 0.0]
        if not crossovers:
            return None
        phases = [float(np.angle(-at(one))) for one in crossovers]
        nearest = int(np.argmin(np.abs(phases)))
        close = int(np.argmin(np.abs(1.0 + response)))
        ends = w[max(close - 1, 0)], w[min(close + 1, w.size - 1)]
        least = minimize_scalar(lambda one: float(np.abs(1.0 + at(one))), bounds=ends, method="bounded")
        return ResponseMargins(
            gain_lower=max((one for one in factors if one < 1.0), default=0.0),
            gain_upper=min((one for one in factors if one > 1.0), default=float("inf")),
            phase=phases[nearest],
            gain_crossover=crossovers[nearest],
            modulus=min(float(least.fun), 1.0),
        )


def _roots(function: Callable[[float], float], w: NDArray[np.float64], values: NDArray[np.float64]) -> list[float]:
    """Zeros of a function (rad/s) between points of a grid at which its values have different signs."""
    cells = np.flatnonzero(np.signbit(values[:-1]) != np.signbit(values[1:]))
    return [float(brentq(function, w[k], w[k + 1], rtol=1e-12)) for k in cells]


def loop_curves(study: Study) -> dict[str, dict[str, LoopCurve]]:
    """For each linear loop by its name, its curve for each hardware by its words, in the order of the scenarios.

    Left out are loops that are unstable without hardware, and runs whose two commands have different hardware.
    """
    known = loops_by_name(analyzed_laws(study))
    names = {tuple(loop.gain.tolist()): name for name, loop in known.items() if loop.stable}
    kinds = {law.name: law.kind for law in study.laws}
    found: dict[str, dict[str, LoopCurve]] = {name: {} for name in names.values()}
    for run in family_runs(study):
        hardware = chain_hardware(run)
        for part, gain in gains(run, kinds[run.law]).items():
            if hardware is None or gain not in names:
                continue
            try:
                loop = chain_loop(run, hardware, 0.0)
            except ParameterError:  # a surface that is all but undamped
                continue
            switching = 1.0 / run.parameters["phi"] if part == "boundary_layer" else 0.0
            found[names[gain]].setdefault(hardware.text, LoopCurve(loop, switching))
    return {name: curves for name, curves in found.items() if curves}
