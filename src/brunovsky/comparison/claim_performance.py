"""Claims of the paper about convergence, steady-state errors, chattering and smoothness."""

from __future__ import annotations

import math

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
from brunovsky.comparison.facts import given, joined, percent, spread
from brunovsky.comparison.findings_steady import HARDLY, ROUNDING, STILL
from brunovsky.comparison.metrics import SETTLED
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import largest, least, sensitivity, settled, spread_of, sure_change, told
from brunovsky.comparison.study import Scenario

FAST = 5.0  # m/s; faster than any laboratory robot of this kind
VIOLENT = 1e3  # rad/s2; beyond any drive of such a robot
REDUCED = 10.0  # times less variation in the steady state, from which chatter is said to be considerably reduced
_ROUGHNESS = {"roughness_u1": ("u₁", "m/s²"), "roughness_u2": ("u₂", "rad/s²")}
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
        names = sorted(
            {run.planned.law for run in (*linear, *sliding)}, key=[law.name for law in comparison.study.laws].index
        )
        text += f"below 1 nm under each of the paper’s laws ({joined([f'“{name}”' for name in names])}): nil for every "
        text += "purpose, and no merit of the switching term."
        if any(not law.in_family for law in comparison.study.laws):
            text += " Laws of other kinds are not meant; the tables have theirs."
    else:
        text += f"{spread_of(linear, 'rms_tail_error', 'm', 2)} under pole placement and "
        text += f"{spread_of(sliding, 'rms_tail_error', 'm', 2)} under sliding mode."
    if nil:
        return Finding("confirmed", text)
    small = all(largest(run, "rms_tail_error") < SETTLED for run in sliding)
    text += f" It holds for what asks for no better than {given(100.0 * SETTLED)} cm." if small else ""
    return Finding("confirmed under conditions" if small else "contradicted", text)


def chattering(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """What a boundary layer leaves of the chatter of the sign function, in the steady state and in each input.

    The variation of a transient under pole placement depends on the start, so that no multiple of it is a measure.
    """
    layers, relays = (of_kind(comparison, [kind]) for kind in ("saturation", "sign"))
    found = [
        (runs[a.name], runs[b.name])
        for _, runs in cases
        for a in layers
        for b in relays
        if a.name in runs and b.name in runs and is_nominal(runs[b.name]) and not is_regulation(runs[b.name])
    ]
    rough = {name: [pair for pair in found if least(pair[1], name) > STILL] for name in _ROUGHNESS}
    if not any(rough.values()):
        return None
    text = f"In the last quarter of runs on the circle ({_runs(len(found))}, without disturbance) there vary each "
    text += f"second {joined([_varies(found, name) for name in _ROUGHNESS])}."
    reduced = {name: sum(_is_reduced(*pair, name) for pair in some) for name, some in rough.items()}
    counts = [f"{reduced[name]} of {len(some)} for {_ROUGHNESS[name][0]}" for name, some in rough.items() if some]
    text += " Reduced, to a tenth or less, is what the boundary layer leaves relative to the sign function: in "
    text += f"{joined(counts)} where the latter chatters."
    text += _under_the_relay([b for _, b in found])
    if not any(reduced.values()):
        return Finding("contradicted", text)
    if any(reduced[name] < len(some) for name, some in rough.items()):
        return Finding("confirmed under conditions", f"{text} It holds in the runs that are counted, and no others.")
    if rough["roughness_u1"]:
        return Finding(
            "confirmed under conditions",
            f"{text} It holds with the boundary layer, for both inputs, and not under the sign function.",
        )
    return Finding("confirmed", text)


def _is_reduced(layer: Run, relay: Run, name: str) -> bool:
    return largest(layer, name) <= max(least(relay, name) / REDUCED, STILL)


def _varies(found: list[tuple[Run, Run]], name: str) -> str:
    symbol, unit = _ROUGHNESS[name]
    relay, layer = _amount([b for _, b in found], name, unit), _amount([a for a, _ in found], name, unit)
    return f"{symbol} by {relay} under the sign function and {layer} with the boundary layer"


def _amount(runs: list[Run], name: str, unit: str) -> str:
    quiet = all(largest(run, name) < STILL for run in runs)
    return f"less than {given(STILL)}\u00a0{unit}" if quiet else spread_of(runs, name, unit)


def _under_the_relay(runs: list[Run]) -> str:
    """What sets the two inputs apart under the sign function: u1 integrates the switching, u2 takes it as it is."""
    text = ""
    limits = [math.sqrt(2.0) * one.planned.parameters["P"] / abs(one.planned.parameters["C[3]"]) for one in runs]
    if all(largest(run, "roughness_u1") <= limit for run, limit in zip(runs, limits, strict=True)):
        text = " Under the sign function u₁, which integrates the switching, keeps within what the relay’s amplitude "
        text += f"√2 P/c₃ allows at any step ({spread(limits, 'm/s²')} each second)"
    grown = [one for one in (sensitivity(run, "roughness_u2") for run in runs) if one is not None]
    if not grown or min(grown) <= HARDLY:
        return f"{text}." if text else ""
    more = f"u₂, which gets it divided by |η₁|, varies {_range(grown)} more at half the step, and without limit as the "
    more += "step shrinks."
    return f"{text}; {more}" if text else f" Under the sign function {more}"


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
