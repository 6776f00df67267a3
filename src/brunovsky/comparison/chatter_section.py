"""Chatter that the runs of a study show, beside what is predicted of it: a section of the report."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from brunovsky.analysis import (
    LimitCycle,
    predicted_cycles,
    predicted_robot_chatter,
    relay_cycles,
    sampled_chatter_band,
)
from brunovsky.comparison import drawing
from brunovsky.comparison.chain_hardware import STRAIGHT, chain_hardware, chain_loop
from brunovsky.comparison.facts import number, percent
from brunovsky.comparison.figures.predicted_chatter import predicted_chatter_figure
from brunovsky.comparison.growth import envelope, grows
from brunovsky.comparison.metrics import position_error, tail, values
from brunovsky.comparison.protocol_section import ProtocolSection, Table
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import MARK, both, converged
from brunovsky.comparison.study import Law, PlannedRun

CLOSE = 0.1  # relative error up to which a prediction is told to agree
AT_V, LOCUS, AT_U = "describing function at v", "relay locus at v", "describing function at u"
STEADY = 0.2  # relative change of S from quarter to quarter, and growth of the error, up to which chatter is steady
GROWING, DECAYING, STEP = "grows", "decays", "not converged"
STEPPED = "relay locus at v, half a step later"
SAMPLED = "map from sample to sample"


@dataclass(frozen=True)
class PredictedChatter:
    """One prediction for one run, beside what the run shows.

    Attributes
    ----------
    run : Run
        The run.
    source : str
        How it is predicted.
    frequency, amplitude : float or None
        Predicted (rad/s; m/s2); None where no chatter is predicted.
    """

    run: Run
    source: str
    frequency: float | None
    amplitude: float | None

    @property
    def errors(self) -> tuple[float | None, float | None]:
        """Of frequency and amplitude: predicted over measured, less 1; None where either is missing."""
        first, second = (None if pair is None else pair[0] / pair[1] - 1.0 for pair in self.pairs)
        return first, second

    @cached_property
    def state(self) -> str:
        """Why what is measured is no chatter to judge a prediction by; empty where it is, or where there is none.

        Chatter is steady: S of the last quarter is within a fifth of that of the quarter before, and the position error
        does not grow. A period of a few steps, or numbers that change at half the step, are those of the step, which
        the map from sample to sample alone predicts.
        """
        run = self.run
        if run.metrics.chatter_frequency is None:
            return ""
        time = values(run.trajectory, "time")
        if grows(time, position_error(run.trajectory), by=STEADY):
            return GROWING
        third, last = envelope(time, np.hypot(*(values(run.trajectory, name) for name in ("S[1]", "S[2]"))), 2)
        if not 1.0 - STEADY <= last / third <= 1.0 + STEADY:
            return GROWING if last > third else DECAYING
        if self.source == SAMPLED:
            return ""
        few = (run.metrics.chatter_samples or 0.0) < _FEW
        return STEP if few or not converged(run, "chatter_frequency", "chatter_amplitude") else ""

    @property
    def pairs(self) -> tuple[tuple[float, float] | None, ...]:
        """Predicted and measured frequency (rad/s), and amplitude (m/s2); None where there is none to judge."""
        if self.state:
            return None, None
        seen = self.run.metrics
        both = ((self.frequency, seen.chatter_frequency), (self.amplitude, seen.chatter_amplitude))
        return tuple((said, found) if said and found else None for said, found in both)


def chatter_section(comparison: Comparison, *, drawn: bool = True) -> ProtocolSection | None:
    """Predicted and measured chatter of the switching laws; None where no run has a lag, a delay or sampling."""
    found = predicted_chatter(comparison)
    if all(one.run.planned.has_ideal_actuators for one in found):
        return None
    rows = tuple(
        (
            one.run.planned.scenario,
            one.run.planned.law,
            one.source,
            *(one.frequency, _seen(one, "chatter_frequency"), one.errors[0]),
            *(one.amplitude, _seen(one, "chatter_amplitude"), one.errors[1]),
            one.run.metrics.chatter_samples,
            one.state or None,
        )
        for one in found
    )
    columns = (
        *("scenario", "law", "prediction", "ω predicted, rad/s", "ω measured, rad/s", "error"),
        *("A predicted, m/s²", "A measured, m/s²", "error", "steps in a period", "no chatter to judge by"),
    )
    findings = tuple(_findings(found))
    with drawing.settings():
        figure = predicted_chatter_figure(found) if drawn else None
    return ProtocolSection(
        title="Chatter, predicted and measured",
        explanation=(
            "Frequency ω and amplitude A of the sliding variable in the last quarter of each run under a switching "
            "law, beside what is predicted from gains and hardware alone: for one chain with lags and delay at v, by "
            "describing function and, for a relay, exactly, also with the half step more by which the simulation "
            "delays the relay on average; for the robot with equal lags at its actuators along a straight line; for a "
            "relay that is sampled, or only stepped, by the map from sample to sample. A dash is no chatter. What "
            "grows or decays by more than a fifth from one quarter to the next, or with a growing position error, is "
            "none either. Chatter of fewer than ten steps in a period, or whose numbers change by more than one per "
            f"cent at half the step (marked {MARK.strip()}), is not converged. Such a row counts neither for nor "
            "against a prediction; that of the map is about the step itself, and is judged at any."
        ),
        figure_svg=drawing.svg(figure, "chatter-predicted") if figure is not None else "",
        table=Table("chatter", columns, rows, "Chatter, predicted and measured"),
        findings=findings,
        caption="Measured over predicted frequency and amplitude; on the line they are equal, dotted is a tenth off.",
        headline=next((one for one in findings if STEPPED in one), findings[0]),
    )


def predicted_chatter(comparison: Comparison) -> tuple[PredictedChatter, ...]:
    """All predictions for all runs that ended, under laws of the paper's family that switch."""
    laws = {law.name: law for law in comparison.study.laws}
    return tuple(
        one
        for run in comparison.runs
        if run.ok and run.planned.layer is not None
        for one in _of_run(run, laws[run.planned.law])
    )


