"""The verdict at the top of a report: sentences that follow from the numbers, and say no more than these."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from brunovsky.comparison.claim import Claim, Verdict, is_nominal
from brunovsky.comparison.claim_performance import FAST, VIOLENT
from brunovsky.comparison.facts import given, joined, percent
from brunovsky.comparison.features import run_features
from brunovsky.comparison.findings_steady import HARDLY, ROUNDING, STILL
from brunovsky.comparison.protocol_section import ProtocolSection
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import both, converged, largest, settled, spread_of, sure_change

Pair = tuple[Run, Run]
_SHARE = {"settling_time": "the settling time to 1 cm", "rms_tail_error": "the RMS error of the last quarter"}

_SWITCHING = "the switching term of the same linear part"
MANY = 3  # laws of other kinds, beyond which they share their sentences
LISTED = 4  # laws, beyond which a sentence tells the best and the worst of them
_ACTING = {
    "disturbance": "disturbances",
    "uncertainty": "parameter errors",
    "noise": "measurement noise",
    "lag": "actuator lags",
    "delay": "delays",
    "limits": "limits of the inputs",
    "sampling": "sampling",
}


def verdict(comparison: Comparison, claims: Sequence[Claim], sections: Sequence[ProtocolSection] = ()) -> list[str]:
    """Sentences of the verdict, the weightiest first.

    A difference between two runs is told if both numbers and the difference itself are converged with the step; the
    others are counted and rank no law. Runs that failed come first, and are in no comparison.
    """
    groups = _against_pole_placement(comparison)
    sentences: list[str] = []
    relatives = [(label, pairs) for label, pairs in groups if label != _SWITCHING]
    many = len(relatives) > MANY
    for label, pairs in groups:
        sentences += [] if many and label != _SWITCHING else _compared(label, pairs)
    sentences += _relatives(relatives) if many else []
    if not groups:
        sentences.append(
            "No scenario has a run under pole placement and one under another law that both reached their end: nothing "
            "is compared."
        )
    sentences += [one.headline for one in sections if one.headline]
    ended, complete = _ended(comparison), all(run.ok for run in comparison.runs)
    around = [*_strain(comparison), *_on_claims(claims)]
    return [*sentences, *around, ended] if complete else [ended, *sentences, *around]


def _ended(comparison: Comparison) -> str:
    failed = [run for run in comparison.runs if not run.ok]
    count = len(comparison.runs)
    if not failed:
        return "The one run reached its end." if count == 1 else f"All {count} runs reached their end."
    names = joined([f"{run.planned.name} ({run.status.state})" for run in failed])
    return f"{len(failed)} of {count} runs failed: {names}. They are in none of the comparisons below."


def _against_pole_placement(comparison: Comparison) -> list[tuple[str, list[Pair]]]:
    """Pairs of runs that ended, pole placement first, for the switching term and for each law of another kind."""
    found: dict[str, list[Pair]] = {}
    for scenario in comparison.study.scenarios:
        pairs = [(law, run) for law, run in comparison.laws_of(scenario) if run.ok]
        base = next((run for law, run in pairs if law.kind == "linear"), None)
        for law, run in pairs:
            if base is None or law.kind == "linear":
                continue
            paper = law.kind in ("saturation", "sign")
            label = _SWITCHING if paper else f"the law “{law.name}”"
            found.setdefault(label, []).append((base, run))
    return [(label + _defaults(pairs), pairs) for label, pairs in found.items()]


def _defaults(pairs: list[Pair]) -> str:
    """A word where a law was run as it ships, with no parameter of its own chosen by the study."""
    return " (untuned defaults)" if all(_is_untuned(run) for _, run in pairs) else ""


def _is_untuned(run: Run) -> bool:
    controller = run.planned.loop.block.components.get("controller")
    if controller is None or run.planned.in_family:
        return False
    own = {one.name for one in controller.parameters} - {"sampling_period"}
    return own.isdisjoint(name.removeprefix("controller.") for name in run.planned.given)


def _relatives(groups: list[tuple[str, list[Pair]]]) -> list[str]:
    """Many laws of other kinds, each against pole placement, in one sentence for each metric."""
    sentences = []
    for name, nominal in (("settling_time", True), ("rms_tail_error", True), ("rms_tail_error", False)):
        told: list[tuple[str, list[float], int]] = []
        unsure, nil, acting = [], [], ""
        for label, every in groups:
            law, pairs = label.removeprefix("the law "), [pair for pair in every if is_nominal(pair[0]) is nominal]
            acting = "without disturbance" if nominal else f"under {_acting(pairs)}"
            changes = [change for a, b in pairs for change in [sure_change(b, a, name)] if change is not None]
            if (
                pairs
                and all(largest(run, "rms_tail_error") < ROUNDING for pair in pairs for run in pair)
                and (name == "rms_tail_error")
            ):
                nil.append(law)
            elif changes:
                told.append((law, changes, len(pairs)))
            elif pairs:
                unsure.append(law)
        parts = [_told(told)] if told else []
        parts += [f"is not ranked, as the step decides or it is undefined, under {_listed(unsure)}"] if unsure else []
        parts += [f"is nil, as under pole placement (below 1 nm), under {_listed(nil)}"] if nil else []
        if parts:
            sentences.append(f"Against pole placement and {acting}, {_SHARE[name]} {'; '.join(parts)}.")
    return [*sentences, *_rougher(groups)]


def _told(found: list[tuple[str, list[float], int]]) -> str:
    """By how much a metric changes under each of a few laws; of many the best and the worst."""
    if len(found) <= LISTED:
        parts = []
        for law, changes, total in found:
            left = "" if len(changes) == total else f", in {len(changes)} of {total}"
            parts.append(f"{_range(changes)} under {law}{left}")
        return f"changes by {joined(parts)}"
    best, worst = min(found, key=lambda one: min(one[1])), max(found, key=lambda one: max(one[1]))
    known, total = sum(len(changes) for _, changes, _ in found), sum(total for *_, total in found)
    return (
        f"changes under {len(found)} laws ({known} of {total} pairs of runs) by {percent(min(best[1]))} at best, under "
        f"{best[0]}, and {percent(max(worst[1]))} at worst, under {worst[0]}; the tables have each"
    )


def _listed(laws: list[str]) -> str:
    return joined(laws) if len(laws) <= LISTED else f"{len(laws)} laws"


def _rougher(groups: list[tuple[str, list[Pair]]]) -> list[str]:
    """Under which of many laws the yaw acceleration varies more than under pole placement."""
    counts = [(label.removeprefix("the law "), len(_rough(pairs)), len(pairs)) for label, pairs in groups]
    rough = [f"{law}, in {count} of {total}" for law, count, total in counts if count]
    return [f"Of the pairs of runs, u₂ varies more than under pole placement under {_listed(rough)}."] if rough else []


def _rough(pairs: list[Pair]) -> list[Run]:
    """Runs in which the yaw acceleration varies more than under pole placement."""
    name = "total_variation_u2"
    return [b for a, b in pairs if (both(b, name)[0] or 0.0) > (1.0 + HARDLY) * (both(a, name)[0] or 0.0) + STILL]


def _compared(label: str, pairs: list[Pair]) -> list[str]:
    nominal = [pair for pair in pairs if is_nominal(pair[0])]
    others = [pair for pair in pairs if not is_nominal(pair[0])]
    sentences = []
    for name, some, where in (
        ("settling_time", nominal, "without disturbance"),
        ("rms_tail_error", nominal, "without disturbance"),
        ("rms_tail_error", others, f"under {_acting(others)}"),
    ):
        sentence = _difference(name, some)
        if sentence:
            sentences.append(f"Against pole placement and {where}, {label} {sentence}")
    return [*sentences, *_price(label, pairs)]


def _acting(pairs: list[Pair]) -> str:
    """What the runs of some pairs have that the nominal ones have not."""
    there = {one for pair in pairs for one in run_features(pair[0].planned)}
    return joined([text for name, text in _ACTING.items() if name in there] or ["other conditions"])


def _difference(name: str, pairs: list[Pair]) -> str:
    """What happens to one metric; empty where there is nothing to compare."""
    if not pairs:
        return ""
    what, aside = _SHARE[name], ""
    if name == "rms_tail_error":
        nil = [pair for pair in pairs if all(largest(run, name) < ROUNDING for run in pair)]
        pairs = [pair for pair in pairs if pair not in nil]
        if not pairs:
            return f"leaves {what} nil for every purpose, as it is without (below 1 nm; {_pairs(len(nil))})."
        aside = f"; in {_pairs(len(nil))} it is nil with and without (below 1 nm)" if nil else ""
    if all(both(run, name)[0] == 0.0 for pair in pairs for run in pair):
        return ""
    open_ = [pair for pair in pairs if not all(map(settled, pair))] if name == "settling_time" else []
    if open_:
        pairs = [pair for pair in pairs if pair not in open_]
        aside = _unsettled(open_)
        if not pairs:
            return f"is not ranked by {what}{aside.replace(';', ':', 1)}."
    known = [change for a, b in pairs for change in [sure_change(b, a, name)] if change is not None]
    left = len(pairs) - len(known)
    if not known:
        return f"cannot be ranked by {what}: no difference in it is converged with the step ({_pairs(left)}){aside}."
    counted = f"{_range(known)} in {_pairs(len(known))}"
    ending = f"; {left} more {'is' if left == 1 else 'are'} not converged with the step, or undefined" if left else ""
    return f"{_word(known)} {what} ({counted}{ending}{aside})."


def _unsettled(pairs: list[Pair]) -> str:
    """Pairs of runs of which one or both had not settled to 1 cm for good, in words."""
    settles = [tuple(map(settled, pair)) for pair in pairs]
    words = (
        ((False, True), "it settles for good, and pole placement had not"),
        ((True, False), "pole placement settles for good, and it had not"),
        ((False, False), "neither had settled for good"),
    )
    return "".join(f"; in {_pairs(settles.count(one))} {text}" for one, text in words if one in settles)


def _word(changes: list[float]) -> str:
    """What a set of relative changes may be called."""
    low, high = min(changes), max(changes)
    if low >= -HARDLY and high <= HARDLY:
        return "hardly changes"
    if high <= HARDLY:
        return "lowers" if high < -HARDLY else "leaves as it is, or lowers,"
    if low >= -HARDLY:
        return "raises" if low > HARDLY else "leaves as it is, or raises,"
    return "in some runs lowers and in others raises"


def _price(label: str, pairs: list[Pair]) -> list[str]:
    """What it costs in variation of the yaw acceleration."""
    name = "total_variation_u2"
    rough = _rough(pairs)
    if not rough:
        return [f"It costs no more variation of u₂ than pole placement in any of these {_pairs(len(pairs))}."]
    grows = sum(not converged(run, name) for run in rough)
    text = f"Its price: in {len(rough)} of {_pairs(len(pairs))} u₂ varies more than under pole placement"
    if grows:
        text += f", in {grows} of them by a number that the step decides, not the law alone"
    return [f"{text}."]


def _strain(comparison: Comparison) -> list[str]:
    """Speeds and yaw accelerations beyond any laboratory robot."""
    runs = [run for run in comparison.runs if run.ok]
    beyond = [
        run
        for run in runs
        if (run.metrics.peak_speed or 0.0) > FAST or (run.metrics.peak_yaw_acceleration or 0.0) > VIOLENT
    ]
    if not beyond:
        return []
    return [
        f"{len(beyond)} of {len(runs)} runs ask for more than a laboratory robot can do (taken as {given(FAST)} "
        "m/s and "
        f"{given(VIOLENT)} rad/s²): up to {spread_of([_peak(runs, 'peak_speed')], 'peak_speed', 'm/s')} and "
        f"{spread_of([_peak(runs, 'peak_yaw_acceleration')], 'peak_yaw_acceleration', 'rad/s²')}."
    ]


def _peak(runs: list[Run], name: str) -> Run:
    return max(runs, key=lambda run: both(run, name)[0] or 0.0)


def _on_claims(claims: Sequence[Claim]) -> list[str]:
    count = Counter(claim.verdict for claim in claims)
    if count["not examined"] == len(claims):
        return []
    words: tuple[Verdict, ...] = ("confirmed", "confirmed under conditions", "contradicted", "not examined")
    parts = [f"{count[word]} {'is' if count[word] == 1 else 'are'} {word}" for word in words if count[word]]
    return [f"Of {len(claims)} claims of the paper {joined(parts)}."]


def _range(found: list[float]) -> str:
    low, high = percent(min(found)), percent(max(found))
    return low if low == high else f"{low} to {high}"


def _pairs(count: int) -> str:
    return f"{count} pair{'' if count == 1 else 's'} of runs"
