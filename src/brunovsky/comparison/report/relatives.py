"""Many laws of other kinds against pole placement, in one sentence for each metric."""

from __future__ import annotations

from brunovsky.comparison.claim import is_nominal
from brunovsky.comparison.facts import joined, percent
from brunovsky.comparison.findings_steady import ROUNDING
from brunovsky.comparison.report.pairs import SHARE, Pair, acting_on, diverges, instead, range_of, rough, tiny
from brunovsky.comparison.sensitivity import converged, largest, sure_change

LISTED = 4  # laws, beyond which a sentence tells the best and the worst of them
Group = tuple[str, list[Pair]]


def relatives(groups: list[Group]) -> list[str]:
    """Many laws of other kinds, each against pole placement, in one sentence for each metric."""
    laws = [(label.removeprefix("the law "), pairs) for label, pairs in groups]
    nominal, other = ([(law, _some(pairs, kind)) for law, pairs in laws] for kind in (True, False))
    acting = f"under {acting_on([pair for _, pairs in other for pair in pairs])}"
    sentences = [
        _metric("settling_time", nominal, "without disturbance"),
        _metric("rms_tail_error", nominal, "without disturbance"),
        _metric("rms_tail_error", other, acting),
    ]
    return [*filter(None, sentences), *_rougher(laws)]


def _some(pairs: list[Pair], nominal: bool) -> list[Pair]:
    return [pair for pair in pairs if is_nominal(pair[0]) is nominal]


def _metric(name: str, laws: list[Group], where: str) -> str:
    """What becomes of one metric under each law; empty where there is nothing to compare."""
    changed: list[tuple[str, list[float], int]] = []
    unsure, nil, small, faint, growing = [], [], [], [], []
    for law, every in laws:
        steady = [pair for pair in every if not any(map(diverges, pair))]
        left = [pair for pair in steady if not _is_nil(pair, name)]
        if len(steady) < len(every):
            growing.append(law)
        if steady and not left:
            nil.append(law)
            continue
        pairs = [pair for pair in left if pair not in tiny(left, name)]
        known = [change for a, b in pairs for change in [sure_change(b, a, name)] if change is not None]
        if len(pairs) < len(left):
            small.append(law)
            faint += tiny(left, name)
        if known:
            changed.append((law, known, len(pairs)))
        elif pairs:
            unsure.append(law)
    parts = [_told(changed)] if changed else []
    parts += [f"is not ranked, as the step decides or it is undefined, under {_listed(unsure)}"] if unsure else []
    parts += [f"is {instead(faint, name)} under {_listed(small)}, too little to tell a share of"] if small else []
    parts += [f"is nil, as under pole placement (below 1 nm), under {_listed(nil)}"] if nil else []
    if growing:
        parts.append(f"is not compared where the error grows to the end in a run of the pair, under {_listed(growing)}")
    return f"Against pole placement and {where}, {SHARE[name]} {'; '.join(parts)}." if parts else ""


def _is_nil(pair: Pair, name: str) -> bool:
    return name == "rms_tail_error" and all(largest(run, name) < ROUNDING for run in pair)


def _told(found: list[tuple[str, list[float], int]]) -> str:
    """By how much a metric changes under each of a few laws; of many the best and the worst."""
    if len(found) <= LISTED:
        parts = []
        for law, changes, total in found:
            left = "" if len(changes) == total else f", in {len(changes)} of {total}"
            parts.append(f"{range_of(changes)} under {law}{left}")
        return f"changes by {joined(parts)}"
    best, worst = min(found, key=lambda one: min(one[1])), max(found, key=lambda one: max(one[1]))
    known, total = sum(len(changes) for _, changes, _ in found), sum(total for *_, total in found)
    return (
        f"changes under {len(found)} laws ({known} of {total} pairs of runs) by {percent(min(best[1]))} at best, under "
        f"{best[0]}, and {percent(max(worst[1]))} at worst, under {worst[0]}; the tables have each"
    )


def _listed(laws: list[str]) -> str:
    return joined(laws) if len(laws) <= LISTED else f"{len(laws)} laws"


def _rougher(laws: list[Group]) -> list[str]:
    """Under which of many laws the yaw acceleration varies more than under pole placement."""
    found, decided = [], False
    for law, pairs in laws:
        rugged = rough(pairs)
        grows = sum(not converged(run, "total_variation_u2") for run in rugged)
        decided = decided or bool(grows)
        text = f"{law}, in {len(rugged)} of {len(pairs)}" + (f" ({grows} by the step)" if grows else "")
        found += [text] if rugged else []
    if not found:
        return []
    what = "; by the step: the step decides on the number, not the law alone" if decided else ""
    return [f"Of the pairs of runs, u₂ varies more than under pole placement under {_listed(found)}{what}."]
