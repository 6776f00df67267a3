"""Cross-check of an engine's runs against the native simulation, and what the difference is made of."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from typing import Any, Literal

import numpy as np

from brunovsky.analysis.coupling.scheme import ORDERS
from brunovsky.comparison.engines import Outcome
from brunovsky.comparison.facts import given, number, spread
from brunovsky.comparison.protocol_section import Cell, Table
from brunovsky.comparison.study import PlannedRun
from brunovsky.comparison.study.signals import Array

POSITION_TOLERANCE = 1e-9  # m; below it two engines agree for every purpose of a study
HALVED = 0.6  # what first order leaves of an error at half the step, 1/2, with room for higher orders
_ON_SURFACE = 1e-9  # m/s2; a start this near S = 0 leaves the branch of a sign function to rounding
_SHOWN = (
    "and the native simulation are made from the same generated equations and the same solver: how near they are "
    "shows whether packaging and driving are right, and says nothing about the model or the integrator."
)
_TABLED = {"eta[1]": "m/s", "eta[2]": "rad/s", "u[1]": "m/s²", "u[2]": "rad/s²", "v[1]": "m/s³", "v[2]": "m/s³"}
Basis = Literal["rounding", "coupling", "models"]


@dataclass(frozen=True)
class Agreement:
    """Largest differences between an engine and the native simulation over one run.

    Attributes
    ----------
    run : str
        Name of the run.
    position : float or None
        Largest distance between the two positions (m) at their common instants; None if there is nothing to compare.
    differences : mapping of str to float
        Largest absolute difference of each recorded variable, in its unit.
    same_status : bool
        Whether both ended in the same way.
    explanation : str
        Why they may differ, where that is known; empty where they agree or no reason is known.
    basis : {"rounding", "coupling", "models"}
        What may make them differ: rounding alone; that components exchange values at communication points; or that a
        file of the user's own is another model.
    position_at_half_step : float or None
        `position` with half the communication step, m; for coupling alone.
    bound : float or None
        Bound of `position` to first order in the communication step, m; for coupling where it is known.
    differences_at_half_step : mapping of str to float
        `differences` with half the communication step; for coupling alone.
    """

    run: str
    position: float | None
    differences: dict[str, float]
    same_status: bool
    explanation: str
    basis: Basis = "rounding"
    position_at_half_step: float | None = None
    bound: float | None = None
    differences_at_half_step: dict[str, float] = field(default_factory=dict)

    @property
    def agrees(self) -> bool:
        """Whether both ended in the same way, and at most 1 nm apart all along or, coupled, ever less with the step."""
        return self.same_status and (self.position is None or self.position <= POSITION_TOLERANCE or self.shrinks)

    @property
    def shrinks(self) -> bool:
        """Whether half the communication step leaves at most 0.6 of the distance, as first order does."""
        return (
            self.position is not None
            and self.position_at_half_step is not None
            and self.position_at_half_step <= HALVED * self.position
        )

    def as_dict(self) -> dict[str, Any]:
        """The same as plain data, for JSON."""
        return asdict(self) | {"agrees": self.agrees}


def cross_check(
    planned: PlannedRun,
    outcome: Outcome,
    native: Outcome,
    *,
    basis: Basis = "rounding",
    finer: Outcome | None = None,
    bound: float | None = None,
) -> Agreement:
    """Compare a run with its native twin over the instants both reached; `finer` is it at half the communication step.

    Failures of coupled components and of other models need not fall on the same instant to be the same.
    """
    differences, position = _differences(outcome, native)
    same = outcome.status.state == native.status.state and (
        basis != "rounding" or abs((outcome.status.time or 0.0) - (native.status.time or 0.0)) < 1e-9
    )
    finer_differences, half = (
        _differences(finer, native) if finer is not None and finer.status.state == "ok" else ({}, None)
    )
    found = Agreement(planned.name, position, differences, same, "", basis, half, bound, finer_differences)
    apart = position is not None and position > POSITION_TOLERANCE
    return replace(found, explanation=_explanation(planned, native, found)) if apart and same else found


def _differences(outcome: Outcome, native: Outcome) -> tuple[dict[str, float], float | None]:
    """Largest difference of each variable at common instants, and of the position."""
    mine, other = common_instants(*(np.asarray(one.trajectory["time"]) for one in (outcome, native)))
    if not len(mine):
        return {}, None
    gaps = {
        str(name): np.asarray(outcome.trajectory[name].values[mine], dtype=float)
        - np.asarray(native.trajectory[name].values[other], dtype=float)
        for name in native.trajectory.data_vars
        if name in outcome.trajectory
    }
    return {name: float(np.max(np.abs(gap))) for name, gap in gaps.items()}, float(
        np.max(np.hypot(gaps["x"], gaps["y"]))
    )


def common_instants(first: Array, second: Array) -> tuple[Any, Any]:
    """Indices into two increasing series of instants (s) where they have the same, to a thousandth of the spacing."""
    if not (len(first) and len(second)):
        return np.empty(0, dtype=int), np.empty(0, dtype=int)
    spacing = min((float(np.min(np.diff(one))) for one in (first, second) if len(one) > 1), default=1e-6)
    near = np.minimum(np.searchsorted(second, first - 1e-3 * spacing), len(second) - 1)
    kept = np.flatnonzero(np.abs(second[near] - first) <= 1e-3 * spacing)
    return kept, near[kept]


def _explanation(planned: PlannedRun, native: Outcome, found: Agreement) -> str:
    if native.status.state == "diverged":
        return "the run diverges, and the differences with it"
    if found.basis == "models":
        return "a file of the study's own is another model than the native loop"
    relay = planned.parameters.get("P", 0.0) > 0.0 and planned.parameters.get("phi") == 0.0
    if found.basis == "coupling" and not found.shrinks:
        half = found.position_at_half_step
        left = "half the communication step fails" if half is None else f"{number(half)} m at half the step"
        return f"is not of first order in the communication step: {left}" + (
            "; the sign function switches at other instants" if relay else ""
        )
    starts = [abs(float(native.trajectory[name][0])) for name in ("S[1]", "S[2]") if name in native.trajectory]
    if relay and starts and max(starts) <= _ON_SURFACE and found.basis == "rounding":
        return "the run starts on S = 0, where rounding picks the branch of the sign function"
    return ""


def agreement_text(found: Sequence[Agreement], provenance: Mapping[str, Any]) -> str:
    """What the cross-check of a study's runs says, in a sentence or two."""
    positions = [one.position for one in found if one.position is not None]
    largest = number(max(positions, default=None))
    if found[0].basis == "coupling":
        halves = [one.position_at_half_step for one in found if one.position_at_half_step is not None]
        step = 1e3 * provenance["communication_step"]
        shrinking = sum(one.agrees for one in found)
        every = "in every run" if shrinking == len(found) else f"in {shrinking} of {len(found)} runs"
        return (
            "Each run was repeated by the native simulation, which solves the loop as one system. The two differ by "
            "the coupling error of the communication step: the largest distance between the two positions is "
            f"{largest} m at {given(step)} ms"
            + (f", and {number(max(halves))} m at half of it" if halves else "")
            + f"; {every} "
            f"half the step leaves at most {HALVED:g} of it, as an error of first order does.{_bounds_text(found)} "
            f"The FMUs of the package {_SHOWN}"
        )
    if found[0].basis == "models":
        return (
            "Each run was repeated by the native simulation of the package's own loop. The file of the study is a "
            "model of its own, so that this compares two models: the largest distance between the two positions is "
            f"{largest} m."
        )
    below = f", below the {number(POSITION_TOLERANCE, 1)} m that counts as agreement"
    agrees = all(one.agrees for one in found)
    return (
        "Each run was repeated by the native simulation. The largest distance between the two positions is "
        f"{largest} m{below if agrees else ''}. The FMU {_SHOWN}"
    )


