"""A paragraph for each scenario: what is seen, in words that follow from the numbers of the runs."""

from __future__ import annotations

import math

from brunovsky.comparison.claim_limits import heading_converged
from brunovsky.comparison.facts import given, joined, number, percent, seconds, spread, wrapped
from brunovsky.comparison.findings_steady import HARDLY, ROUNDING, Good, chatter, steady_state
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import MARK, both, converged, facts_of, settled, spread_of, sure_change, told
from brunovsky.comparison.study import Law, Scenario

FINER = {"settling_1mm": "1 mm", "settling_100um": "0.1 mm"}


def scenario_findings(comparison: Comparison, scenario: Scenario) -> list[str]:
    """Paragraphs on one scenario: failures first, then convergence, peaks, steady state."""
    pairs = comparison.laws_of(scenario)
    good: Good = [(law, run, facts_of(run)) for law, run in pairs if run.ok]
    paragraphs = [failure(law, run) for law, run in pairs if not run.ok]
    if not good:
        return [*paragraphs, "No run of this scenario reached its end, so there is nothing to compare."]
    if good[0][1].planned.target is not None:
        free = [one for one in good if one[1].planned.guard is not None]
        parts = [convergence(good), peaks(good), rest(free), steady_state(good), chatter(good)]
        parts += [arrival(good), heading(free)]
    else:
        parts = [convergence(good), peaks(good), steady_state(good), chatter(good)]
    return [*paragraphs, *(" ".join(filter(None, group)) for group in (parts[:2], parts[2:]))]


def failure(law: Law, run: Run) -> str:
    """Sentence on a run that failed."""
    why = "at the singularity η₁ = 0 of the law" if run.status.state == "singular" else "because it diverged"
    when = f"at {seconds(run.status.time)}" if run.status.time is not None else "before its first step"
    shown = "the figure shows it until then" if run.trajectory.sizes["time"] else "there is nothing to draw"
    return (
        f"The run “{law.name}” failed {when}, {why}; {shown}, and it has no metrics. "
        f"The simulation says: {run.status.message}"
    )


def convergence(good: Good) -> str:
    """When the position error falls below 1 cm for good, and what the switching term changes about it."""
    times = {law.name: run.metrics.settling_time for law, run, _ in good}
    if all(one == 0.0 for one in times.values()):
        return "The position error never exceeds 1 cm: there is no convergence to compare."
    for_good = {law.name for law, run, _ in good if settled(run)}
    known = {name: f"{seconds(one)} ({name})" for name, one in times.items() if one is not None}
    kept = [one for name, one in known.items() if name in for_good]
    late = [one for name, one in known.items() if name not in for_good]
    never = [f"“{name}”" for name in times if name not in known]
    sentences = [f"The position error stays below 1 cm after {joined(kept)}."] if kept else []
    if late:
        subject = "It" if kept else "The position error"
        when = f"at {joined(late)}, in the last quarter of the run"
        sentences.append(f"{subject} last exceeds 1 cm {when}: it had not settled for good.")
    sentences += [f"Under {joined(never)} it exceeds 1 cm to the end."] if never else []
    return " ".join([*sentences, *_against_linear(good)])


def _against_linear(good: Good) -> list[str]:
    base = next((run for law, run, _ in good if law.kind == "linear"), None)
    others = [run for law, run, _ in good if law.kind in ("saturation", "sign")]
    if base is None or not others:
        return []
    known = {name: _known(base, others, name) for name in ("settling_time", "iae", *FINER)}
    first = known["settling_time"] + known["iae"]
    if not known["settling_time"]:
        return []
    words = "hardly changes" if max(map(abs, first)) <= HARDLY else "changes"
    text = f"Against pole placement with the same linear part the switching term {words} convergence to 1 cm: "
    text += f"the settling time by {_changes(known['settling_time'])}"
    text += f", the IAE by {_changes(known['iae'])}." if known["iae"] else "."
    finer = [f"the time to {size} by {_changes(known[name])}" for name, size in FINER.items() if known[name]]
    unknown = [size for name, size in FINER.items() if _unsure(base, others, name)]
    text += f" It changes {joined(finer)}." if finer else ""
    if unknown:
        text += f" The time to {joined(unknown)} is not converged with the step under each law, and not compared."
    late = [size for name, size in FINER.items() if _late(base, others, name)]
    if late:
        text += (
            f" To {joined(late)} the error had not settled for good, by the last quarter of the run, under each law."
        )
    return [text]


def _known(base: Run, others: list[Run], name: str) -> list[float]:
    """Relative changes of a converged metric or fact against pole placement."""
    found = [sure_change(run, base, name) for run in others]
    return [one for one in found if one is not None]


def _unsure(base: Run, others: list[Run], name: str) -> bool:
    return any(both(run, name)[0] is not None and not converged(run, name) for run in (base, *others))


