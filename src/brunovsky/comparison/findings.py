"""A paragraph for each scenario: what is seen, in words that follow from the numbers of the runs."""

from __future__ import annotations

import math
from collections.abc import Mapping

from brunovsky.comparison.facts import Facts, change, facts_of, given, joined, number, percent, seconds, spread
from brunovsky.comparison.linear_part import predicted_residual
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.study import Law, Scenario

HARDLY = 0.05  # relative change of a metric up to which two laws are said to hardly differ
ROUNDING = 1e-9  # m; an error below this is said to be nil for every purpose
STILL = 1e-3  # rad/s3 of variation of u2 a second, below which there is no chatter to speak of

Good = list[tuple[Law, Run, Facts]]


def scenario_findings(comparison: Comparison, scenario: Scenario) -> list[str]:
    """Paragraphs on one scenario: failures first, then convergence, peaks, steady state."""
    pairs = comparison.laws_of(scenario)
    good: Good = [(law, run, facts_of(run)) for law, run in pairs if run.ok]
    paragraphs = [failure(law, run) for law, run in pairs if not run.ok]
    if not good:
        return [*paragraphs, "No run of this scenario reached its end, so there is nothing to compare."]
    first = good[0][1].planned.parameters
    if first["radius"] == 0.0:
        parts = [convergence(good), peaks(good), rest(good), steady_state(good), chatter(good), heading(good)]
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
    told = [f"{seconds(one)} ({name})" if one is not None else f"never ({name})" for name, one in times.items()]
    text = f"The position error stays below 1 cm after {joined(told)}."
    return " ".join([text, *_against_linear(good)])


def _against_linear(good: Good) -> list[str]:
    base = next((run for law, run, _ in good if law.kind == "linear"), None)
    others = [run for law, run, _ in good if law.kind != "linear"]
    if base is None or not others:
        return []
    settling = [change(run.metrics.settling_time, base.metrics.settling_time) for run in others]
    areas = [change(run.metrics.iae, base.metrics.iae) for run in others]
    known = [one for one in settling if one is not None]
    if not known:
        return []
    words = "hardly changes" if max(map(abs, known)) <= HARDLY else "changes"
    changes = ", ".join(
        f"{what} by {_changes([one for one in found if one is not None])}"
        for what, found in (("the settling time", settling), ("the IAE", areas))
        if any(one is not None for one in found)
    )
    return [f"Against pole placement with the same linear part the switching term {words} convergence: {changes}."]


def _changes(found: list[float]) -> str:
    low, high = percent(min(found)), percent(max(found))
    return low if low == high else f"{low} to {high}"


def peaks(good: Good) -> str:
    """Peaks of speed and yaw acceleration, and when they occur."""
    speeds = [run.metrics.peak_speed or 0.0 for _, run, _ in good]
    yaws = [run.metrics.peak_yaw_acceleration or 0.0 for _, run, _ in good]
    p = good[0][1].planned.parameters
    if max(yaws) < 1e-3:
        return f"The speed stays at {spread(speeds, 'm/s')}, and |u₂| at {number(max(yaws))} rad/s² at most."
    facts = good[0][2]
    target = (p["center[1]"] + p["radius"] * math.cos(p["phase"]), p["center[2]"] + p["radius"] * math.sin(p["phase"]))
    distance = math.hypot(p["x_start"] - target[0], p["y_start"] - target[1])
    away = f" over an initial error of {number(distance)} m" if distance > ROUNDING else ""
    text = f"The speed peaks at {spread(speeds, 'm/s')}{away}, the yaw acceleration at {spread(yaws, 'rad/s²')}"
    if any(abs(one.peak_yaw_time - facts.peak_yaw_time) > 0.01 for _, _, one in good):
        return text + "."
    when = "right at the start" if facts.peak_yaw_time == 0.0 else f"at {seconds(facts.peak_yaw_time)}"
    return f"{text}, {when}, where the robot moves at {number(facts.peak_yaw_speed)} m/s and the law divides by that."


def rest(good: Good) -> str:
    """In regulation: that the robot ends at the singularity, where the guard acts."""
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
    reversals = {facts.reversals for _, _, facts in good}
    if max(reversals):
        told = str(max(reversals)) if len(reversals) == 1 else f"{min(reversals)} to {max(reversals)}"
        text += f"; the velocity changes sign {told} times before the error has settled"
    return (
        f"{text}. What u₂ does there belongs to the guard, not to the printed law, and the smallest speed and the "
        "total variation of u₂ in the table are to be read so."
    )


