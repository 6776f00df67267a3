"""What a study does not show, from what its runs have and lack."""

from __future__ import annotations

from brunovsky.comparison.claim import Claim
from brunovsky.comparison.facts import CONVERGED, given, joined
from brunovsky.comparison.features import features
from brunovsky.comparison.run import Comparison
from brunovsky.comparison.sensitivity import converged
from brunovsky.comparison.step_words import working_text
from brunovsky.comparison.study.loops import AIMS_AT_HEADING

_LACKING = {
    "noise": "measurement noise",
    "lag": "actuator lags",
    "delay": "delays",
    "limits": "limits of u₁ and u₂",
    "disturbance": "disturbances",
    "uncertainty": "errors of mass and inertia",
}

_BEYOND = {"map": "maps", "swept": "sweeps", "monte_carlo": "Monte-Carlo samples"}  # protocols, by kind


def limits(comparison: Comparison, claims: list[Claim]) -> list[str]:
    """Sentences, each true of this study."""
    study, plan = comparison.study, comparison.study.plan()
    regulated = [run.guard for run in plan if run.target is not None and run.guard is not None]
    found = [_lacking(comparison)]
    if any(one.figure is not None for one in study.scenarios):
        found.append(
            "The paper prints its gains and, for figure 5, start and target; speeds, durations, the rate along the "
            "circle "
            "and all conditions of figure 4 are chosen here. Agreement with its curves, of which it gives no "
            "numbers, is "
            "not claimed."
        )
    if regulated:
        guards = joined(sorted(map(given, set(regulated))))
        found.append(
            "With η_min near 0 the regulation is chaotic: starts that differ by rounding end apart, some runs do "
            "not end, "
            f"and u₂ is unbounded. No number is given for that case. All regulation here that divides by η₁ is with "
            f"η_min = {guards} m/s; "
            "near rest, the yaw acceleration and the final heading depend on that choice."
        )
    free = joined([f"“{law.name}”" for law in study.laws if law.kind not in AIMS_AT_HEADING])
    if all(law.kind not in AIMS_AT_HEADING for law in study.laws):
        found.append("The heading is left uncontrolled: the two chains are the position alone.")
    elif any(law.kind not in AIMS_AT_HEADING for law in study.laws):
        found.append(f"Under {free} the heading is left uncontrolled: the two chains are the position alone.")
    if all(law.kind in ("linear", "saturation", "sign") for law in study.laws):
        found.append(
            "Only the switching term is compared. Another choice of poles is another question; so is tuning each "
            "law to "
            "its best, unless a protocol below does so."
        )
    found.append(
        f"{_apart(comparison)}othing is said of motions between and beyond the {len(study.scenarios)} scenarios; one "
        "run of a scenario has no spread, and a difference between two runs is no statistic."
    )
    unsure = [name for name in comparison.runs[0].metrics.as_dict() if any(_unsure(comparison, name))]
    if unsure:
        found.append(
            f"Numbers that change by more than {100.0 * CONVERGED:g} % at half the step rank no law; in at least "
            "one run "
            f"these are {joined(unsure)}."
        )
    if any(law.kind == "sign" for law in study.laws):
        found.append(
            "Where a run starts on S = 0 exactly, rounding picks the branch of the sign function, so that two correct "
            "programs differ there by micrometres. What the sign function leaves shrinks with the step."
        )
    open_claims = [claim.quote for claim in claims if claim.verdict == "not examined"]
    if len(open_claims) == len(claims):
        found.append("None of the paper’s claims is examined.")
    elif open_claims:
        found.append(f"{len(open_claims)} of the paper’s claims cannot be examined with these runs, as the table says.")
    return found


def _apart(comparison: Comparison) -> str:
    """Beginning of a sentence: which protocols say something of motions other than the scenarios'."""
    kinds = {one.kind for one in comparison.study.protocols}
    there = [text for kind, text in _BEYOND.items() if kind in kinds]
    return f"Apart from the points of the {joined(there)} below, n" if there else "N"


def _lacking(comparison: Comparison) -> str:
    has = features(comparison.study)
    lacking = [text for name, text in _LACKING.items() if name not in has]
    text = "The state is known exactly" if "noise" not in has else "Apart from noise, the state is known"
    if "sampling" not in has:
        text += f", and the law {working_text(comparison)}"
    return f"{text}. No run has {' or '.join(filter(None, [', '.join(lacking), 'wheel slip']))}."


def _unsure(comparison: Comparison, name: str) -> list[bool]:
    return [run.ok and run.metrics.as_dict()[name] is not None and not converged(run, name) for run in comparison.runs]
