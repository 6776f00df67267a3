"""What the paper claims, held against the runs of a study; each verdict follows from a threshold."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from brunovsky.comparison.facts import change, facts_of, given, joined, number, percent, spread
from brunovsky.comparison.findings import HARDLY, ROUNDING
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.study import Law, Scenario

FAST = 5.0  # m/s; faster than any laboratory robot of this kind
VIOLENT = 1e3  # rad/s2; beyond any drive of such a robot

Case = tuple[Scenario, dict[str, Run]]


@dataclass(frozen=True)
class Claim:
    """One claim of the paper.

    Attributes
    ----------
    quote : str
        What the paper says.
    verdict : str
        ``contradicted``, ``not seen``, ``in part`` or ``confirmed``.
    shown : str
        What the runs show.
    """

    quote: str
    verdict: str
    shown: str


def claims(comparison: Comparison) -> list[Claim]:
    """Claims of the paper that the runs of this study can speak to."""
    study = comparison.study
    cases: list[Case] = []
    for scenario in study.scenarios:
        good = {name: run for name, run in comparison.of(scenario).items() if run.ok}
        if good:
            cases.append((scenario, good))
    tests: list[Callable[[Comparison, list[Case]], Claim | None]] = [
        _convergence, _errors, _chattering, _smoothness, _robustness, _orientation, _heading, _stabilization
    ]  # fmt: skip
    return [claim for claim in (test(comparison, cases) for test in tests) if claim is not None]


def _nominal(run: Run) -> bool:
    p = run.planned.parameters
    return not any(run.planned.inputs.values()) and p["rho[1]"] == 1.0 and p["rho[2]"] == 1.0


def _is_regulation(run: Run) -> bool:
    return run.planned.parameters["radius"] == 0.0


def _named(comparison: Comparison, kinds: Sequence[str]) -> list[Law]:
    return [law for law in comparison.study.laws if law.kind in kinds]


def _pairs(comparison: Comparison, cases: list[Case]) -> list[tuple[Scenario, Run, Run]]:
    """Linear run and sliding run of each scenario that has both."""
    linear, sliding = _named(comparison, ["linear"]), _named(comparison, ["saturation", "sign"])
    return [
        (scenario, runs[a.name], runs[b.name])
        for scenario, runs in cases
        for a in linear
        for b in sliding
        if a.name in runs and b.name in runs
    ]


def _convergence(comparison: Comparison, cases: list[Case]) -> Claim | None:
    pairs = [one for one in _pairs(comparison, cases) if _nominal(one[1])]
    settling = [change(b.metrics.settling_time, a.metrics.settling_time) for _, a, b in pairs]
    known = [one for one in settling if one is not None]
    if not known:
        return None
    largest = max(known, key=abs)
    verdict = "not seen" if abs(largest) <= HARDLY else "confirmed" if largest < 0.0 else "contradicted"
    pairs_told = f"{len(known)} pair{'s' if len(known) > 1 else ''} of runs"
    told = f"{percent(min(known))} to {percent(max(known))}" if len(known) > 1 else percent(known[0])
    return Claim(
        "“the improvement of the trajectory tracking and the stabilization process”, “the convergence itself, "
        "its rate”",
        verdict,
        f"With the same linear part the switching term changes the settling time by {told} "
        f"({pairs_told}). The rate of convergence is that of the linear part."
        if verdict == "not seen"
        else f"The switching term changes the settling time by {told} ({pairs_told}).",
    )


def _errors(comparison: Comparison, cases: list[Case]) -> Claim | None:
    pairs = [one for one in _pairs(comparison, cases) if _nominal(one[1]) and not _is_regulation(one[1])]
    linear = [a.metrics.rms_tail_error or 0.0 for _, a, _ in pairs]
    sliding = [b.metrics.rms_tail_error or 0.0 for _, _, b in pairs]
    if not pairs:
        return None
    nil = max(*linear, *sliding) < ROUNDING
    return Claim(
        "“good performances concerning […] the steady state errors”",
        "confirmed" if nil else "in part",
        f"On the circle and without disturbance the RMS error of the last quarter is at most "
        f"{number(max(linear), 1)} m under pole placement and {number(max(sliding), 1)} m under sliding mode"
        + (": nil for every purpose, and no merit of the switching term." if nil else "."),
    )


def _chattering(comparison: Comparison, cases: list[Case]) -> Claim | None:
    relay, others = _named(comparison, ["sign"]), _named(comparison, ["linear", "saturation"])
    tracking = [runs for _, runs in cases if all(_nominal(run) and not _is_regulation(run) for run in runs.values())]
    switched = [facts_of(runs[law.name]) for runs in tracking for law in relay if law.name in runs]
    smooth = [facts_of(runs[law.name]) for runs in tracking for law in others if law.name in runs]
    if not switched or not smooth:
        return None
    u1, u2 = max(one.roughness_u1 for one in switched), max(one.roughness_u2 for one in switched)
    return Claim(
        "chattering “is considerably reduced, particularly for the first control input u1”",
        "in part" if u2 > 10.0 * u1 else "confirmed",
        f"Under the sign function u₁, an integral of the switching input, varies by {number(u1)} m/s² a second on the "
        f"circle, but u₂, which is not integrated, by {number(u2)} rad/s² a second. With the boundary layer, and under "
        f"pole placement, u₂ varies by {number(max(one.roughness_u2 for one in smooth), 1)} rad/s² a second at most: "
        "the layer removes the chatter, the dynamic extension does so for u₁ alone. In u₂ the relay is amplified by "
        "1/|η₁|, most near rest.",
    )


def _smoothness(comparison: Comparison, cases: list[Case]) -> Claim | None:
    figures = [(s, run) for s, runs in cases if s.figure is not None for run in runs.values()]
    if not figures:
        return None
    fastest = max(figures, key=lambda one: one[1].metrics.peak_speed or 0.0)
    hardest = max(figures, key=lambda one: one[1].metrics.peak_yaw_acceleration or 0.0)
    speed, yaw = fastest[1].metrics.peak_speed or 0.0, hardest[1].metrics.peak_yaw_acceleration or 0.0
    contradicted = speed > FAST or yaw > VIOLENT
    linear = [run for _, run in figures if run.planned.law in {law.name for law in _named(comparison, ["linear"])}]
    linear_too = any(
        (run.metrics.peak_speed or 0.0) > FAST or (run.metrics.peak_yaw_acceleration or 0.0) > VIOLENT for run in linear
    )
    return Claim(
        "“satisfactory in terms of applicability of the method to both stabilization, and tracking convergence and "
        "control smoothness”",
        "contradicted" if contradicted else "confirmed",
        f"With the printed gains the robot reaches {number(speed)} m/s (figure {fastest[0].figure}), and "
        f"{number(yaw)} rad/s² of yaw acceleration (figure {hardest[0].figure}) where it moves at only "
        f"{number(facts_of(hardest[1]).peak_yaw_speed)} m/s"
        + (": far beyond a laboratory robot" if contradicted else "")
        + (", and under pole placement too." if contradicted and linear_too else "."),
    )


def _robustness(comparison: Comparison, cases: list[Case]) -> Claim | None:
    told: list[str] = []
    rejected: list[bool] = []
    for scenario, runs in cases:
        if all(_nominal(run) for run in runs.values()):
            continue
        errors = {law.kind: runs[law.name].metrics.rms_tail_error for law in comparison.study.laws if law.name in runs}
        linear, relay = errors.get("linear"), errors.get("sign")
        if linear is None or relay is None:
            continue
        rejected.append(relay < max(linear / 10.0, ROUNDING))
        told.append(
            f"{scenario.title}: {number(linear)} m under pole placement, {number(relay)} m under the sign function"
        )
    if not told:
        return None
    verdict = "confirmed" if all(rejected) else "in part" if any(rejected) else "contradicted"
    ending = "" if all(rejected) else " What enters the chains below v (unmatched) is not removed by any gain P."
    return Claim(
        "“The robustness is guaranteed in the presence of parameter uncertainty or unmodeled dynamics”",
        verdict,
        f"RMS error over the last quarter. {'; '.join(told)}.{ending} Unmodelled dynamics are not in this study.",
    )


def _orientation(comparison: Comparison, cases: list[Case]) -> Claim | None:
    def base(scenario: Scenario, run: Run) -> tuple[object, ...]:
        p = {name: value for name, value in run.planned.parameters.items() if name != "theta_start"}
        return (*sorted(p.items()), scenario.duration_s, *sorted(run.planned.inputs.items()))

    for number_, (scenario, runs) in enumerate(cases):
        for other, others in cases[number_ + 1 :]:
            for name, run in runs.items():
                twin = others.get(name)
                same = twin is not None and base(scenario, run) == base(other, twin)
                if twin is None or not same or scenario.parameters == other.parameters:
                    continue
                yaws = [one.metrics.peak_yaw_acceleration or 0.0 for one in (run, twin)]
                times = [one.metrics.settling_time for one in (run, twin)]
                ratio = max(yaws) / max(min(yaws), 1e-12)
                apart = change(times[1], times[0])
                return Claim(
                    "“the impact of the initial orientation on trajectory tracking, which greatly influences the "
                    "subsequent robot behavior”",
                    "confirmed" if ratio > 2.0 else "not seen",
                    f"From {number(twin.planned.parameters['theta_start'])} rad instead of "
                    f"{number(run.planned.parameters['theta_start'])} rad (law “{name}”) the peak of |u₂| is "
                    f"{number(yaws[1])} instead of {number(yaws[0])} rad/s², as the speed falls to "
                    f"{number(twin.metrics.min_speed)} m/s"
                    + (f"; the settling time changes by {percent(apart)}." if apart is not None else "."),
                )
    return None


def _heading(comparison: Comparison, cases: list[Case]) -> Claim | None:
    runs = [run for _, found in cases for run in found.values() if _is_regulation(run)]
    if not runs:
        return None
    turns = [abs(facts_of(run).heading_end - facts_of(run).heading_start) / (2.0 * math.pi) for run in runs]
    return Claim(
        "“only position is stabilized to the desired values and not the orientation”",
        "confirmed" if max(turns) > HARDLY else "not seen",
        f"In regulation the heading ends {spread(turns, 'turns', 2)} away from the initial one, which in the paper is "
        "the desired one too.",
    )


def _stabilization(comparison: Comparison, cases: list[Case]) -> Claim | None:
    runs = [run for _, found in cases for run in found.values() if _is_regulation(run)]
    shares = [facts_of(run).guarded_share for run in runs]
    if not runs or max(shares) == 0.0:
        return None
    limits = joined(sorted({f"{given(run.planned.parameters['eta_min'])} m/s" for run in runs}))
    return Claim(
        "“stabilization to any point in the phase plane”",
        "in part",
        f"The robot does come to rest at the target, but rest is the singularity of the law: for "
        f"{spread([100 * one for one in shares], '%', 2)} of the run a guard (|η₁| ≤ {limits}) stands in for the "
        "printed law, which can neither stop nor start.",
    )