def heading(good: Good) -> str:
    """In regulation: the heading, which nothing controls."""
    ends = {law.name: facts.heading_end for law, _, facts in good}
    start = number(good[0][2].heading_start)
    told = joined([f"{number(one)} rad ({name})" for name, one in ends.items()])
    text = f"The heading is left uncontrolled: from {start} rad it ends at {told}"
    apart = max(ends.values()) - min(ends.values())
    if len(ends) > 1 and apart > 0.1:
        text += f", up to {number(apart)} rad apart"
    return text + "."


def steady_state(good: Good) -> str:
    """What error remains, and what was predicted where there is a disturbance."""
    errors = {law.name: run.metrics.rms_tail_error for law, run, _ in good}
    known = {name: one for name, one in errors.items() if one is not None}
    p = good[0][1].planned.parameters
    nominal = not any(good[0][1].planned.inputs.values())
    if nominal and known and max(known.values()) < ROUNDING:
        uncertain = _idle_mismatch(good) if p["rho[1]"] != 1.0 or p["rho[2]"] != 1.0 else ""
        return (
            f"Over the last quarter the error is nil for every purpose under each law (at most "
            f"{number(max(known.values()), 1)} m RMS, rounding and the switching at each step){uncertain}."
        )
    parts = []
    for law, run, _ in good:
        told = f"{number(run.metrics.rms_tail_error)} m ({law.name}"
        expected = predicted_residual(run.planned, law)
        told += f"; predicted {number(expected)} m" if expected else ""
        parts.append(told + ")")
    text = f"Over the last quarter the RMS error is {joined(parts)}."
    relay = next((one for law, _, _ in good if law.kind == "sign" for one in [known.get(law.name)]), None)
    linear = next((one for law, _, _ in good if law.kind == "linear" for one in [known.get(law.name)]), None)
    return text + (_rejection(good[0][1].planned.inputs, relay, linear) if relay and linear and not nominal else "")


def _idle_mismatch(good: Good) -> str:
    text = ", although the plant isn’t the nominal one"
    if max(facts.tail_forward for _, _, facts in good) > 1e-2:
        return text
    return f"{text}: at a steady speed u₁ is next to zero, so that a wrong mass has nothing to act on"


def _rejection(inputs: Mapping[str, float], relay: float, linear: float) -> str:
    factor = linear / relay
    if factor < 1.0 + HARDLY:
        return " The sign function leaves as much as pole placement."
    times = f"{number(factor, 2)} times less than pole placement"
    if inputs.get("d[1]"):
        return f" The disturbance is unmatched: the sign function leaves {times}, but does not remove it."
    return f" The disturbance is matched: the sign function removes it up to the switching at each step, {times}."


def chatter(good: Good) -> str:
    """Variation of the inputs in the steady state, against the amplitude of the relay."""
    if all(law.kind == "linear" for law, _, _ in good):
        return ""
    rough = [(law, run, facts) for law, run, facts in good if facts.roughness_u2 > STILL]
    if not rough:
        return "None of the laws chatters in the steady state."
    law, run, facts = max(rough, key=lambda one: one[2].roughness_u2)
    others = [one[2].roughness_u2 for one in good if one[0].name != law.name]
    text = (
        f"Under “{law.name}” u₂ varies by {number(facts.roughness_u2)} rad/s² and u₁ by {number(facts.roughness_u1)} "
        "m/s² each second of the last quarter"
    )
    if others:
        text += f", u₂ under the others by {spread(others, 'rad/s²', 2)}"
    return text + (_amplification(run, facts) if law.kind == "sign" else "") + "."


def _amplification(run: Run, facts: Facts) -> str:
    p = run.planned.parameters
    if facts.tail_speed <= p["eta_min"]:
        return (
            ". The robot is within the guard then, whose gain η₁/η_min² falls to zero at rest, so that little of the "
            "relay reaches u₂"
        )
    if any(run.planned.inputs.values()):
        return ""
    relay = math.sqrt(2.0) * p["P"] / abs(p["C[3]"])
    return (
        f": the relay’s amplitude, up to √2 P/c₃ = {number(relay)} m/s³, reaches u₂ divided by |η₁| "
        f"({number(relay / facts.tail_speed)} rad/s² at {number(facts.tail_speed)} m/s; seen: "
        f"{number(facts.tail_yaw)} rad/s²), and would be {_amplified(relay, p['eta_min'])} nearer to rest"
    )


def _amplified(relay: float, eta_min: float) -> str:
    return f"{number(relay / eta_min)} rad/s² at |η₁| = {given(eta_min)} m/s," if eta_min > 0.0 else "unbounded"
