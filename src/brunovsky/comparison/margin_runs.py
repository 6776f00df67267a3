"""Margins of a study's laws: its scenario with other gains, delays, lags and sampling periods, simulated natively."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr

from brunovsky.analysis import (
    SteadyMotion,
    actuator_margins,
    boundary_layer_gain,
    longest_robot_sampling,
    sampled_sliding_gain,
    sliding_gain,
)
from brunovsky.blocks.library.outer_loops.surface_map import SurfaceMap
from brunovsky.comparison.engines import NativeSimulation, check_outcome
from brunovsky.comparison.growth import ROUNDING
from brunovsky.comparison.measured_margins import bounded_at_the_end
from brunovsky.comparison.metrics import instants, position_error, tail, values
from brunovsky.comparison.protocols.margins import MeasuredLoopMargins, margins_of
from brunovsky.comparison.study import Law, PlannedRun, Study
from brunovsky.comparison.study.loops import Hardware
from brunovsky.comparison.study.protocols import MarginsTable
from brunovsky.errors import BrunovskyError, ParameterError

ACTUATORS = {"u1": (1,), "u2": (2,), "both": (1, 2)}
_SURFACE_MAPS: Mapping[str, SurfaceMap] = {
    "sampled": "euler",
    "sampled_exact": "exact",
}  # of the laws that aim at S = 0 at the next sample
Prediction = tuple[float | None, float | None]


@dataclass(eq=False)
class _Changes:
    """Runs of a scenario with something changed at its actuators."""

    study: Study
    table: MarginsTable
    native: NativeSimulation
    progress: Callable[[int], None]
    count: int = 0

    def planned(self, law: str, cut: str, change: str, size: float) -> PlannedRun:
        """The run with one change of some size: a factor, or s."""
        hardware = self.study.scenario(self.table.scenario).resolved_hardware
        values: dict[str, float] = {}
        base = self.study.planned_case(self.table, self.study.law(law), {})
        if change == "gain":
            values = {f"rho[{k}]": size * base.parameters[f"rho[{k}]"] for k in ACTUATORS[cut]}
        else:
            hardware = _changed(hardware, cut, change, size)
            values = {f"{kind}[{k}]": size for kind in ("delay", "lag") if kind in change for k in ACTUATORS[cut]}
            if "lags" in change:
                values = {f"lag[{k}]": size for k in ACTUATORS[cut]}
            if change == "sampling":
                values = {"sampling_period": size, "controller.sampling_period": size}
        run = self.study.planned_case(self.table, self.study.law(law), {}, hardware=hardware)
        known = {one.name for one in run.loop.block.parameters}
        values = {name: value for name, value in values.items() if name in known}
        return replace(run, parameters=run.loop.block.parameter_values({**run.parameters, **values}))

    def stable_at_half_step(self, law: str, cut: str, change: str, size: float) -> bool:
        """The same with half of the step."""
        return self.stable(law, cut, change, size, 0.5)

    def stable(self, law: str, cut: str, change: str, size: float, share: float = 1.0) -> bool:
        """Whether the run ends within the bound, with this share of its step."""
        self.progress(self.count)
        self.count += 1
        try:
            run = self.planned(law, cut, change, size)
            run = replace(run, step_size=share * run.step_size)
            for failed in run.loop.block.failed_checks(run.parameters, "start"):
                raise ParameterError(failed.message)
            outcome = check_outcome(self.native.run(run), run)
        except BrunovskyError:  # a law that refuses what it is given doesn't stand it
            return False
        data = outcome.trajectory
        if outcome.status.state != "ok":
            return False
        time, error = instants(data), position_error(data)
        held = float(np.max(error[tail(time)])) <= self.table.bound_m  # what swings far may contract for a quarter
        still = self.table.still_m if _leaves_its_layer(run, data) else ROUNDING
        return held and bounded_at_the_end(time, error, self.table.bound_m, still)


def run_margins(
    study: Study, table: MarginsTable, native: NativeSimulation, progress: Callable[[int], None]
) -> MeasuredLoopMargins:
    """Measure the margins that a study asks for, beside those of the linear part along its scenario's motion."""
    changes = _Changes(study, table, native, progress)
    laws = study.laws_of_protocol(table)
    predictions: dict[tuple[str, str, str], Prediction] = {}
    for law in laws:
        planned = study.planned_case(table, law, {})
        for cut in table.cuts:
            found = predicted_margins(law, planned, cut)
            predictions |= {(law.name, cut, name): pair for name, pair in found.items()}
    return margins_of(
        changes.stable,
        [law.name for law in laws],
        table.cuts,
        table.changes,
        predictions,
        gains=(table.lowest_gain, table.highest_gain),
        times=(table.shortest_s, table.longest_s),
        bound=table.bound_m,
        tolerance=table.tolerance,
        still=table.still_m,
        finer=changes.stable_at_half_step,
    )


def predicted_margins(law: Law, planned: PlannedRun, cut: str) -> Mapping[str, Prediction]:
    """Margins by name of the linear part and of the boundary layer of a law along the scenario's motion.

    Empty where there is no such motion (a set point) or the law is none of the paper's surface.
    """
    p = planned.parameters
    if not {"C[1]", "C[2]", "C[3]", "Q"} <= set(p) or p.get("radius", 0.0) * p.get("rate", 0.0) == 0.0:
        return {}
    motion = SteadyMotion(p["radius"] * p["rate"], p["rate"])
    surface = [p[f"C[{k}]"] for k in (1, 2, 3)]
    if law.kind in _SURFACE_MAPS:  # known to the law, which aims at S = 0 after one period
        kind = _SURFACE_MAPS[law.kind]
        period = longest_robot_sampling(lambda h: sampled_sliding_gain(surface, h, surface_map=kind), motion)
        return {"sampling": (period, None)}
    layer = bool(law.in_family and p["P"] and p["phi"])
    gains = [sliding_gain(surface, p["Q"])]
    gains += [boundary_layer_gain(surface, p["Q"], p["P"], p["phi"])] if layer else []
    found = [
        vars(actuator_margins(gain, motion, ACTUATORS[cut])) | {"sampling": longest_robot_sampling(gain, motion)}
        for gain in gains
    ]
    return {name: (value, found[1][name] if layer else None) for name, value in found[0].items()}


def _leaves_its_layer(run: PlannedRun, data: xr.Dataset) -> bool:
    """Whether a law switches in the last quarter, and may chatter; within its layer a loop is linear."""
    if run.layer is None:
        return False
    last = tail(instants(data))
    return any(float(np.max(np.abs(values(data, name)[last]))) > run.layer for name in ("S[1]", "S[2]"))


def _changed(hardware: Hardware, cut: str, change: str, size: float) -> Hardware:
    """Hardware with a lag, a delay or sampling at a cut; its size is a parameter, so that a loop is made once."""
    if change == "sampling":
        return replace(hardware, period=_REPRESENTATIVE)
    pair = (_REPRESENTATIVE * (1 in ACTUATORS[cut]), _REPRESENTATIVE * (2 in ACTUATORS[cut]))
    if change == "delay":
        return replace(hardware, delays=pair)
    return replace(hardware, lags=pair, number=2 if change == "two_lags" else 1)


_REPRESENTATIVE = 0.01  # s; default of what is then set