def _of_run(run: Run, law: Law) -> Iterator[PredictedChatter]:
    planned = run.planned
    period = _sampling(planned)
    if not law.in_family or not {"C[1]", "C[2]", "C[3]", "Q"} <= set(planned.parameters):
        return
    p = planned.parameters
    if period is not None:
        if p["phi"] == 0.0 and not _is_late(planned) and period * p["Q"] < 2.0:
            yield PredictedChatter(run, SAMPLED, math.pi / period, sampled_chatter_band(p["Q"], p["P"], period))
        return
    hardware = chain_hardware(planned)
    if hardware is None:
        return
    loop = chain_loop(planned, hardware, p["phi"])
    yield _cycle(run, AT_V, predicted_cycles(loop))
    if loop.boundary_layer == 0.0:
        yield _cycle(run, LOCUS, relay_cycles(loop))
        stepped = replace(loop, delay=loop.delay + 0.5 * planned.step_size)
        yield _cycle(run, STEPPED, relay_cycles(stepped))
    heading = _heading(run)
    if loop.boundary_layer == 0.0 and loop.lags and not loop.delay and heading is not None:
        at_u = predicted_robot_chatter(loop, heading)
        usable = at_u is not None and at_u.other < 1.0
        yield PredictedChatter(
            run, AT_U, at_u.frequency if usable and at_u else None, at_u.amplitude if usable and at_u else None
        )


def _cycle(run: Run, source: str, cycles: Sequence[LimitCycle]) -> PredictedChatter:
    stable = next((one for one in cycles if one.stable), None)
    return PredictedChatter(run, source, stable.frequency if stable else None, stable.amplitude if stable else None)


def _sampling(planned: PlannedRun) -> float | None:
    """Period at which a relay is looked at: that of the computer, or the step where nothing else delays it."""
    if planned.loop.hardware.period is not None:
        return planned.parameters["sampling_period"]
    return None if _is_late(planned) else planned.step_size


def _is_late(planned: PlannedRun) -> bool:
    return any(planned.parameters.get(f"{name}[{k}]", 0.0) for name in ("lag", "delay") for k in (1, 2))


def _heading(run: Run) -> float | None:
    """Heading in the last quarter; None where it turns."""
    theta = values(run.trajectory, "theta")
    last = theta[tail(values(run.trajectory, "time"))]
    return float(np.mean(last)) if float(np.ptp(last)) <= STRAIGHT else None


def _seen(one: PredictedChatter, name: str) -> float | str | None:
    """What was measured, marked where the step decides on it."""
    value = both(one.run, name)[0]
    return value if value is None or converged(one.run, name) else MARK + number(value)


def _findings(found: Sequence[PredictedChatter]) -> Iterator[str]:
    """For each kind of prediction, how far it is off; then where it is there in one alone."""
    for source in dict.fromkeys(one.source for one in found):
        own = [one for one in found if one.source == source]
        judged = [one for one in own if not one.state]
        pairs = [one for one in judged if None not in one.errors]
        none = [one for one in judged if one.frequency is None and one.run.metrics.chatter_frequency is None]
        other = [one.run.planned.name for one in judged if one not in pairs and one not in none]
        parts = []
        near = [one for one in pairs if max(abs(error or 0.0) for error in one.errors) <= CLOSE]
        for some, words in ((near, "it predicts"), ([one for one in pairs if one not in near], "it misses")):
            if some:
                ends = [max(abs(one.errors[k] or 0.0) for one in some) for k in (0, 1)]
                which = "" if some is near else f" ({', '.join(one.run.planned.name for one in some)})"
                parts.append(
                    f"in {len(some)}{which} {words} the chatter that is measured, off by at most {percent(ends[0])} in "
                    f"frequency and {percent(ends[1])} in amplitude"
                )
        if none:
            parts.append(f"in {len(none)} it predicts none, and there is none")
        if other:
            parts.append(f"in {len(other)} ({', '.join(other)}) one of the two has chatter and the other none")
        for state, words in _UNJUDGED.items():
            there = [one.run.planned.name for one in own if one.state == state]
            parts += [f"in {len(there)} ({', '.join(there)}) {words}"] if there else []
        yield f"The {source} was used for {len(own)} run{'s' * (len(own) != 1)}: {'; '.join(parts)}."
    coarse = [one.run.planned.name for one in found if (one.run.metrics.chatter_samples or 99.0) < _FEW]
    if coarse and not all(one.source == SAMPLED for one in found):
        names = ", ".join(dict.fromkeys(coarse))
        yield f"In {names} a period of the chatter has fewer than {number(_FEW, 2)} steps: it is that of the step."


_UNJUDGED = {
    GROWING: "the run grows to its end, and shows no chatter to judge it by",
    DECAYING: "the oscillation decays to the end, and is no chatter to judge it by",
    STEP: "the chatter is not converged with the step, and neither for nor against it",
}
_FEW = 10.0  # steps in a period
