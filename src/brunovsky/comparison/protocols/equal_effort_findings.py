"""Sentences on laws at equal effort: how they were tuned, and which differences neither tuning nor step explains."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from brunovsky.comparison.facts import CONVERGED, TINY, joined, number, percent
from brunovsky.comparison.protocols.evaluation import Trial, phrase, unit
from brunovsky.comparison.protocols.tuning import Tuning
from brunovsky.comparison.symbols import setting, symbol

if TYPE_CHECKING:
    from brunovsky.comparison.protocols.equal_effort import EqualEffort

LISTED = 4  # laws, beyond which a headline tells the best and the worst of them, and a finding no differences


def effort_findings(result: EqualEffort) -> list[str]:
    """Sentences that follow from the numbers."""
    told = _tunings(result)
    if len(result.tuned) < 2:
        return [*told, "Fewer than two laws reach the effort, so there is nothing to compare."]
    if result.effort in result.step_sensitive:
        return [
            *told,
            f"The effort itself, {phrase(result.effort)}, depends on the step of the simulation: no law is ranked.",
        ]
    compared = [_compared(result, metric) for metric in result.metrics if metric != result.effort]
    if result.idle:
        told.append(
            "All laws have this effort at the same value of the knob: it is that of the common start, the tuning "
            "changed nothing, and what follows compares the laws as they are."
        )
    return told + compared


def _tunings(result: EqualEffort) -> list[str]:
    """How each law was tuned; of many that were, in one sentence, as the table has each."""
    far = max((abs(_offset(result, one.trial)) for one in result.tunings if one.trial), default=0.0)
    size = f"{number(result.target)}\u00a0{unit(result.effort)}".rstrip()
    within = f"within {percent(result.rtol)} of its target, {size}, which counts as equal"
    tuned = [one for one in result.tunings if one.trial is not None]
    if len(tuned) <= LISTED:
        told = [_tuning(result, one) for one in result.tunings]
        return [*told, f"The tuning takes the {phrase(result.effort)} {within}."] if tuned else told
    told = [
        f"{len(tuned)} laws have the {phrase(result.effort)} {within}; in fact within {_share(far)}. The table has "
        "each with its knob."
    ]
    bent = [f"“{one.law}”" for one in tuned if not one.monotone]
    if bent:
        told.append(f"The effort is not monotone in the knob under {joined(bent)}.")
    return told + [_tuning(result, one) for one in result.tunings if one.trial is None]


def _offset(result: EqualEffort, trial: Trial) -> float:
    """How far the effort of a run is off the target, relative."""
    effort = trial.value(result.effort)
    return 0.0 if effort is None else effort / result.target - 1.0


def _tuning(result: EqualEffort, one: Tuning) -> str:
    of = f"“{one.law}”"
    if one.trial is None or one.value is None:
        return f"{of} is not compared: {one.reason} ({one.runs} of {result.budget} runs)."
    effort = one.trial.value(result.effort)
    text = (
        f"{of} has {phrase(result.effort)} = {number(effort)} {unit(result.effort)}".rstrip()
        + f", {_share(abs(_offset(result, one.trial)))} off the target, at "
        f"{setting(one.knob.parameter, one.value, number)} ({one.runs} of {result.budget} runs)"
    )
    return text + ("." if one.monotone else f"; its effort is not monotone in {symbol(one.knob.parameter)}.")


def effort_headline(result: EqualEffort) -> str:
    """The one sentence for a verdict: the first metric at equal effort; of many laws the best and the worst."""
    if result.idle:
        return ""
    unranked = {result.effort, *result.step_sensitive}
    ranked = [one for one in result.metrics if one not in unranked and len(_ordered(result, one)) > 1]
    if not ranked or result.effort in result.step_sensitive:
        return effort_findings(result)[0]
    metric = ranked[0]
    (least, low), *others, (most, high) = _ordered(result, metric)
    if len(others) + 2 <= LISTED or _excess(result, least, most, metric, low, high) is None:
        return _compared(result, metric)
    size = f"\u00a0{unit(metric)}".rstrip()
    text = f"{_of(result, metric)} is, of {len(others) + 2} laws, lowest under “{least}” ({number(low)}{size})"
    alike = _alike(result, metric)
    text += f"{alike}," if alike else ""
    return f"{text} and highest under “{most}” ({number(high)}{size}); the table has each.{_left_out(result, metric)}"


def _of(result: EqualEffort, metric: str) -> str:
    return f"At equal effort the {phrase(metric)}"


def _ordered(result: EqualEffort, metric: str) -> list[tuple[str, float]]:
    """Laws at equal effort with a metric that is defined and not the step's, the lowest first."""
    known = [
        (law, trial.value(metric)) for law, trial in result.tuned.items() if not _step_decides(result, law, metric)
    ]
    return sorted([(law, value) for law, value in known if value is not None], key=lambda one: one[1])


