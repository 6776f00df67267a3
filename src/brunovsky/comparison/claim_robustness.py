"""The claim of the paper about robustness: disturbances, parameter errors and unmodelled dynamics, each by itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from brunovsky.comparison.claim import Case, Finding, Verdict, is_nominal
from brunovsky.comparison.facts import change, given, joined, number, percent
from brunovsky.comparison.features import run_features
from brunovsky.comparison.findings_steady import HARDLY, ROUNDING
from brunovsky.comparison.metrics import TAIL
from brunovsky.comparison.protocols import MeasuredLoopMargins
from brunovsky.comparison.protocols.margin_rows import CUTS, MarginRow, value_told
from brunovsky.comparison.residuals import disturbed, tail_peaks, within_bounds
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.sensitivity import both, converged, largest, least, settled, told
from brunovsky.comparison.study import Scenario

REJECTED = 10.0  # times less error than under pole placement, from which a disturbance counts as rejected
SPARED = 2.0  # times less delay than under pole placement, from which a parameter error counts as rejected
HARDWARE = {"lag", "delay", "limits", "sampling"}  # what the laws do not know of
_TOLD = ("delay", "lag", "sampling")  # margins of the protocol that are about unmodelled dynamics


@dataclass(frozen=True)
class _Part:
    """What is said of one kind of imperfection."""

    name: str
    verdict: Verdict
    shown: str

    @property
    def sentence(self) -> str:
        return f"{self.name}: {self.verdict}.{f' {self.shown}.' if self.shown else ''}"


def robustness(comparison: Comparison, cases: list[Case]) -> Finding | None:
    """What disturbances, parameter errors and unmodelled dynamics do under the sign function and pole placement."""
    kinds = {law.name: law.kind for law in comparison.study.laws}
    found = []
    for scenario, runs in cases:
        by_kind = {kinds[name]: run for name, run in runs.items()}
        if "linear" in by_kind and "sign" in by_kind and not by_kind["linear"].planned.noise:
            found.append((scenario, by_kind["linear"], by_kind["sign"]))
    parts = (_disturbances(found), _parameters(found, cases), _dynamics(comparison))
    examined = [one for one in parts if one.verdict != "not examined"]
    if not examined:
        return None
    words = {one.verdict for one in examined}
    complete = words == {"confirmed"} and "not examined" not in (parts[1].verdict, parts[2].verdict)
    verdict: Verdict = "confirmed under conditions"
    verdict = "confirmed" if complete else "contradicted" if words == {"contradicted"} else verdict
    return Finding(verdict, " ".join(one.sentence for one in parts))


def _word(rejected: list[bool]) -> Verdict:
    return "confirmed" if all(rejected) else "confirmed under conditions" if any(rejected) else "contradicted"


def _disturbances(found: list[tuple[Scenario, Run, Run]]) -> _Part:
    """What is left of disturbances that still act in the last quarter."""
    rejected: list[bool] = []
    parts: list[str] = []
    remaining: set[float] = set()
    for scenario, linear, relay in found:
        peaks = tail_peaks(linear.planned)
        if not disturbed(linear.planned) or not any(peaks.values()):
            continue
        rejected.append(largest(relay, "rms_tail_error") < max(least(linear, "rms_tail_error") / REJECTED, ROUNDING))
        parts.append(f"{scenario.title}: {_residuals(linear, relay)}")
        if peaks["d[1]"] > 0.0 and not rejected[-1]:
            remaining.update(run.planned.parameters["P"] for run in (linear, relay))
    if not parts:
        return _Part("Disturbances", "not examined", "")
    text = "As rejected counts what leaves less than a tenth of the error under pole placement, or below 1 nm, at the "
    text += f"step of the study and at half of it: {sum(rejected)} of {len(rejected)}. {'; '.join(parts)}"
    if remaining:
        gains = [f"{given(gain)}\u00a0m/s³" for gain in sorted(remaining)]
        text += f". What enters the chains below v (unmatched) remains at every P that was run ({joined(gains)}), z″"
        text += " being computed from the model"
    return _Part("Disturbances", _word(rejected), text)


def _parameters(found: list[tuple[Scenario, Run, Run]], cases: list[Case]) -> _Part:
    """By how much parameter errors delay settling."""
    rejected: list[bool] = []
    parts: list[str] = []
    idle: list[str] = []
    unknown: list[str] = []
    for scenario, linear, relay in found:
        if run_features(linear.planned) != {"uncertainty"}:
            continue
        slower = _slower(cases, scenario, {"linear": linear, "sign": relay})
        if not slower:
            unknown.append(scenario.title)
        elif max(map(abs, slower.values())) <= HARDLY:
            idle.append(scenario.title)
        else:
            rejected.append(slower["sign"] < slower["linear"] / SPARED)
            parts.append(f"{scenario.title}: {_slowed(linear, relay, slower, rejected[-1])}")
    text = ""
    if parts:
        text = f"As rejected counts a delay of less than half of that under pole placement: {sum(rejected)} of "
        text += f"{len(rejected)}. {'; '.join(parts)}"
    if idle:
        text += f"{'. ' if text else ''}Not counted, as it tests neither law (nil error, and hardly any delay, under "
        text += f"both): {joined(idle)}"
    if unknown:
        text += f"{'. ' if text else ''}Not counted, as the delay against a nominal run cannot be told (there is none, "
        text += "it starts within 1 cm, had not settled for good, or the time is not converged with the step): "
        text += joined(unknown)
    return _Part("Parameters", _word(rejected) if parts else "not examined", text)


def _dynamics(comparison: Comparison) -> _Part:
    """Whether runs with hardware settle under the sign function, and how much of it is stood, if that was measured."""
    kinds = {law.name: law.kind for law in comparison.study.laws}
    held: list[bool] = []
    plain = 0
    parts: list[str] = []
    for scenario in comparison.study.scenarios:
        runs = {kinds[law]: run for law, run in comparison.of(scenario).items() if run.planned.in_family}
        linear, relay = runs.get("linear"), runs.get("sign")
        if linear is None or relay is None:
            continue
        has = run_features(relay.planned)
        if not has & HARDWARE or has & {"noise", "disturbance"}:
            continue
        held.append(_settles(relay))
        plain += _settles(linear)
        parts.append(
            f"{scenario.title}: {_settling(linear)} under pole placement, {_settling(relay)} under the sign function"
        )
    stood = _stood(comparison)
    if not parts and not stood:
        return _Part("Unmodelled dynamics", "not examined", "")
    text = ""
    if parts:
        text = "As stood counts what settles to 1 mm for good, at the step of the study and at half of it: under the "
        text += f"sign function {sum(held)} of {len(held)}, under pole placement {plain}. {'; '.join(parts)}"
    if stood:
        text += f"{'. ' if text else ''}Measured by bisection, the loop stands up to: {'; '.join(stood)}"
    word = _word(held) if held else "confirmed under conditions"
    if stood and word == "confirmed":
        word = "confirmed under conditions"
    return _Part("Unmodelled dynamics", word, text)


def _settles(run: Run) -> bool:
    return run.ok and largest(run, "settling_1mm") <= TAIL * run.planned.duration


def _settling(run: Run) -> str:
    if not run.ok:
        return f"the run failed ({run.status.state})"
    word = "settles" if _settles(run) else "does not settle"
    return f"{word} (RMS error of the last quarter {told(run, 'rms_tail_error')} m)"


def _stood(comparison: Comparison) -> list[str]:
    """What the protocol of margins found that the paper's laws stand, where the sign function has a limit."""
    kinds = {law.name: law.kind for law in comparison.study.laws if law.in_family}
    found = []
    for one in comparison.protocols:
        if not isinstance(one.result, MeasuredLoopMargins):
            continue
        rows = [row for row in one.result.found if row.law in kinds and row.quantity.name in _TOLD]
        cuts = dict.fromkeys(row.cut for row in rows)
        title = comparison.study.scenario(one.table.scenario).title
        for cut in ["both"] if "both" in cuts else cuts:
            for name in _TOLD:
                some = {row.law: row for row in rows if (row.cut, row.quantity.name) == (cut, name)}
                if any(kinds[law] == "sign" and row.measured.value is not None for law, row in some.items()):
                    found.append(f"“{title}”: {_margin(some)}")
    return found


