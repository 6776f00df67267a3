"""The claim of the paper about measurement noise."""

from __future__ import annotations

from brunovsky.comparison.claim import SLIDING, Case, Finding, Verdict, of_kind, pairs
from brunovsky.comparison.facts import joined, percent
from brunovsky.comparison.features import run_features
from brunovsky.comparison.findings_steady import HARDLY
from brunovsky.comparison.protocols import MonteCarlo
from brunovsky.comparison.protocols.evaluation import phrase
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import is_tiny, sure_change, told

_MEASURED = {"n[1]": "the position", "n[2]": "the position", "n[3]": "the heading"}
_ERRORS = {"iae", "ise", "itae", "rms_tail_error"}  # metrics of a Monte-Carlo study that speak to the claim


def noise(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """What measurement noise leaves under sliding mode, against pole placement, scenario by scenario.

    Only scenarios with noise and nothing else decide: where a disturbance acts too, less error need not be the noise's.
    """
    alone: dict[str, list[float | None]] = {}
    parts: list[str] = []
    for one in cases:
        noisy = [(a, b) for _, a, b in pairs(comparison, [one], SLIDING) if "noise" in run_features(a.planned)]
        found = [(a, b, sure_change(b, a, "rms_tail_error")) for a, b in noisy]
        if not any(change is not None for _, _, change in found):
            continue
        pure = all(run_features(a.planned) == {"noise"} for a, _, _ in found)
        if pure:
            alone.setdefault(_measured(found[0][0]), []).extend(change for _, _, change in found)
        aside = "" if pure else " (not counted, as more than noise acts)"
        parts.append(f"{one[0].title}{aside}: {', '.join(_against(*pair) for pair in found)}")
    if not parts:
        return None
    text = f"RMS error of the last quarter with measurement noise, against pole placement. {'; '.join(parts)}."
    for sentence, where, change in _drawn(comparison, cases):
        text += f" {sentence}"
        if where:
            alone.setdefault(where, []).append(change)
    known = {where: [one for one in some if one is not None] for where, some in alone.items()}
    changes = [change for some in known.values() for change in some]
    if not changes:
        return Finding("confirmed under conditions", f"{text} No run with noise alone can be told.")
    verdict: Verdict = "confirmed under conditions"
    if min(changes) > HARDLY:
        return Finding("contradicted", f"{text} It holds for none of them.")
    if max(changes) <= HARDLY:
        return Finding("confirmed" if changes == [one for some in alone.values() for one in some] else verdict, text)
    return Finding(verdict, f"{text} {_condition(known)}")


def _condition(known: dict[str, list[float]]) -> str:
    """Under noise on what sliding mode is no worse than pole placement."""
    holds = [where for where, some in known.items() if some and max(some) <= HARDLY]
    fails = [where for where, some in known.items() if some and min(some) > HARDLY]
    mixed = [where for where, some in known.items() if some and where not in (*holds, *fails)]
    parts = [f"It holds for noise on {', or on '.join(holds)}"] if holds else ["It holds for no noise under each law"]
    parts += [f"not for noise on {', or on '.join(fails)}"] if fails else []
    parts += [f"under some laws only for noise on {', or on '.join(mixed)}"] if mixed else []
    return f"{', '.join(parts)}."


def _measured(run: Run) -> str:
    """On which measurements a run has noise."""
    return joined(list(dict.fromkeys(_MEASURED.get(name, "the velocities") for name in sorted(run.planned.noise))))


def _drawn(comparison: Comparison, cases: list[Case]) -> list[tuple[str, str, float | None]]:
    """What paired Monte-Carlo studies with noise tell of a sliding mode against pole placement.

    A sentence; noise on what, empty where that is no evidence; the change of the median, from pole placement.
    """
    linear, sliding = ([law.name for law in of_kind(comparison, kinds)] for kinds in (["linear"], SLIDING))
    runs = {scenario.name: next(iter(found.values())) for scenario, found in cases}
    told_: list[tuple[str, str, float | None]] = []
    for protocol in comparison.protocols:
        result, run = protocol.result, runs.get(protocol.table.scenario)
        if not isinstance(result, MonteCarlo) or run is None or "noise" not in run_features(run.planned):
            continue
        title, pure = comparison.study.scenario(protocol.table.scenario).title, run_features(run.planned) == {"noise"}
        medians = {(one.law, one.metric): one.median.estimate for one in result.summaries}
        for one in result.differences:
            names = {one.first, one.second}
            apart, other = one.median.estimate, next(iter(names & set(sliding)), "")
            base = next(iter(names & set(linear)), "")
            if not other or not base or one.metric in result.step_sensitive or one.lower is None or apart is None:
                continue
            higher = medians[one.second if one.lower == one.first else one.first, one.metric]
            before = medians[base, one.metric]
            if not higher or not before:
                continue
            sentence = f"Over {one.median.n} paired cases of “{title}” the {phrase(one.metric)} is "
            sentence += f"{percent(abs(apart) / higher)} lower under “{one.lower}” than under "
            sentence += f"“{other if one.lower == base else base}” (median; the intervals exclude zero)."
            counts = pure and one.metric in _ERRORS
            change = abs(apart) / before * (1.0 if one.lower == base else -1.0)
            told_.append((sentence, _measured(run) if counts else "", change if counts else None))
    return told_


def _against(linear: Run, other: Run, change: float | None) -> str:
    """Whether the error under another law is less than under pole placement, with both numbers."""
    name, law = "rms_tail_error", f"under “{other.planned.law}”"
    numbers = f"{told(other, name)} instead of {told(linear, name)} m"
    if change is None:
        return f"not told {law}, as the step decides ({numbers})"
    word = "better" if change < 0.0 else "worse"
    if is_tiny(linear, name):
        return f"{'level' if abs(change) <= HARDLY else word} {law} ({numbers})"
    if abs(change) <= HARDLY:
        return f"level {law} ({numbers})"
    return f"{word} {law} ({percent(change)}: {numbers})"
