"""Verdict and claims follow the numbers: with altered numbers they say something else, and never more than these."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import SimpleNamespace

import pytest

from brunovsky._frozen import FrozenMapping
from brunovsky._resources import resource
from brunovsky.comparison import Comparison, Run, Status, load_study
from brunovsky.comparison.claims import claims
from brunovsky.comparison.facts import number
from brunovsky.comparison.features import features
from brunovsky.comparison.findings import scenario_findings
from brunovsky.comparison.measured_margins import MeasuredMargin
from brunovsky.comparison.metrics import Metrics
from brunovsky.comparison.protocol_sections import protocol_sections
from brunovsky.comparison.protocols import Axis, MeasuredLoopMargins, mapped, monte_carlo, swept
from brunovsky.comparison.protocols.margin_rows import QUANTITIES, MarginRow
from brunovsky.comparison.report.limits import limits
from brunovsky.comparison.report.relatives import relatives
from brunovsky.comparison.report.verdict import verdict
from brunovsky.comparison.sensitivity import step_note
from brunovsky.comparison.study.loops import Hardware, Loop


def altered(
    comparison: Comparison, change: Callable[[Run], Mapping[str, float | None]], factor: float = 1.0
) -> Comparison:
    """Runs with other metrics or facts, and these times a factor at half the step."""
    return replace(comparison, runs=tuple(_altered(run, change(run), factor) for run in comparison.runs))


def _altered(run: Run, values: Mapping[str, float | None], factor: float) -> Run:
    half = {name: None if value is None else factor * value for name, value in values.items()}
    parts = [(run, values), (run.half_step, half)]
    new = [
        {
            "metrics": replace(one.metrics, **{name: v for name, v in some.items() if hasattr(one.metrics, name)}),
            "facts": replace(one.facts, **{name: v for name, v in some.items() if not hasattr(one.metrics, name)}),
        }
        for one, some in parts
    ]
    return replace(run, **new[0], half_step=replace(run.half_step, **new[1]))


def failed(comparison: Comparison, name: str) -> Comparison:
    runs = tuple(
        replace(run, status=Status("singular", 1.0, "why"), metrics=Metrics(), facts=None, half_step=None)
        if run.planned.name == name
        else run
        for run in comparison.runs
    )
    return replace(comparison, runs=runs)


def scaled(name: str, factor: float, base: float = 1.0) -> Callable[[Run], Mapping[str, float]]:
    """A metric or fact that is `base` under pole placement, and `factor` times as much under the other laws."""
    return lambda run: {name: base if run.planned.law == "linear" else factor * base}


def of(comparison: Comparison, part: str):
    return next(one for one in claims(comparison) if part in one.quote)


def sentences(comparison: Comparison) -> str:
    return "\n".join(verdict(comparison, claims(comparison)))


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


def test_a_failed_run_is_told_first_and_confirms_nothing_without_conditions(paper_runs):
    made = failed(paper_runs, "fig6-inside/sign")
    found = verdict(made, claims(made))
    assert found[0].startswith("1 of 28 runs of the scenarios failed: fig6-inside/sign (singular)")
    assert "confirmed" not in {one.verdict for one in claims(made)}
    assert "fig6-inside/sign" in of(made, "steady state errors").shown
    assert verdict(paper_runs, claims(paper_runs))[-1] == "All 28 runs of the scenarios reached their end."


@pytest.mark.parametrize(
    ("factor", "word"), [(0.5, "lowers"), (0.999, "hardly changes"), (2.0, "raises"), (0.93, "lowers")]
)
def test_the_verdict_on_convergence(paper_runs, factor, word):
    text = sentences(altered(paper_runs, scaled("settling_time", factor)))
    assert f"same linear part {word} the settling time to 1 cm" in text


def test_the_verdict_counts_both_directions_and_what_is_not_converged(paper_runs):
    def change(run):
        other = 0.5 if "inside" in run.planned.name else 2.0
        return {"settling_time": 1.0 if run.planned.law == "linear" else other}

    assert "in some runs lowers and in others raises the settling time" in sentences(altered(paper_runs, change))
    text = sentences(altered(paper_runs, scaled("rms_tail_error", 0.5, 1e-3), factor=2.0))
    assert "cannot be ranked by the RMS error of the last quarter" in text and "lowers the RMS" not in text


@pytest.mark.parametrize("count", [4, 6])
def test_many_relatives_are_told_by_the_best_and_the_worst(paper_runs, monkeypatch, count):
    made = altered(paper_runs, scaled("settling_time", 0.5)).of(paper_runs.study.scenario("fig6-inside"))
    base, sign = made["linear"], made["sign"]
    factors = (0.5, 0.9, 1.2, 3.0, 1.1, 1.3)[:count]
    groups = []
    for index, factor in enumerate(factors):
        one = altered(replace(paper_runs, runs=(sign,)), lambda run, f=factor: {"settling_time": f}).runs[0]
        groups.append((f"the law “law{index}”", [(base, one)]))
    module = "brunovsky.comparison.report.verdict._against_pole_placement"
    monkeypatch.setattr(module, lambda comparison: groups)
    text = sentences(paper_runs)
    if count == 4:
        assert "settling time to 1 cm changes by −50\u00a0% under “law0”, −10\u00a0% under “law1”, 20" in text
    else:
        best, worst = "−50\u00a0% at best, under “law0”,", "200\u00a0% at worst, under “law3”; the tables have each"
        assert f"changes under 6 laws (6 of 6 pairs of runs) by {best} and {worst}" in text
        assert "law1" not in next(one for one in text.splitlines() if "settling time to 1 cm" in one)


@pytest.mark.parametrize(("base", "factor"), [(1e-7, 1e3), (1e-3, 1.5)])
def test_no_share_is_told_of_an_error_below_a_micrometre(paper_runs, base, factor):
    text = sentences(altered(paper_runs, scaled("rms_tail_error", factor, base)))
    assert ("at 1.00×10⁻⁴\u00a0m instead of 1.00×10⁻⁷\u00a0m" in text.replace("1.0×", "1.00×")) == (base < 1e-6)
    assert ("raises the RMS error of the last quarter (50\u00a0%" in text) == (base > 1e-6)


def test_laws_whose_error_never_settles_are_named(paper_runs):
    assert "never settles" not in sentences(paper_runs)
    lost = {"fig6-inside/sign": {"settling_time": None, "rms_tail_error": 0.0103}}
    made = altered(paper_runs, lambda run: lost.get(run.planned.name, {}))
    title = paper_runs.study.scenario("fig6-inside").title
    text = sentences(made)
    assert (
        f"In 1 run the error never settles to 1 cm (RMS error of the last quarter in brackets): “{title}” under" in text
    )
    assert "under “sign” (0.0103\u00a0m)." in text

    def growing(run):
        data = run.trajectory.copy()
        time = data["time"].values
        return replace(run, trajectory=data.assign({"e1[1]": (data["e1[1]"].dims, 1e-3 * time**2)}))

    grown = tuple(growing(run) if run.planned.name in lost else run for run in made.runs)
    assert "(0.0103\u00a0m, and grows to the end)." in sentences(replace(made, runs=grown))


def test_what_the_step_decides_of_many_relatives_is_said_so(paper_runs):
    pairs = paper_runs.of(paper_runs.study.scenario("fig6-inside"))
    base, sign = pairs["linear"], pairs["sign"]

    def told(factor: float) -> str:
        rough = altered(replace(paper_runs, runs=(sign,)), lambda run: {"total_variation_u2": 1e6}, factor).runs[0]
        return relatives([("the law “sampled”", [(base, rough)]), ("the law “relay”", [(base, base)])])[-1]

    assert "“sampled”, in 1 of 1 (1 by the step); by the step: the step decides on the number" in told(2.0)
    assert told(1.0).endswith("“sampled”, in 1 of 1.")


def test_one_pair_of_runs_is_told_as_one(paper_runs):
    runs = tuple(run for run in paper_runs.runs if run.planned.name in ("fig6-inside/linear", "fig6-inside/sign"))
    study = paper_runs.study.model_copy(update={"laws": tuple(paper_runs.study.law(n) for n in ("linear", "sign"))})
    study = study.model_copy(update={"scenarios": (paper_runs.study.scenario("fig6-inside"),)})
    made = replace(paper_runs, study=study, runs=runs)
    assert "Its price: in the one pair of runs u₂ varies more" in sentences(made)
    calm = altered(made, lambda run: {"total_variation_u2": 1.0})
    assert "than pole placement in the one pair of runs." in sentences(calm)


def test_the_mark_is_explained_for_the_engine_that_ran():
    assert "nothing else changed" in step_note("native") and step_note("fmpy") == step_note("native")
    assert "nothing else changed" not in step_note("ssp")
    assert "the same file at half the communication step" in step_note("ssp", own=True)
    assert "by the error of the coupling, the step or both" in step_note("ssp")


@pytest.mark.parametrize(
    ("apart", "words"), [(0.0, "are bit for bit the same."), (2.5e-13, "at most 2.5×10⁻¹³ m apart.")]
)
def test_trials_that_agree_exactly_are_said_to_be_the_same(paper_runs, apart, words):
    trials = swept(lambda *_: {"iae": 1.0}, {"linear": {}}, "P_m_per_s3", (0.0, 1.0), metrics=["iae"])
    agreed = SimpleNamespace(run="a", position=apart, agrees=True)
    table = SimpleNamespace(scenario="fig6-inside")
    protocol = SimpleNamespace(table=table, result=trials, agreement=(agreed,), worst=())
    (section,) = protocol_sections(replace(paper_runs, protocols=(protocol,)), drawn=False)
    assert section.findings[-1].endswith(words)
    assert section.title.startswith("Same linear part, P swept")


def test_what_stays_is_said_of_the_gains_that_were_run(paper_runs):
    shown = of(paper_runs, "robustness").shown
    assert "remains at every P that was run (0\u00a0m/s³ and 2.5\u00a0m/s³)" in shown


def test_relatives_are_nil_and_tiny_where_their_runs_are(paper_runs, monkeypatch):
    base = paper_runs.of(paper_runs.study.scenario("fig6-inside"))["linear"]

    def pair(first: float, second: float) -> tuple[Run, Run]:
        values = iter((first, second))
        both = altered(replace(paper_runs, runs=(base, base)), lambda run: {"rms_tail_error": next(values)}).runs
        return both[0], both[1]

    groups = [
        ("the law “same”", [pair(1e-15, 1e-12)]),
        ("the law “noisy”", [pair(1e-15, 2e-5), pair(1e-15, 1e-15)]),
        ("the law “worse”", [pair(1e-3, 3e-3)]),
        ("the law “better”", [pair(1e-3, 0.5e-3)]),
    ]
    monkeypatch.setattr("brunovsky.comparison.report.verdict._against_pole_placement", lambda comparison: groups)
    text = next(one for one in sentences(paper_runs).splitlines() if "RMS error" in one)
    assert "changes by 200\u00a0% under “worse” and −50\u00a0% under “better”" in text
    assert "is 2.0×10⁻⁵\u00a0m instead of 1.0×10⁻¹⁵\u00a0m under “noisy”, too little" in text
    assert "is nil, as under pole placement (below 1 nm), under “same”" in text


def test_a_law_as_it_ships_is_said_to_be_untuned(paper_runs):
    plain = paper_runs.study.law("linear").model_copy(update={"name": "other", "kind": "observer"})
    study = paper_runs.study.model_copy(update={"laws": (paper_runs.study.law("linear"), plain)})
    loop = Loop("disturbance_observer")

    def text(given: frozenset[str]) -> str:
        runs = [run for run in paper_runs.runs if run.planned.law == "linear"]
        other = [replace(run.planned, law="other", loop=loop, given=given) for run in runs]
        runs += [replace(run, planned=planned) for run, planned in zip(runs, other, strict=True)]
        return sentences(replace(paper_runs, study=study, runs=tuple(runs)))

    assert "the law “other” (untuned defaults)" in text(frozenset({"x_start", "eta_min"}))
    assert "untuned" not in text(frozenset({"bandwidth"}))


def test_a_gentle_robot_is_not_said_to_be_violent(paper_runs):
    assert "laboratory robot" in sentences(paper_runs)
    calm = altered(paper_runs, lambda run: {"peak_speed": 1.0, "peak_yaw_acceleration": 1.0})
    assert "laboratory robot" not in sentences(calm)


def test_the_box_says_what_is_missing_and_only_that(paper_runs):
    text = "\n".join(limits(paper_runs, claims(paper_runs)))
    assert "No run has measurement noise, actuator lags, delays, limits of u₁ and u₂ or wheel slip" in text
    assert features(paper_runs.study) == {"disturbance", "uncertainty"}
    calm = paper_runs.study.model_copy(update={"scenarios": paper_runs.study.scenarios[2:3]})
    runs = tuple(run for run in paper_runs.runs if run.planned.scenario == "fig6-inside")
    text = "\n".join(limits(replace(paper_runs, study=calm, runs=runs), []))
    assert "disturbances, errors of mass and inertia or wheel slip" in text and "chaotic" not in text


def test_the_box_does_not_deny_what_the_protocols_show(paper_runs):
    mapped = load_study(resource("comparisons", "initial_heading.toml")).protocols
    study = paper_runs.study.model_copy(update={"protocols": mapped})
    text = "\n".join(limits(replace(paper_runs, study=study), []))
    assert "Apart from the points of the maps below, nothing is said of motions between" in text
    assert "\nNothing is said of motions between" in "\n".join(limits(paper_runs, []))


def test_what_a_study_has_is_not_said_to_be_missing(paper_runs, monkeypatch):
    has = frozenset({"noise", "lag", "sampling", "disturbance", "uncertainty"})
    monkeypatch.setattr("brunovsky.comparison.report.limits.features", lambda study: has)
    text = limits(paper_runs, [])[0]
    assert text == "Apart from noise, the state is known. No run has delays, limits of u₁ and u₂ or wheel slip."
