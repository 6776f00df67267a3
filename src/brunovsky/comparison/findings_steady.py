"""Sentences on what remains: the error of the last quarter, what was predicted of it, and the chatter."""

from __future__ import annotations

import math

from brunovsky.comparison.facts import HARDLY as HARDLY
from brunovsky.comparison.facts import Facts, given, joined, number
from brunovsky.comparison.residuals import disturbed, predicted_noise, predicted_residual, tail_peaks, within_bounds
from brunovsky.comparison.run import Run
from brunovsky.comparison.sensitivity import MARK, both, converged, largest, sensitivity, spread_of, told
from brunovsky.comparison.study import Law

ROUNDING = 1e-9  # m; an error below this is said to be nil for every purpose
_ITS_OWN = 1.5  # times the relay's amplitude in u2, up to which that is said to be the relay's
STILL = 1e-3  # rad/s3 of variation of u2 a second, below which there is no chatter to speak of

Good = list[tuple[Law, Run, Facts]]


def steady_state(good: Good) -> str:
    """What error remains, and what was predicted where there is a disturbance."""
    runs = [run for _, run, _ in good]
    planned = runs[0].planned
    nominal = not any(tail_peaks(planned).values())
    if nominal and all(largest(run, "rms_tail_error") < ROUNDING for run in runs):
        uncertain = _idle_mismatch(good) if planned.is_uncertain else ""
        if disturbed(planned):
            uncertain += ": the disturbance has passed by then"
        return f"Over the last quarter the error is nil for every purpose under each law (below 1 nm RMS){uncertain}."
    parts = []
    for law, run, _ in good:
        expected = predicted_residual(run.planned, law) if _predictable(law, run) else None
        if expected is None and law.in_family:
            expected = predicted_noise(run.planned, law)
        text = f"{told(run, 'rms_tail_error')} m ({law.name}"
        parts.append(text + (f"; predicted {number(expected)} m)" if expected else ")"))
    text = f"Over the last quarter the RMS error is {joined(parts)}."
    if not all(converged(run, "rms_tail_error") for run in runs):
        text += f" What is marked {MARK.strip()} is not converged with the step, and ranks no law."
    by_kind = {law.kind: run for law, run, _ in good}
    if nominal or planned.noise or "sign" not in by_kind or "linear" not in by_kind:
        return text
    return text + _rejection(by_kind["sign"], by_kind["linear"])


def _predictable(law: Law, run: Run) -> bool:
    """Whether a residual is predicted: for the paper's laws, where P rejects what it can or there is none."""
    return law.in_family and (law.kind == "linear" or within_bounds(run))


def _idle_mismatch(good: Good) -> str:
    p = good[0][1].planned.parameters
    text = ", although the plant isn’t the nominal one"
    if p["rho[2]"] != 1.0:
        return f"{text}: at a steady yaw rate u₂ is next to zero; what the wrong inertia costs is in the transient"
    if max(facts.tail_forward for _, _, facts in good) > 1e-2:
        return text
    return f"{text}: at a steady speed u₁ is next to zero, so that a wrong mass has nothing to act on"


def _rejection(relay: Run, linear: Run) -> str:
    """What the sign function makes of a disturbance, as far as the bound and the step allow to say it."""
    d1 = tail_peaks(relay.planned)["d[1]"]
    kind = "unmatched" if d1 else "matched"
    if not within_bounds(relay):
        return f" The disturbance is {kind} and beyond the bound that P rejects: sliding is not guaranteed."
    name = "rms_tail_error"
    left, base = both(relay, name), both(linear, name)[0]
    if not converged(relay, name):
        if d1 or left[0] is None or left[1] is None or left[1] > left[0]:
            return ""
        return (
            " The disturbance is matched and within the bound that P rejects: what the sign function leaves is the "
            f"switching at each step ({MARK}{number(left[1], 2)} m at half the step), nothing of the disturbance."
        )
    if not converged(linear, name) or left[0] is None or base is None:
        return ""
    factor = base / left[0] if left[0] else math.inf
    if factor < 1.0 + HARDLY:
        return " The sign function leaves as much as pole placement."
    ending = ", but does not remove it" if d1 else ""
    within = "within the bound under which sliding persists"
    return (
        f" The disturbance is {kind} and {within}: the sign function leaves {number(factor, 2)} times less than pole "
        f"placement{ending}."
    )


def chatter(good: Good) -> str:
    """Variation of the inputs in the steady state, against the amplitude of the relay."""
    if all(law.kind == "linear" for law, _, _ in good):
        return ""
    rough = [(law, run, facts) for law, run, facts in good if facts.roughness_u2 > STILL]
    if not rough:
        return "None of the laws chatters in the steady state."
    law, run, facts = max(rough, key=lambda one: one[2].roughness_u2)
    others = [one[1] for one in good if one[0].name != law.name]
    text = (
        f"Under “{law.name}” u₂ varies by {told(run, 'roughness_u2')} rad/s² and u₁ by {told(run, 'roughness_u1')} "
        "m/s² each second of the last quarter"
    )
    if others:
        quiet = all(largest(one, "roughness_u2") < STILL for one in others)
        bound = f"less than {given(STILL)} rad/s²" if quiet else spread_of(others, "roughness_u2", "rad/s²", 2)
        text += f", u₂ under the others by {bound}"
    return text + (_amplification(run, facts) if law.kind == "sign" else "") + "." + _growth(run)


def _growth(run: Run) -> str:
    grown = sensitivity(run, "roughness_u2")
    if grown is None or grown <= HARDLY:
        return ""
    half = number(both(run, "roughness_u2")[1], 2)
    return f" At half the step u₂ varies by {MARK}{half} rad/s²: the chatter grows as the step shrinks."


def _amplification(run: Run, facts: Facts) -> str:
    p = run.planned.parameters
    if facts.tail_speed <= p["eta_min"]:
        return (
            ". The robot is within the guard then, whose gain η₁/η_min² falls to zero at rest, so that little of the "
            "relay reaches u₂"
        )
    if not run.planned.is_undisturbed:
        return ""
    relay = math.sqrt(2.0) * p["P"] / abs(p["C[3]"])
    if facts.tail_yaw > _ITS_OWN * relay / facts.tail_speed:  # something else swings
        return ""
    return (
        f": the relay’s amplitude, up to √2 P/c₃ = {number(relay)} m/s³, reaches u₂ divided by |η₁| "
        f"({number(relay / facts.tail_speed)} rad/s² at {number(facts.tail_speed)} m/s; seen: "
        f"{told(run, 'tail_yaw')} rad/s²), and would be {_amplified(relay, p['eta_min'])} nearer to rest"
    )


def _amplified(relay: float, eta_min: float) -> str:
    return f"{number(relay / eta_min)} rad/s² at |η₁| = {given(eta_min)} m/s," if eta_min > 0.0 else "unbounded"
