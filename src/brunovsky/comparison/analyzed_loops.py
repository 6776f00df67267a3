"""Linear analysis of the laws of a study: each law's linear part, and the law within its boundary layer."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from brunovsky._frozen import FrozenMapping
from brunovsky.analysis import (
    DiskMargin,
    Margins,
    bandwidth,
    boundary_layer_gain,
    closed_loop_poles,
    disk_margin,
    loop_transfer,
    margins,
    matched_disturbance_bound,
    sliding_gain,
    step_information,
    surface_poles,
)
from brunovsky.comparison.facts import given
from brunovsky.comparison.study import PlannedRun, Study
from brunovsky.errors import ParameterError

Poles = NDArray[np.complex128]


@dataclass(frozen=True, eq=False)
class AnalyzedLoop:
    """One chain under v = -K e, cut at v. All but gain and poles are None where the loop is not stable.

    Attributes
    ----------
    gain : ndarray, shape (3,)
        K (1/s3, 1/s2, 1/s).
    poles : ndarray of complex, shape (3,)
        Of the closed loop (1/s).
    stable : bool
        Whether all of them lie in the left half-plane.
    margins : Margins or None
        Gain, phase, delay, lags and Ms; see `brunovsky.analysis.margins`.
    disk_margin : DiskMargin or None
        Gain and phase varied together; see `brunovsky.analysis.disk_margin`.
    bandwidth : float or None
        From set point to position (rad/s).
    step : mapping or None
        See `brunovsky.analysis.step_information` (s, %).
    """

    gain: NDArray[np.float64]
    poles: Poles
    stable: bool
    margins: Margins | None
    disk_margin: DiskMargin | None
    bandwidth: float | None
    step: Mapping[str, Any] | None

    def response(self, frequency: NDArray[np.float64]) -> NDArray[np.complex128]:
        """L(j w) at frequencies w (rad/s)."""
        return np.asarray(loop_transfer(self.gain)(1j * frequency), dtype=np.complex128)


@dataclass(frozen=True, eq=False)
class AnalyzedLaw:
    """One law of a study, for the scenarios in which its numbers are the same.

    Attributes
    ----------
    law, kind : str
        Its name and kind in the study.
    scenarios : tuple of str
        Where it has these numbers.
    C, Q, P, phi : tuple of float and float
        Surface (1/s2, 1/s, 1), reaching rate (1/s), switching gain (m/s3), half-width of the boundary layer (m/s2).
    surface_poles : ndarray of complex, shape (2,)
        Of the motion on S = 0 (1/s).
    matched_disturbance_bound : float
        What P rejects at the level of v on each axis (m/s3).
    linear_part : AnalyzedLoop
        With P = 0.
    boundary_layer : AnalyzedLoop or None
        With Q + P/phi for Q; None for a law without a boundary layer.
    """

    law: str
    kind: str
    scenarios: tuple[str, ...]
    C: tuple[float, ...]
    Q: float
    P: float
    phi: float
    surface_poles: Poles
    matched_disturbance_bound: float
    linear_part: AnalyzedLoop
    boundary_layer: AnalyzedLoop | None


def analyzed_laws(study: Study) -> tuple[AnalyzedLaw, ...]:
    """Every law of the paper's family that runs, once for each set of numbers that its scenarios give it."""
    found: dict[tuple[str, tuple[float, ...]], list[PlannedRun]] = {}
    for run in family_runs(study):
        found.setdefault((run.law, law_numbers(run)), []).append(run)
    order = [law.name for law in study.laws]
    return tuple(
        _law(study, name, found[name, key]) for name, key in sorted(found, key=lambda one: order.index(one[0]))
    )


def family_runs(study: Study) -> tuple[PlannedRun, ...]:
    """Runs of a study under laws of the paper's family, which this analysis knows."""
    return tuple(run for run in study.plan() if run.in_family)


def laws_outside(study: Study) -> tuple[str, ...]:
    """Laws of a study that are of another kind, and are not analysed."""
    return tuple(law.name for law in study.laws if not law.in_family)


def law_numbers(run: PlannedRun) -> tuple[float, ...]:
    """C[1], C[2], C[3], Q, P and phi of a run."""
    return tuple(run.parameters[name] for name in ("C[1]", "C[2]", "C[3]", "Q", "P", "phi"))


def gains(run: PlannedRun, kind: str) -> dict[str, tuple[float, ...]]:
    """K of the linear loops of a run: ``linear_part``, and ``boundary_layer`` where the law has one."""
    *C, Q, P, phi = law_numbers(run)
    found = {"linear_part": tuple(sliding_gain(C, Q).tolist())}
    if kind == "saturation":
        found["boundary_layer"] = tuple(boundary_layer_gain(C, Q, P, phi).tolist())
    return found


def _law(study: Study, name: str, runs: list[PlannedRun]) -> AnalyzedLaw:
    kind = study.law(name).kind
    *C, Q, P, phi = law_numbers(runs[0])
    loops = {key: analyzed_loop(gain) for key, gain in gains(runs[0], kind).items()}
    return AnalyzedLaw(
        law=name,
        kind=kind,
        scenarios=tuple(run.scenario for run in runs),
        C=tuple(C),
        Q=Q,
        P=P,
        phi=phi if kind == "saturation" else 0.0,
        surface_poles=np.asarray(surface_poles(C)),
        matched_disturbance_bound=matched_disturbance_bound(C, P),
        linear_part=loops["linear_part"],
        boundary_layer=loops.get("boundary_layer"),
    )


def loops_by_name(laws: Sequence[AnalyzedLaw]) -> dict[str, AnalyzedLoop]:
    """Linear loops of laws by a name for people, each gain once."""
    found: dict[tuple[float, ...], tuple[str, AnalyzedLoop]] = {}
    parts = {(law.C, law.Q) for law in laws}
    for law in laws:
        where = "" if len(parts) == 1 else f", C = [{', '.join(map(given, law.C))}], Q = {given(law.Q)}"
        pairs = ((f"P = 0{where}", law.linear_part), (f"{law.law}, in its boundary layer{where}", law.boundary_layer))
        for name, loop in pairs:
            if loop is not None:
                found.setdefault(tuple(loop.gain.tolist()), (name, loop))
    return dict(found.values())


@lru_cache(maxsize=64)
def analyzed_loop(gain: tuple[float, ...]) -> AnalyzedLoop:
    """Poles of one chain under v = -K e and, where it is stable, its margins and its answer to a set point."""
    K, poles = np.array(gain), np.asarray(closed_loop_poles(gain))
    try:
        found = margins(gain)
    except ParameterError:
        return AnalyzedLoop(K, poles, False, None, None, None, None)
    disk = disk_margin(loop_transfer(gain))
    return AnalyzedLoop(K, poles, True, found, disk, bandwidth(gain), FrozenMapping(step_information(gain)))