def _margin(rows: Mapping[str, MarginRow]) -> str:
    some = list(rows.values())
    what = f"{some[0].quantity.title} {CUTS[some[0].cut]}"
    by_value: dict[str, list[str]] = {}
    for law, row in rows.items():
        size = row.measured.reason if row.measured.value is None else value_told(row.measured.value, row.quantity)
        by_value.setdefault(f"{row.bound} {size}".strip(), []).append(f"“{law}”")
    return f"{what} {joined([f'{size} under {joined(laws)}' for size, laws in by_value.items()])}"


def _residuals(linear: Run, relay: Run) -> str:
    name = "rms_tail_error"
    text = f"RMS error over the last quarter {told(linear, name)} m under pole placement, {told(relay, name)} m under "
    text += "the sign function"
    half = both(relay, name)[1]
    if not converged(relay, name) and half is not None:
        text += f" ({number(half, 2)} m at half the step)"
    return text if within_bounds(relay) else f"{text}, the disturbance being beyond the bound that P rejects"


def _slower(cases: list[Case], scenario: Scenario, runs: dict[str, Run]) -> dict[str, float]:
    """Relative change of the settling time of runs with uncertainty against the nominal scenario, by kind of law."""
    found: dict[str, float] = {}
    for other, others in cases:
        for kind, run in runs.items():
            twin = others.get(run.planned.law)
            if other is scenario or twin is None or not is_nominal(twin) or not _differ_in_rho(run, twin):
                continue
            one = change(run.metrics.settling_time, twin.metrics.settling_time)
            if one is not None and all(settled(each) and converged(each, "settling_time") for each in (run, twin)):
                found[kind] = one
    return found if set(found) == set(runs) else {}


def _differ_in_rho(run: Run, twin: Run) -> bool:
    a, b = ({name: value for name, value in one.planned.parameters.items() if "rho" not in name} for one in (run, twin))
    return a == b and run.planned.duration == twin.planned.duration


def _slowed(linear: Run, relay: Run, slower: dict[str, float], rejected: bool) -> str:
    text = (
        f"settling to 1 cm takes {linear.metrics.settling_time:.3f} s under pole placement "
        f"({percent(slower['linear'])} longer than nominal), {relay.metrics.settling_time:.3f} s under the "
        f"sign function ({percent(slower['sign'])} longer)"
    )
    p = linear.planned.parameters
    if rejected or p["rho[2]"] == 1.0:
        return text
    what = "an error of the yaw gain" if p["rho[1]"] == 1.0 else "errors of both gains, matched and unmatched together"
    help_ = "P makes it worse" if slower["sign"] > slower["linear"] + HARDLY else "P does not help against it"
    return f"{text}: {what}, whose jerk exceeds P while u₂ is large, so that {help_}"