def _late(base: Run, others: list[Run], name: str) -> bool:
    return any(both(run, name)[0] is not None and not settled(run, name) for run in (base, *others))


def _changes(found: list[float]) -> str:
    low, high = percent(min(found)), percent(max(found))
    return low if low == high else f"{low} to {high}"


def peaks(good: Good) -> str:
    """Peaks of speed and yaw acceleration, and when they occur."""
    runs = [run for _, run, _ in good]
    yaw = max(run.metrics.peak_yaw_acceleration or 0.0 for run in runs)
    planned = runs[0].planned
    speeds, yaws = spread_of(runs, "peak_speed", "m/s"), spread_of(runs, "peak_yaw_acceleration", "rad/s²")
    if yaw < 1e-3:
        return f"The speed stays at {speeds}, and |u₂| below 0.001 rad/s²."
    facts = good[0][2]
    distance = math.dist([planned.parameters[name] for name in ("x_start", "y_start")], planned.aim)
    away = f" over an initial error of {number(distance)} m" if distance > ROUNDING else ""
    text = f"The speed peaks at {speeds}{away}, the yaw acceleration at {yaws}"
    divides = all(run.planned.guard is not None for run in runs) and not planned.noise
    if not divides or any(abs(one.peak_yaw_time - facts.peak_yaw_time) > 0.01 for _, _, one in good):
        return text + "."
    when = "right at the start" if facts.peak_yaw_time == 0.0 else f"at {seconds(facts.peak_yaw_time)}"
    return (
        f"{text}, {when}, where the robot moves at {told(runs[0], 'peak_yaw_speed')} m/s and the law divides by that."
    )


def rest(good: Good) -> str:
    """In regulation: that the robot ends at the singularity, where the guard acts; of laws that have one."""
    if not good:
        return ""
    shares = [facts.guarded_share for _, _, facts in good]
    firsts = [facts.guarded_first for _, _, facts in good if facts.guarded_first is not None]
    limit = given(good[0][1].planned.parameters["eta_min"])
    text = "The target is a point of rest, and at rest the linearising law is singular."
    if not firsts:
        return f"{text} In these runs the speed stays above the guard, |η₁| > {limit} m/s."
    text += (
        f" The guard |η₁| ≤ {limit} m/s is in force for {spread([100 * one for one in shares], '%', 2)} of the run,"
        f" first at {seconds(min(firsts))}"
    )
    reversals = {one for _, run, _ in good for one in both(run, "reversals") if one is not None}
    if max(reversals):
        counted = (
            given(max(reversals)) if len(reversals) == 1 else f"{given(min(reversals))} to {given(max(reversals))}"
        )
        text += f"; the velocity changes sign {counted} times before the error last exceeds 1 cm"
    return (
        f"{text}. What u₂ does there belongs to the guard, not to the printed law, and the smallest speed and the "
        "total variation of u₂ in the table are to be read so."
    )


def arrival(good: Good) -> str:
    """When the robot rests at the goal, and how far its heading is from the goal's, where the task names one."""
    told_of = [(law, run) for law, run, _ in good if run.metrics.final_heading_error is not None]
    if not told_of:
        return ""
    arrived = [
        f"{seconds(run.metrics.arrival_time)} ({law.name})"
        for law, run in told_of
        if run.metrics.arrival_time is not None
    ]
    never = [f"“{law.name}”" for law, run in told_of if run.metrics.arrival_time is None]
    text = f"The robot rests at the goal, with its heading, after {joined(arrived)}. " if arrived else ""
    text += f"Under {joined(never)} it does not rest there within the run. " if never else ""
    ends = [f"{told(run, 'final_heading_error', 2)} rad ({law.name})" for law, run in told_of]
    return f"{text}In the end the heading is off the goal’s by {joined(ends)}, modulo 2π."


def heading(good: Good) -> str:
    """In regulation: the heading, which nothing controls under these laws."""
    if not good:
        return ""
    start = number(good[0][2].heading_start)
    sure = [(law, facts) for law, run, facts in good if heading_converged(run)]
    moved = [
        f"{number(abs(half - end), 2)} rad ({law.name})"
        for law, run, _ in good
        for end, half in [both(run, "heading_end")]
        if not heading_converged(run) and end is not None and half is not None
    ]
    text = f"The heading is left uncontrolled, from {start} rad on"
    if sure:
        ends = [
            f"{MARK}{number(wrapped(one.heading_end - one.heading_start), 2)} rad ({law.name})" for law, one in sure
        ]
        turns = [(one.heading_end - one.heading_start) / (2.0 * math.pi) for _, one in sure]
        text += f": modulo 2π it ends {joined(ends)} from there, after {spread(turns, 'turns', 2)}"
    if moved:
        text += (
            f"{';' if sure else ':'} at half the step it ends {joined(moved)} elsewhere, so that no finding rests on it"
        )
    return text + "."
