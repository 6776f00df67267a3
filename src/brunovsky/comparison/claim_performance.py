"""Claims of the paper about convergence, steady-state errors, chattering and smoothness."""

from __future__ import annotations

from brunovsky.comparison.claim import (
    Case,
    Finding,
    Verdict,
    decay_rates,
    has_printed_gains,
    is_long_enough,
    is_nominal,
    is_regulation,
    of_kind,
    pairs,
)
from brunovsky.comparison.facts import given, joined, number, percent
from brunovsky.comparison.findings_steady import HARDLY, ROUNDING, STILL
from brunovsky.comparison.metrics import SETTLED
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import both, largest, sensitivity, settled, spread_of, sure_change, told
from brunovsky.comparison.study import Scenario

FAST = 5.0  # m/s; faster than any laboratory robot of this kind
VIOLENT = 1e3  # rad/s2; beyond any drive of such a robot
ROUGH = 2.0  # times the total variation under pole placement, beyond which an input is said to chatter
SETTLING = {"settling_time": "1 cm", "settling_1mm": "1 mm", "settling_100um": "0.1 mm"}


def convergence(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """Whether the switching term makes the error fall sooner, for each of several thresholds."""
    found = [(a, b) for _, a, b in pairs(comparison, cases, ["saturation", "sign"]) if is_nominal(a)]
    changes = {name: _changes(found, name) for name in SETTLING}
    known = {name: one for name, one in changes.items() if one}
    if not known:
        return None
    sooner, later = (any(sign * one > HARDLY for group in known.values() for one in group) for sign in (-1.0, 1.0))
    everywhere = all(one < -HARDLY for group in known.values() for one in group) and set(known) == set(SETTLING)
    verdict: Verdict = "confirmed" if everywhere else "confirmed under conditions" if sooner else "contradicted"
    parts = [f"to {SETTLING[name]} by {_range(one)} ({_runs(len(one))})" for name, one in known.items()]
    left_out = sum(len(one) for one in [found]) * len(SETTLING) - sum(len(one) for one in known.values())
    text = f"With the same linear part the switching term changes the settling time {', '.join(parts)}"
    if sooner and not everywhere:
        text += f": sooner by more than {percent(HARDLY)} only to {_sooner(known)}"
        text += ", and later elsewhere" if later else ""
    elif not sooner and not later:
        text += f": nothing beyond {percent(HARDLY)}"
    text += f". {_rates(found[0][0])}"
    if left_out:
        text += " Left out are runs that start within a threshold or had not settled for good (within it for the last"
        text += " quarter of the run), and times and changes that are not converged with the step."
    return Finding(verdict, text)


def _changes(found: list[tuple[Run, Run]], name: str) -> list[float]:
    changes = [sure_change(b, a, name) for a, b in found]
    return [one for one in changes if one is not None]


def _sooner(known: dict[str, list[float]]) -> str:
    """Thresholds that at least one pair of runs reaches sooner, and in how many of its pairs."""
    counts = {name: sum(change < -HARDLY for change in one) for name, one in known.items()}
    return joined([f"{SETTLING[name]} ({count} of {len(known[name])})" for name, count in counts.items() if count])


def _runs(count: int) -> str:
    return f"{count} pair{'s' if count > 1 else ''} of runs"


def _range(found: list[float]) -> str:
    low, high = percent(min(found)), percent(max(found))
    return low if low == high else f"{low} to {high}"


def _rates(run: Run) -> str:
    """The asymptotic rates with and without sliding, from the gains."""
    p = run.planned.parameters
    sliding, linear = decay_rates(run)
    same = abs(sliding - linear) <= 1e-9 * abs(sliding)
    told_ = f"once sliding the error decays at {given(sliding)} 1/s (poles of S = 0), under pole placement at "
    rates = f"{told_}{given(linear)} 1/s (the slower of these and Q = {given(p['Q'])} 1/s)"
    return f"In the end, {rates}: {'for these gains the rates coincide' if same else 'sliding mode is faster'}."


def errors(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """Whether steady-state errors are small without disturbance."""
    found = [
        (a, b)
        for _, a, b in pairs(comparison, cases, ["saturation", "sign"])
        if is_nominal(a) and not is_regulation(a) and is_long_enough(a)
    ]
    if not found:
        return None
    linear, sliding = [a for a, _ in found], [b for _, b in found]
    nil = all(largest(run, "rms_tail_error") < ROUNDING for run in (*linear, *sliding))
    text = "On the circle and without disturbance the RMS error of the last quarter is "
    if nil:
        text += "below 1 nm under each law: nil for every purpose, and no merit of the switching term."
    else:
        text += f"{spread_of(linear, 'rms_tail_error', 'm', 2)} under pole placement and "
        text += f"{spread_of(sliding, 'rms_tail_error', 'm', 2)} under sliding mode."
    if nil:
        return Finding("confirmed", text)
    small = all(largest(run, "rms_tail_error") < SETTLED for run in sliding)
    text += f" It holds for what asks for no better than {given(100.0 * SETTLED)} cm." if small else ""
    return Finding("confirmed under conditions" if small else "contradicted", text)


def chattering(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """How much more each input varies than under pole placement, each channel against itself."""
    tracking = [
        (scenario, runs)
        for scenario, runs in cases
        if all(is_nominal(run) and not is_regulation(run) for run in runs.values())
    ]
    relay = _ratios(comparison, tracking, "sign")
    if not relay["u1"]:
        return None
    smooth = _ratios(comparison, tracking, "saturation")
    u1, u2 = max(relay["u1"]), max(relay["u2"])
    text = (
        f"Total variation over a run on the circle, as a multiple of the same input’s under pole placement: under the "
        f"sign function {_multiples(relay['u1'])} for u₁, which integrates the switching, and "
        f"{_multiples(relay['u2'])} for u₂, which gets it divided by |η₁|"
    )
    if smooth["u1"]:
        text += f"; with the boundary layer {_multiples(smooth['u1'])} and {_multiples(smooth['u2'])}"
    text += "." + _growth(comparison, tracking)
    if u1 > ROUGH:
        return Finding("contradicted", text)
    if u2 > ROUGH:
        return Finding("confirmed under conditions", f"{text} It holds for u₁, and not for u₂ under the sign function.")
    return Finding("confirmed", text)


def _ratios(comparison: Comparison, cases: list[Case], kind: str) -> dict[str, list[float]]:
    """Total variation under a kind of law over that under pole placement, where the latter is not nil."""
    found: dict[str, list[float]] = {"u1": [], "u2": []}
    for _, a, b in pairs(comparison, cases, [kind]):
        for name, ratios in found.items():
            base, value = (both(run, f"total_variation_{name}")[0] for run in (a, b))
            if base is not None and value is not None and base > STILL:
                ratios.append(value / base)
    return found


def _multiples(found: list[float]) -> str:
    low, high = number(min(found)), number(max(found))
    return low if low == high else f"{low} to {high}"


def _growth(comparison: Comparison, cases: list[Case]) -> str:
    """Whether the variation of u2 under the relay grows as the step shrinks, from the runs at half the step."""
    relay = {law.name for law in of_kind(comparison, ["sign"])}
    runs = [run for _, found in cases for name, run in found.items() if name in relay]
    grown = [one for one in (sensitivity(run, "total_variation_u2") for run in runs) if one is not None]
    if not grown or min(grown) <= HARDLY:
        return ""
    return (
        f" These are multiples at the step of the study: at half of it u₂ varies {_range(grown)} more under the sign "
        "function, and without limit as the step shrinks."
    )


def smoothness(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """Whether the runs of the paper's figures settle, and whether a robot could follow them."""
    figures = [(s, run) for s, runs in cases if s.figure is not None for run in runs.values()]
    if not figures:
        return None
    open_ = [run for _, run in figures if not settled(run)]
    late = [run.planned.name for run in open_ if run.metrics.settling_time is not None]
    violent = any(_is_violent(run) for _, run in figures)
    linear = {law.name for law in of_kind(comparison, ["linear"])}
    text = "Not each" if open_ else "Stabilisation and convergence are seen: each"
    text += " run of the figures settles to 1 cm"
    text += f" ({joined(late)} had not settled for good)" if late else ""
    text += f". {_extremes(figures)}"
    if violent:
        text += f": far beyond a laboratory robot (taken as at most {given(FAST)} m/s and {given(VIOLENT)} rad/s²)"
        text += (
            ", and under pole placement too"
            if any(_is_violent(r) for _, r in figures if r.planned.law in linear)
            else ""
        )
        text += ". On such a robot, as printed, neither smooth nor applicable"
    if open_:
        return Finding("contradicted" if len(late) < len(open_) else "confirmed under conditions", f"{text}.")
    if not violent:
        return Finding("confirmed", f"{text}.")
    return Finding("confirmed under conditions", f"{text}. It holds for convergence, and for a robot without limits.")


def _is_violent(run: Run) -> bool:
    return (run.metrics.peak_speed or 0.0) > FAST or (run.metrics.peak_yaw_acceleration or 0.0) > VIOLENT


def _extremes(figures: list[tuple[Scenario, Run]]) -> str:
    fastest = max(figures, key=lambda one: one[1].metrics.peak_speed or 0.0)
    hardest = max(figures, key=lambda one: one[1].metrics.peak_yaw_acceleration or 0.0)
    gains = "the printed gains" if all(has_printed_gains(run) for _, run in figures) else "the gains of this study"
    return (
        f"With {gains} and the start velocity chosen here, the robot reaches {told(fastest[1], 'peak_speed')} m/s "
        f"(figure {fastest[0].figure}), and {told(hardest[1], 'peak_yaw_acceleration')} rad/s² of yaw acceleration "
        f"(figure {hardest[0].figure}) where it moves at only {told(hardest[1], 'peak_yaw_speed')} m/s"
    )
