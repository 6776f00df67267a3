"""The verdict at the top of a report: sentences that follow from the numbers, and say no more than these."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from brunovsky.comparison.agreement import coupling_headline
from brunovsky.comparison.claim import Claim, Verdict, is_nominal
from brunovsky.comparison.claim_performance import FAST, VIOLENT
from brunovsky.comparison.facts import given, joined
from brunovsky.comparison.findings_steady import HARDLY, ROUNDING
from brunovsky.comparison.protocol_section import ProtocolSection
from brunovsky.comparison.report.pairs import (
    SHARE,
    Pair,
    acting_on,
    count_of,
    diverges,
    growing,
    instead,
    range_of,
    rough,
    tiny,
)
from brunovsky.comparison.report.relatives import relatives
from brunovsky.comparison.report.unsettled import unsettled
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import both, converged, largest, settled, spread_of, sure_change

_SWITCHING = "the switching term of the same linear part"
MANY = 3  # laws of other kinds, beyond which they share their sentences


def verdict(comparison: Comparison, claims: Sequence[Claim], sections: Sequence[ProtocolSection] = ()) -> list[str]:
    """Sentences of the verdict, the weightiest first: of a study of coupling its error, else the ranking of laws.

    A difference between two runs is told if both numbers and the difference itself are converged with the step; the
    others are counted and rank no law. Runs that failed come first, and are in no comparison.
    """
    groups = _against_pole_placement(comparison)
    sentences: list[str] = []
    others = [(label, pairs) for label, pairs in groups if label != _SWITCHING]
    many = len(others) > MANY
    for label, pairs in groups:
        sentences += [] if many and label != _SWITCHING else _compared(label, pairs)
    sentences += relatives(others) if many else []
    if not groups:
        sentences.append(
            "No scenario has a run under pole placement and one under another law that both reached their end: nothing "
            "is compared."
        )
    sentences += unsettled(comparison)
    sentences += [one.headline for one in sections if one.headline and not one.leads]
    sentences = [*_on_coupling(comparison), *(one.headline for one in sections if one.leads), *sentences]
    ended, complete = _ended(comparison), all(run.ok for run in comparison.runs)
    around = [*_strain(comparison), *_on_claims(claims)]
    return [*sentences, *around, ended] if complete else [ended, *sentences, *around]


def _on_coupling(comparison: Comparison) -> list[str]:
    """What running through a package, or a file of the study's own, makes of the numbers."""
    found = [run.agreement for run in comparison.runs if run.agreement is not None]
    text = coupling_headline(found, comparison.provenance)
    return [text] if text else []


def _ended(comparison: Comparison) -> str:
    failed = [run for run in comparison.runs if not run.ok]
    count = len(comparison.runs)
    if not failed:
        return (
            "The one run of the scenarios reached its end."
            if count == 1
            else f"All {count} runs of the scenarios reached their end."
        )
    names = joined([f"{run.planned.name} ({run.status.state})" for run in failed])
    return f"{len(failed)} of {count} runs of the scenarios failed: {names}. They are in none of the comparisons below."


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


def _compared(label: str, pairs: list[Pair]) -> list[str]:
    nominal = [pair for pair in pairs if is_nominal(pair[0])]
    others = [pair for pair in pairs if not is_nominal(pair[0])]
    sentences = []
    for name, some, where in (
        ("settling_time", nominal, "without disturbance"),
        ("rms_tail_error", nominal, "without disturbance"),
        ("rms_tail_error", others, f"under {acting_on(others)}"),
    ):
        sentence = _difference(name, some)
        if sentence:
            sentences.append(f"Against pole placement and {where}, {label} {sentence}")
    return [*sentences, *_price(label, pairs)]


def _difference(name: str, pairs: list[Pair]) -> str:
    """What happens to one metric; empty where there is nothing to compare."""
    if not pairs:
        return ""
    what, aside = SHARE[name], ""
    apart = [pair for pair in pairs if any(map(diverges, pair))]
    if apart:
        pairs = [pair for pair in pairs if pair not in apart]
        aside = f"; {growing(apart)}"
        if not pairs:
            return f"is not compared by {what}: {growing(apart)}."
    if name == "rms_tail_error":
        nil = [pair for pair in pairs if all(largest(run, name) < ROUNDING for run in pair)]
        pairs = [pair for pair in pairs if pair not in nil]
        if not pairs:
            return f"leaves {what} nil for every purpose, as it is without (below 1 nm; {count_of(len(nil))}{aside})."
        aside += f"; in {count_of(len(nil))} it is nil with and without (below 1 nm)" if nil else ""
    if all(both(run, name)[0] == 0.0 for pair in pairs for run in pair):
        return ""
    open_ = [pair for pair in pairs if not all(map(settled, pair))] if name == "settling_time" else []
    if open_:
        pairs = [pair for pair in pairs if pair not in open_]
        aside += _unsettled(open_)
        if not pairs:
            return f"is not ranked by {what}{aside.replace(';', ':', 1)}."
    small = tiny(pairs, name)
    if small:
        pairs = [pair for pair in pairs if pair not in small]
        if not pairs:
            return f"leaves {what} at {instead(small, name)} ({count_of(len(small))}{aside})."
        aside += f"; in {count_of(len(small))} it is {instead(small, name)}, too little to tell a share of"
    known = [change for a, b in pairs for change in [sure_change(b, a, name)] if change is not None]
    left = len(pairs) - len(known)
    if not known:
        return f"cannot be ranked by {what}: no difference in it is converged with the step ({count_of(left)}){aside}."
    counted = f"{range_of(known)} in {count_of(len(known))}"
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
    return "".join(f"; in {count_of(settles.count(one))} {text}" for one, text in words if one in settles)


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
    rugged = rough(pairs)
    if not rugged:
        where = "in the one pair of runs" if len(pairs) == 1 else f"in any of these {count_of(len(pairs))}"
        return [f"It costs no more variation of u₂ than pole placement {where}."]
    grows = sum(not converged(run, name) for run in rugged)
    which = "the one pair of runs" if len(pairs) == 1 else f"{len(rugged)} of {count_of(len(pairs))}"
    text = f"Its price: in {which} u₂ varies more than under pole placement"
    if grows and len(pairs) == 1:
        text += ", by a number that the step decides, not the law alone"
    elif grows:
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