def _step_decides(result: EqualEffort, law: str, metric: str) -> bool:
    return bool({metric, result.effort} & result.unsure.get(law, frozenset()))


def _left_out(result: EqualEffort, metric: str) -> str:
    """Which laws are not ranked by a metric as the step decides on it."""
    laws = [f"“{law}”" for law in result.tuned if _step_decides(result, law, metric)]
    if not laws:
        return ""
    it = "its value changes" if len(laws) == 1 else "their values change"
    return f" Not ranked {_is(laws)} {joined(laws)}: {it} by more than {percent(CONVERGED)} at half the step."


def _compared(result: EqualEffort, metric: str) -> str:
    if metric in result.step_sensitive:
        laws = [f"“{law}”" for law in result.tuned if _step_decides(result, law, metric)]
        under = f" under {joined(laws)}" if laws else ""
        return f"The {phrase(metric)} depends on the step of the simulation{under}: it ranks no law."
    ordered = _ordered(result, metric)
    if len(ordered) < 2:
        return f"The {phrase(metric)} is defined under fewer than two laws."
    listed = ", ".join(f"{number(value)} ({law})" for law, value in ordered)
    text = f"{_of(result, metric)}{f', {unit(metric)},' if unit(metric) else ''} is {listed}"
    (least, low), *others = ordered
    higher = {law: _excess(result, least, law, metric, low, value) for law, value in others}
    tiny = unit(metric) == "m" and low < TINY
    apart = [
        f"under “{law}” it is higher by {f'{number(value - low)} m' if tiny else percent(share)}"
        for law, value in others
        if (share := higher[law]) is not None
    ]
    left_out = _left_out(result, metric)
    if not apart:
        most = max(_slack(result, least, law, metric) for law, _ in others)
        return f"{text}: the laws are not told apart (within {_explained(result, most)}).{left_out}"
    lowest = f"{text}: in this case lowest under “{least}”{_alike(result, metric)}"
    if len(ordered) > LISTED:  # the values say by how much
        return f"{lowest}.{left_out}"
    most = max(_slack(result, least, law, metric) for law, _ in others if higher[law] is not None)
    causes = "the offsets from the target" + (" and the step" if result.finer else "")
    return f"{lowest}; {joined(apart)}, of which {causes} explain {_share(most)} at most.{left_out}"


def _alike(result: EqualEffort, metric: str) -> str:
    """Which laws are not told apart from the lowest, and what explains their difference; empty for none."""
    (least, low), *others = _ordered(result, metric)
    found = [law for law, value in others if _excess(result, least, law, metric, low, value) is None]
    if not found:
        return ""
    most = max(_slack(result, least, law, metric) for law in found)
    names = [f"“{law}”" for law in found]
    return f", from which {joined(names)} {_is(names)} not told apart (within {_explained(result, most)})"


def _explained(result: EqualEffort, slack: float) -> str:
    """Up to what difference laws are not told apart, and why."""
    causes = "the offsets from the target" + (" and the step" if result.finer else "")
    if slack >= 1.0:
        return f"any difference, which {causes} may explain"
    if slack > CONVERGED:
        return f"{percent(slack)}, which {causes} explain"
    return f"{percent(CONVERGED)}, the tolerance of numbers; {causes} explain {_share(slack)}"


def _slack(result: EqualEffort, first: str, second: str, metric: str) -> float:
    """Relative difference of a metric that the efforts of two laws being off the target explain, and their step."""
    both = (first, second)
    found = sum(one.slack(result.effort, metric, result.target) for one in result.tunings if one.law in both)
    for one in result.finer:
        value, half = result.tuned[one.law].value(metric), one.value(metric)
        if one.law in both and value and half is not None:
            found += abs(half / value - 1.0)
    return min(1.0, found)


def _excess(result: EqualEffort, least: str, law: str, metric: str, low: float, value: float) -> float | None:
    """By what share a law's metric is above the lowest; None where the tuning or the step explains it."""
    size = max(abs(low), abs(value))
    if size == 0.0 or value - low <= max(CONVERGED, _slack(result, least, law, metric)) * size:
        return None
    return (value - low) / abs(low) if low else 1.0


def _share(value: float) -> str:
    return percent(value) if value > 1e-4 else "less than 0.01\u00a0%"


def _is(some: Sequence[str]) -> str:
    return "is" if len(some) == 1 else "are"