def differences_table(found: Sequence[Agreement]) -> Table | None:
    """Largest differences of coupled runs from the native ones, at the communication step and half of it."""
    coupled = [one for one in found if one.basis == "coupling" and one.differences_at_half_step]
    if not coupled:
        return None
    rows: list[tuple[Cell, ...]] = [
        ("position", "m", *_halved([(one.position or 0.0, one.position_at_half_step or 0.0) for one in coupled]))
    ]
    for name, unit in _TABLED.items():
        pairs = [
            (one.differences[name], one.differences_at_half_step[name])
            for one in coupled
            if name in one.differences and name in one.differences_at_half_step
        ]
        rows += [(name, unit, *_halved(pairs))] if pairs else []
    columns = ("variable", "unit", "at the step", "at half of it", "ratio")
    caption = f"Largest difference from the native simulation, over {len(coupled)} runs that ended in all of these"
    return Table("differences", columns, tuple(rows), caption)


def _halved(pairs: Sequence[tuple[float, float]]) -> tuple[float, float, float | None]:
    whole, half = (max(values) for values in zip(*pairs, strict=True))
    return whole, half, half / whole if whole else None


def _bounds_text(found: Sequence[Agreement]) -> str:
    bounds = [(one.position, one.bound) for one in found if one.position is not None and one.bound is not None]
    if not bounds:
        return ""
    largest = number(max(bound for _, bound in bounds))
    kept = sum(position <= bound for position, bound in bounds)
    runs = f"{len(bounds)} run{'s' if len(bounds) > 1 else ''}"
    return (
        f" The bound of first order for components that step all at once, known for {runs}, is up to {largest} m and "
        f"is kept by {'all of them' if kept == len(bounds) else kept}."
    )


def coupling_headline(found: Sequence[Agreement], provenance: Mapping[str, Any]) -> str:
    """Size and order of the coupling error of runs through a package, or how far another model is; else empty."""
    positions = [one.position for one in found if one.position is not None]
    if not positions or found[0].basis == "rounding":
        return ""
    largest = number(max(positions))
    if found[0].basis == "models":
        return (
            f"The file of the study’s own and the native loop of the package are up to {largest} m apart in position."
        )
    pairs = [(one.position, one.position_at_half_step) for one in found if one.position and one.position_at_half_step]
    text = (
        f"Coupled {ORDERS[provenance['scheme']]} with inputs held and a communication step of "
        f"{given(1e3 * provenance['communication_step'])} ms, the runs are up to {largest} m in position from the loop "
        "as one system"
    )
    if pairs:
        orders = [math.log2(whole / half) for whole, half in pairs]
        text += (
            f", at half the step up to {number(max(half for _, half in pairs))} m: an error of order "
            f"{spread(orders, '')}".rstrip()
        )
    return f"{text}. All numbers of the runs contain it."


def engine_text(engine: str, provenance: Mapping[str, Any], found: Sequence[Agreement]) -> str:
    """What ran a study, in a sentence."""
    if engine == "native":
        return "Run by the native simulation, not through an FMU."
    if engine == "ssp":
        order = ORDERS[provenance["scheme"]]
        return (
            f"Run through the FMUs of {provenance['ssp']}, which exchange values every "
            f"{given(1e3 * provenance['communication_step'])} ms, {order}, and compared with the native simulation."
        )
    checked = ", and checked against the native simulation" if all(one.agrees for one in found) else ""
    return (
        f"Run through the FMU {provenance['fmu']} (FMI {provenance['fmi_version']}, co-simulation) with fmpy{checked}."
    )
