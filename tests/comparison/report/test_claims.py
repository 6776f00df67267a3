"""Claims follow the numbers: with altered numbers each says something else, and never more than these."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import SimpleNamespace

import pytest
from altered_runs import altered, failed, of, scaled, sentences

from brunovsky._frozen import FrozenMapping
from brunovsky.comparison import Comparison, Run
from brunovsky.comparison.claims import claims
from brunovsky.comparison.facts import number
from brunovsky.comparison.findings import scenario_findings
from brunovsky.comparison.measured_margins import MeasuredMargin
from brunovsky.comparison.protocols import Axis, MeasuredLoopMargins, mapped, monte_carlo
from brunovsky.comparison.protocols.margin_rows import QUANTITIES, MarginRow
from brunovsky.comparison.report.verdict import verdict
from brunovsky.comparison.study.loops import Hardware, Loop

TIMES = ("settling_time", "settling_1mm", "settling_100um")


@pytest.mark.parametrize(
    ("factors", "expected"),
    [
        ((0.5, 0.5, 0.5), "confirmed"),
        ((1.0, 0.9, 0.8), "confirmed under conditions"),
        ((0.99, 1.0, 1.01), "contradicted"),
        ((1.3, 1.3, 1.3), "contradicted"),
    ],
)
def test_convergence(paper_runs, factors, expected):
    made = altered(
        paper_runs,
        lambda run: {n: 1.0 if run.planned.law == "linear" else f for n, f in zip(TIMES, factors, strict=True)},
    )
    assert of(made, "its rate").verdict == expected


def test_what_the_step_decides_examines_nothing(paper_runs):
    made = altered(
        paper_runs, lambda run: dict.fromkeys(TIMES, 1.0 if run.planned.law == "linear" else 0.5), factor=1.5
    )
    assert of(made, "its rate").verdict == "not examined"
    assert "cannot be ranked by the settling time" in sentences(made)


@pytest.mark.parametrize(
    ("values", "part", "expected"),
    [
        ({"rms_tail_error": 1e-12}, "steady state errors", "confirmed"),
        ({"rms_tail_error": 1e-3}, "steady state errors", "confirmed under conditions"),
        ({"rms_tail_error": 0.5}, "steady state errors", "contradicted"),
        ({"settling_time": None}, "control smoothness", "contradicted"),
        ({"settling_time": 1.0, "peak_speed": 1.0, "peak_yaw_acceleration": 5.0}, "control smoothness", "confirmed"),
        ({"settling_time": None}, "to any point", "contradicted"),
        ({"settling_time": None}, "strength of convergence", "contradicted"),
        ({"settling_time": 1.0}, "strength of convergence", "confirmed"),
        ({"peak_yaw_acceleration": 5.0}, "greatly influences", "confirmed under conditions"),
        ({"heading_start": 1.0, "heading_end": 1.0}, "not the orientation", "contradicted"),
        ({"heading_start": 1.0, "heading_end": 2.0}, "not the orientation", "confirmed"),
    ],
)
def test_claims_flip_with_their_numbers(paper_runs, values, part, expected):
    assert of(altered(paper_runs, lambda run: values), part).verdict == expected


@pytest.mark.parametrize(
    ("share", "expected"),
    [
        (0.0, ("not examined", "confirmed", "confirmed under conditions", "not examined")),
        (0.74, ("contradicted", "confirmed", "confirmed under conditions", "confirmed")),
        (0.76, ("not examined", "confirmed under conditions", "confirmed under conditions", "not examined")),
        (None, ("not examined", "contradicted", "contradicted", "contradicted")),
    ],
)
def test_what_crosses_the_threshold_in_the_last_quarter_has_not_settled(paper_runs, share, expected):
    def change(run):
        found = dict.fromkeys(TIMES, None if share is None else share * run.planned.duration)
        return found | {"peak_speed": 1.0, "peak_yaw_acceleration": 1.0}

    made = altered(paper_runs, change)
    parts = ("its rate", "control smoothness", "to any point", "strength of convergence")
    every = claims(made)
    found = [next(one for one in every if part in one.quote) for part in parts]
    assert tuple(one.verdict for one in found) == expected
    assert ("had not settled for good" in found[1].shown) == (share == 0.76)
    assert ("neither had settled for good" in "\n".join(verdict(made, every))) == (share in (0.76, None))
    told = scenario_findings(made, made.study.scenarios[0])[0]
    assert ("had not settled for good" in told) == (share == 0.76)


def test_one_run_that_swings_about_the_threshold_takes_away_what_is_said_of_all(paper_runs):
    one = "fig6-inside/sign"
    late = {name: 0.9 * run.planned.duration for run in paper_runs.runs if run.planned.name == one for name in TIMES}
    made = altered(paper_runs, lambda run: late if run.planned.name == one else dict.fromkeys(TIMES, 1.0))
    starts = of(made, "strength of convergence")
    assert starts.verdict == "confirmed under conditions"
    assert "1 of the others had not settled for good" in starts.shown
    assert "pole placement settles for good, and it had not" in sentences(made)
    assert "(fig6-inside/sign had not settled for good)" in of(made, "control smoothness").shown


@pytest.mark.parametrize(("duration", "expected"), [(20.0, "confirmed"), (0.5, "not examined")])
def test_starts_are_not_judged_in_runs_that_are_too_short_to_settle(paper_runs, duration, expected):
    made = altered(paper_runs, lambda run: {"settling_time": 0.1})
    runs = tuple(replace(run, planned=replace(run.planned, duration=duration)) for run in made.runs)
    assert of(replace(made, runs=runs), "strength of convergence").verdict == expected


TURNED = ("peak_yaw_acceleration", "min_speed_moving", "settling_time", "iae")


def turned(comparison: Comparison, *factors: float, half: float = 1.0) -> Comparison:
    """Runs whose metrics with another heading at the start are those of the others times these factors."""

    def change(run):
        other = run.planned.parameters["theta_start"] != 0.0
        return {name: one if other else 1.0 for name, one in zip(TURNED, factors, strict=True)}

    return altered(comparison, change, half)


@pytest.mark.parametrize(
    ("factors", "expected", "words"),
    [
        ((3.0, 0.3, 2.5, 4.0), "confirmed", "great (a factor of 2.0 or more) on the largest |u₂|, the smallest"),
        ((3.0, 0.3, 1.1, 1.2), "confirmed under conditions", "moving, not on the settling time to 1 cm and the IAE."),
        ((1.5, 0.9, 1.1, 1.2), "contradicted", "on nothing"),
    ],
)
def test_the_claim_on_the_initial_heading_names_what_it_changes(paper_runs, factors, expected, words):
    found = of(turned(paper_runs, *factors), "greatly influences")
    assert found.verdict == expected and words in found.shown


def test_a_number_that_the_step_decides_confirms_no_influence_of_the_heading(paper_runs):
    found = of(turned(paper_runs, 60.0, 0.1, 3.0, 3.0, half=1.5), "greatly influences")
    assert found.verdict == "not examined" and "the step decides on it" in found.shown and "≈" in found.shown


@pytest.mark.parametrize(
    ("peak", "settling", "expected"),
    [(9.0, 1.0, "confirmed under conditions"), (9.0, 3.0, "confirmed"), (1.5, 1.0, "contradicted")],
)
def test_maps_over_the_heading_speak_to_its_influence(paper_runs, peak, settling, expected):
    def evaluate(law, parameters, case):
        turned = abs(parameters["theta_start_rad"])
        return {"peak_yaw_acceleration": 1.0 + (peak - 1.0) * turned, "settling_time": 1.0 + (settling - 1.0) * turned}

    result = mapped(
        evaluate,
        {"linear": {}},
        Axis("theta_start_rad", (-1.0, 0.0, 1.0)),
        Axis("x_start_m", (1.0, 2.0)),
        metrics=("peak_yaw_acceleration", "settling_time"),
    )
    alone = tuple(run for run in paper_runs.runs if run.planned.scenario == "fig6-inside")
    protocol = SimpleNamespace(table=SimpleNamespace(scenario="fig6-inside"), result=result)
    found = of(replace(paper_runs, runs=alone, protocols=(protocol,)), "greatly influences")
    assert found.verdict == expected
    assert f"the largest |u₂| by a factor of {number(peak, 2)}" in found.shown


def test_small_steady_state_errors_are_those_of_the_laws_that_are_named(paper_runs):
    made = altered(paper_runs, lambda run: {"rms_tail_error": 1e-12})
    shown = of(made, "steady state errors").shown
    assert "under each of the paper’s laws (“linear”, “saturation” and “sign”)" in shown
    assert "Laws of other kinds" not in shown
    other = paper_runs.study.law("linear").model_copy(update={"name": "other", "kind": "disturbance_observer"})
    study = paper_runs.study.model_copy(update={"laws": (*paper_runs.study.laws, other)})
    assert "Laws of other kinds are not meant" in of(replace(made, study=study), "steady state errors").shown


def rough(sign: tuple[float, float], layer: tuple[float, float]) -> Callable[[Run], Mapping[str, float]]:
    """Variation of both inputs in the last quarter, under the sign function and with the boundary layer."""
    of_law = {"sign": sign, "saturation": layer}
    return lambda run: dict(zip(("roughness_u1", "roughness_u2"), of_law.get(run.planned.law, (0.0, 0.0)), strict=True))


@pytest.mark.parametrize(
    ("sign", "layer", "expected"),
    [
        ((2.7, 5000.0), (1e-9, 1e-9), "confirmed under conditions"),
        ((2.7, 5000.0), (0.1, 600.0), "confirmed under conditions"),
        ((2.7, 5000.0), (2.7, 5000.0), "contradicted"),
        ((1e-6, 5000.0), (1e-9, 1.0), "confirmed"),
        ((1e-6, 1e-6), (1e-9, 1e-9), "not examined"),
    ],
)
def test_chattering(paper_runs, sign, layer, expected):
    assert of(altered(paper_runs, rough(sign, layer)), "chattering").verdict == expected


def test_chatter_is_told_in_its_own_units_and_whatever_the_transient_was(paper_runs):
    made = altered(paper_runs, rough((2.7, 5000.0), (1e-9, 600.0)))
    shown = of(made, "chattering").shown
    assert "u₁ by 2.70\u00a0m/s² under the sign function and less than 0.001\u00a0m/s² with the boundary" in shown
    assert "u₂ by 5000\u00a0rad/s² under the sign function and 600\u00a0rad/s² with" in shown
    assert "in 4 of 4 for u₁ and 0 of 4 for u₂" in shown and "keeps within" in shown
    beyond = altered(paper_runs, rough((30.0, 5000.0), (0.0, 0.0)))
    assert "keeps within" not in of(beyond, "chattering").shown
    transient = altered(made, lambda run: {"total_variation_u1": 1e-3, "total_variation_u2": 1e-3})
    assert of(transient, "chattering").shown == shown


@pytest.mark.parametrize(("factor", "expected"), [(0.01, "confirmed under conditions"), (1.0, "contradicted")])
def test_robustness_is_never_confirmed_without_conditions_where_dynamics_are_missing(paper_runs, factor, expected):
    made = altered(paper_runs, scaled("rms_tail_error", factor, 1e-3))
    made = altered(made, scaled("settling_time", 1.0))
    assert of(made, "robustness").verdict == expected


def behind_lags(comparison: Comparison, scenarios: tuple[str, ...]) -> Comparison:
    """Runs of some scenarios as if their actuators lagged."""
    lagging = replace(paper_loop(comparison), hardware=Hardware(lags=(0.005, 0.005)))
    runs = tuple(
        replace(run, planned=replace(run.planned, loop=lagging)) if run.planned.scenario in scenarios else run
        for run in comparison.runs
    )
    return replace(comparison, runs=runs)


def paper_loop(comparison: Comparison) -> Loop:
    return comparison.runs[0].planned.loop


@pytest.mark.parametrize(
    ("times", "word", "count"),
    [
        ((1.0, 1.0), "confirmed.", "2 of 2"),
        ((1.0, None), "confirmed under conditions.", "1 of 2"),
        ((1.0, 19.0), "confirmed under conditions.", "1 of 2"),
        ((None, None), "contradicted.", "0 of 2"),
    ],
)
def test_unmodelled_dynamics_are_judged_where_runs_have_them(paper_runs, times, word, count):
    scenarios = ("fig6-inside", "fig6-outside")
    by_run = {f"{scenario}/sign": one for scenario, one in zip(scenarios, times, strict=True)}
    made = altered(paper_runs, lambda run: {"settling_1mm": by_run.get(run.planned.name, 1.0)})
    shown = of(behind_lags(made, scenarios), "robustness").shown
    assert f"Unmodelled dynamics: {word} As stood counts what settles to 1 mm for good" in shown
    assert f"under the sign function {count}, under pole placement 2. " in shown
    assert "Unmodelled dynamics: not examined." in of(made, "robustness").shown


def test_a_run_that_fails_behind_a_lag_is_not_stood(paper_runs):
    made = behind_lags(altered(paper_runs, lambda run: {"settling_1mm": 1.0}), ("fig6-inside",))
    shown = of(failed(made, "fig6-inside/sign"), "robustness").shown
    assert "Unmodelled dynamics: contradicted." in shown and "the run failed (singular) under the sign" in shown


@pytest.mark.parametrize(
    ("relay", "words"), [(3.55e-3, "3.55 ms under “linear” and “sign”"), (9e-3, "3.55 ms under “linear” and 9.00 ms")]
)
def test_measured_margins_are_part_of_the_claim_on_robustness(paper_runs, relay, words):
    delay = next(one for one in QUANTITIES if one.name == "delay")
    rows = tuple(
        MarginRow(law, "both", delay, MeasuredMargin(value, 1.1 * value, 9), 0.018, None)
        for law, value in (("linear", 3.55e-3), ("sign", relay))
    )
    protocol = SimpleNamespace(
        table=SimpleNamespace(scenario="fig6-outside"), result=MeasuredLoopMargins(rows, 0.002, 0.01)
    )
    shown = of(replace(paper_runs, protocols=(protocol,)), "robustness").shown
    assert "Unmodelled dynamics: confirmed under conditions. Measured by bisection, the loop stands up to: " in shown
    title = paper_runs.study.scenario("fig6-outside").title
    assert f"“{title}”: delay at both {words}" in shown


@pytest.mark.parametrize(("factor", "word"), [(0.05, "confirmed"), (0.5, "contradicted")])
def test_disturbances_are_judged_by_a_threshold_that_is_printed(paper_runs, factor, word):
    shown = of(altered(paper_runs, scaled("rms_tail_error", factor, 1e-3)), "robustness").shown
    assert f"Disturbances: {word}. As rejected counts what leaves less than a tenth of the error under" in shown
    assert ("2 of 2. " in shown) == (factor == 0.05)


@pytest.mark.parametrize(("relay", "word"), [(1.05, "confirmed"), (1.5, "contradicted")])
def test_parameters_are_judged_by_the_delay_they_cause(paper_runs, relay, word):
    def change(run):
        slow = 1.0 if not run.planned.is_uncertain else relay if run.planned.law == "sign" else 1.4
        return {"settling_time": slow}

    shown = of(altered(paper_runs, change), "robustness").shown
    assert f"Parameters: {word}. As rejected counts a delay of less than half of that under pole placement" in shown


NOISE = FrozenMapping({"n[1]": 1e-3})


def noisy(comparison: Comparison, scenarios: tuple[str, ...], factors: Mapping[str, float]) -> Comparison:
    """Noise in some scenarios, where the last error is that of pole placement times a factor of each run."""
    made = altered(comparison, lambda run: {"rms_tail_error": 1e-3 * factors.get(run.planned.name, 1.0)})
    return replace(
        made,
        runs=tuple(
            replace(run, planned=replace(run.planned, noise=NOISE)) if run.planned.scenario in scenarios else run
            for run in made.runs
        ),
    )


@pytest.mark.parametrize(
    ("inside", "outside", "expected"),
    [
        (1.0, 1.04, "confirmed"),
        (0.5, 1.0, "confirmed"),
        (0.5, 1.5, "confirmed under conditions"),
        (1.2, 1.5, "contradicted"),
    ],
)
def test_the_claim_on_noise_tells_each_scenario(paper_runs, inside, outside, expected):
    scenarios = ("fig6-inside", "fig6-outside")
    factors = {"fig6-inside/sign": inside, "fig6-outside/sign": outside}
    factors |= {name.replace("sign", "saturation"): one for name, one in factors.items()}
    found = of(noisy(paper_runs, scenarios, factors), "as to noise")
    assert found.verdict == expected
    word = {0.5: "better", 1.0: "level", 1.04: "level", 1.2: "worse", 1.5: "worse"}
    for scenario, one in zip(scenarios, (inside, outside), strict=True):
        title = paper_runs.study.scenario(scenario).title
        assert f"{title}: {word[one]} under “saturation”" in found.shown
    assert f"{number(1e-3 * inside)} instead of 0.00100 m" in found.shown


def test_less_error_where_more_than_noise_acts_confirms_no_robustness_against_noise(paper_runs):
    disturbed = next(run.planned.scenario for run in paper_runs.runs if any(run.planned.inputs.values()))
    better = {f"{disturbed}/sign": 0.5, f"{disturbed}/saturation": 0.5}
    found = of(noisy(paper_runs, (disturbed,), better), "as to noise")
    assert found.verdict == "confirmed under conditions" and "not counted, as more than noise acts" in found.shown
    worse = {"fig6-inside/sign": 2.0, "fig6-inside/saturation": 2.0}
    assert of(noisy(paper_runs, (disturbed, "fig6-inside"), better | worse), "as to noise").verdict == "contradicted"


@pytest.mark.parametrize(
    ("inside", "outside", "words"),
    [
        (0.5, 1.5, "It holds for noise on the position, not for noise on the velocities."),
        (1.5, 0.5, "It holds for noise on the velocities, not for noise on the position."),
        (1.5, 1.5, "It holds for none of them."),
    ],
)
def test_the_claim_on_noise_names_what_is_noisy(paper_runs, inside, outside, words):
    factors = {f"fig6-{name}/{law}": factor for name, factor in (("inside", inside), ("outside", outside))
               for law in ("sign", "saturation")}  # fmt: skip
    made = noisy(paper_runs, ("fig6-inside", "fig6-outside"), factors)
    velocities = FrozenMapping({"n[4]": 1e-3})
    runs = tuple(
        replace(run, planned=replace(run.planned, noise=velocities)) if run.planned.scenario == "fig6-outside" else run
        for run in made.runs
    )
    assert of(replace(made, runs=runs), "as to noise").shown.endswith(words)


@pytest.mark.parametrize(
    ("factor", "expected", "words"),
    [
        (1.4, "confirmed under conditions", "the IAE is 29\u00a0% lower under “linear” than under “saturation”"),
        (0.5, "confirmed", "the IAE is 50\u00a0% lower under “saturation” than under “linear”"),
    ],
)
def test_a_paired_study_speaks_to_noise(paper_runs, factor, expected, words):
    made = noisy(paper_runs, ("fig6-inside",), {})

    def evaluate(law, parameters, case):
        return {"iae": (1.0 + 1e-3 * case) * (1.0 if law == "linear" else factor), "min_speed_moving": 1.0}

    result = monte_carlo(evaluate, {"linear": {}, "saturation": {}}, {}, metrics=["iae"], cases=40, seed=1)
    protocol = SimpleNamespace(table=SimpleNamespace(scenario="fig6-inside"), result=result)
    found = of(replace(made, protocols=(protocol,)), "as to noise")
    assert found.verdict == expected and words in found.shown and "Over 40 paired cases" in found.shown
    level = monte_carlo(
        lambda law, parameters, case: {"iae": 1.0, "min_speed_moving": 1.0},
        {"linear": {}, "saturation": {}}, {}, metrics=["iae"], cases=40, seed=1,
    )  # fmt: skip
    same = SimpleNamespace(table=SimpleNamespace(scenario="fig6-inside"), result=level)
    assert "paired cases" not in of(replace(made, protocols=(same,)), "as to noise").shown
