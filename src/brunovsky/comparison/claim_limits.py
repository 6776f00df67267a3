"""Claims of the paper about robustness, orientation and the reach of the method."""

from __future__ import annotations

import math

from brunovsky.comparison.claim import Case, Finding, is_nominal, is_regulation
from brunovsky.comparison.facts import change, given, joined, number, percent, spread, wrapped
from brunovsky.comparison.features import features
from brunovsky.comparison.findings_steady import HARDLY, ROUNDING
from brunovsky.comparison.residuals import disturbed, tail_peaks, within_bounds
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import MARK, both, converged, facts_of, largest, settled, sure_change, told
from brunovsky.comparison.study import Scenario

AIMED = 0.1  # rad; a heading that ends this near to a wanted one counts as stabilised, and one that moves by more at
# half the step as not converged


def robustness(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """What disturbances and uncertainty do under the sign function and under pole placement."""
    kinds = {law.name: law.kind for law in comparison.study.laws}
    parts: list[str] = []
    rejected: list[bool] = []
    idle: list[str] = []
    unknown: list[str] = []
    remaining: set[float] = set()
    count = 0
    for scenario, runs in cases:
        by_kind = {kinds[name]: run for name, run in runs.items()}
        linear, relay = by_kind.get("linear"), by_kind.get("sign")
        if linear is None or relay is None or is_nominal(linear) or linear.planned.noise:
            continue
        if disturbed(linear.planned):
            if not any(tail_peaks(linear.planned).values()):
                continue  # of what has passed by the last quarter nothing is left to compare
            count += 1
            rejected.append(largest(relay, "rms_tail_error") < max(_least(linear) / 10.0, ROUNDING))
            parts.append(f"{scenario.title}: {_residuals(linear, relay)}")
            if tail_peaks(linear.planned)["d[1]"] > 0.0 and not rejected[-1]:
                remaining.update(run.planned.parameters["P"] for run in (linear, relay))
            continue
        slower = _slower(cases, scenario, {"linear": linear, "sign": relay})
        if not slower:
            unknown.append(scenario.title)
        elif max(map(abs, slower.values())) <= HARDLY:
            idle.append(scenario.title)
        else:
            rejected.append(slower["sign"] < slower["linear"] / 2.0)
            parts.append(f"{scenario.title}: {_slowed(linear, relay, slower, rejected[-1])}")
    if not parts:
        return None
    text = f"{'; '.join(parts)}."
    if remaining:
        gains = [f"{given(gain)}\u00a0m/s³" for gain in sorted(remaining)]
        text += f" What enters the chains below v (unmatched) remains at every P that was run ({joined(gains)}), z″"
        text += " being computed from the model."
    if idle:
        text += f" Not counted, as it tests neither law (nil error, and hardly any delay, under both): {joined(idle)}."
    if unknown:
        text += " Not counted, as the delay against a nominal run cannot be told (there is none, it starts within"
        text += " 1 cm, had not settled for good, or the time is not converged with the step): "
        text += f"{joined(unknown)}."
    dynamics = features(comparison.study) & {"lag", "delay"}
    if not dynamics:
        text += " Unmodelled dynamics are not in this study."
    if not any(rejected):
        return Finding("contradicted", text)
    complete = all(rejected) and len(rejected) > count and bool(dynamics)
    return Finding("confirmed" if complete else "confirmed under conditions", text)


def _least(run: Run) -> float:
    return min(one or 0.0 for one in both(run, "rms_tail_error"))


def _residuals(linear: Run, relay: Run) -> str:
    name = "rms_tail_error"
    text = f"RMS error over the last quarter {told(linear, name)} m under pole placement, {told(relay, name)} m under "
    text += "the sign function"
    half = both(relay, name)[1]
    if not converged(relay, name) and half is not None:
        text += f" ({number(half, 2)} m at half the step)"
    return text if within_bounds(relay) else f"{text}, the disturbance being beyond the bound that P rejects"


def _slower(cases: list[Case], scenario: Scenario, runs: dict[str, Run]) -> dict[str, float]:
    """Relative change of the settling time of runs with uncertainty against the nominal scenario, by kind of law."""
    found: dict[str, float] = {}
    for other, others in cases:
        for kind, run in runs.items():
            twin = others.get(run.planned.law)
            if other is scenario or twin is None or not is_nominal(twin) or not _differ_in_rho(run, twin):
                continue
            one = change(run.metrics.settling_time, twin.metrics.settling_time)
            if one is not None and all(settled(each) and converged(each, "settling_time") for each in (run, twin)):
                found[kind] = one
    return found if set(found) == set(runs) else {}


def _differ_in_rho(run: Run, twin: Run) -> bool:
    a, b = ({name: value for name, value in one.planned.parameters.items() if "rho" not in name} for one in (run, twin))
    return a == b and run.planned.duration == twin.planned.duration


def _slowed(linear: Run, relay: Run, slower: dict[str, float], rejected: bool) -> str:
    text = (
        f"settling to 1 cm takes {linear.metrics.settling_time:.3f} s under pole placement "
        f"({percent(slower['linear'])} longer than nominal), {relay.metrics.settling_time:.3f} s under the "
        f"sign function ({percent(slower['sign'])} longer)"
    )
    p = linear.planned.parameters
    if rejected or p["rho[2]"] == 1.0:
        return text
    what = "an error of the yaw gain" if p["rho[1]"] == 1.0 else "errors of both gains, matched and unmatched together"
    help_ = "P makes it worse" if slower["sign"] > slower["linear"] + HARDLY else "P does not help against it"
    return f"{text}: {what}, whose jerk exceeds P while u₂ is large, so that {help_}"


def orientation(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """What another initial heading changes, where two scenarios differ in nothing else."""
    for index, (scenario, runs) in enumerate(cases):
        for other, others in cases[index + 1 :]:
            for name, run in runs.items():
                twin = others.get(name)
                if twin is not None and _differ_in_heading(run, twin) and scenario.parameters != other.parameters:
                    return _turned(run, twin, name)
    return None


def _differ_in_heading(run: Run, twin: Run) -> bool:
    a, b = (
        {name: value for name, value in one.planned.parameters.items() if name != "theta_start"} for one in (run, twin)
    )
    return a == b and run.planned.duration == twin.planned.duration and _same_disturbances(run, twin)


def _same_disturbances(run: Run, twin: Run) -> bool:
    a, b = run.planned, twin.planned
    return (a.inputs, a.signals, a.noise, a.loop) == (b.inputs, b.signals, b.noise, b.loop)


def _turned(run: Run, twin: Run, law: str) -> Finding:
    name = "peak_yaw_acceleration"
    ratios = [
        max(a, b) / max(min(a, b), 1e-12) for a, b in zip(both(run, name), both(twin, name), strict=True) if a and b
    ]
    apart = sure_change(twin, run, "settling_time")
    starts = [number(one.planned.parameters["theta_start"]) for one in (twin, run)]
    text = (
        f"From {starts[0]} rad instead of {starts[1]} rad (law “{law}”) the peak of |u₂| is {told(twin, name)} instead "
        f"of {told(run, name)} rad/s², as the speed falls to {told(twin, 'min_speed')} m/s"
    )
    text += f"; the settling time changes by {percent(apart)}." if apart is not None else "."
    return Finding("confirmed" if min(ratios, default=0.0) > 2.0 else "contradicted", text)


def heading(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """Whether the heading ends where it began, from the runs that settle and whose final heading is converged."""
    runs = [run for _, found in cases for run in found.values() if is_regulation(run)]
    sure = [run for run in runs if heading_converged(run) and settled(run)]
    if not sure:
        return None
    away = [min(abs(one) for one in _away(run)) for run in sure]
    ends = spread([abs(_away(run)[0]) for run in sure], "rad", 2)
    text = (
        f"Nothing controls the heading. In regulation it ends {MARK}{ends} "
        "(modulo 2π) from the initial one, which in the paper is the desired one too, after "
        f"{spread([abs(_turns(run)) for run in sure], 'turns', 2)}"
    )
    if len(sure) < len(runs):
        laws = joined(sorted({f"“{run.planned.law}”" for run in runs if run not in sure}))
        text += (
            f"; under {laws} it had not settled for good, or where it ends is not converged with the step: not counted"
        )
    return Finding("confirmed" if max(away) > AIMED else "contradicted", f"{text}.")


def heading_converged(run: Run) -> bool:
    """Whether the final heading moves by at most a tenth of a radian at half the step."""
    value, half = both(run, "heading_end")
    return value is not None and half is not None and abs(half - value) <= AIMED


def _away(run: Run) -> tuple[float, ...]:
    start = facts_of(run).heading_start
    return tuple(wrapped(one - start) for one in both(run, "heading_end") if one is not None)


def _turns(run: Run) -> float:
    return (facts_of(run).heading_end - facts_of(run).heading_start) / (2.0 * math.pi)


def stabilization(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """Whether the printed law can bring the robot to rest, and how much of a run the guard stands in for it."""
    runs = [run for _, found in cases for run in found.values() if is_regulation(run)]
    if not runs or max(facts_of(run).guarded_share for run in runs) == 0.0:
        return None
    limits = joined(sorted({f"{given(run.planned.parameters['eta_min'])} m/s" for run in runs}))
    targets = len({tuple(run.planned.parameters[f"center[{k}]"] for k in (1, 2)) for run in runs})
    never = any(run.metrics.settling_time is None for run in runs)
    rests = all(map(settled, runs))
    shares = [100.0 * facts_of(run).guarded_share for run in runs]
    tested = "One target was tested" if targets == 1 else f"{targets} targets were tested"
    return Finding(
        "contradicted" if never else "confirmed under conditions",
        f"{tested}. The robot does {'come' if rests else 'not always come'} to rest there for good, but rest is the "
        f"singularity of the law: for {spread(shares, '%', 2)} of the run a guard (|η₁| ≤ {limits}) stands in for the "
        "printed law, which can neither stop nor start.",
    )
