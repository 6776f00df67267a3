"""The verdict and the box of limits follow the numbers: with altered numbers they say something else."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from altered_runs import altered, failed, of, scaled, sentences

from brunovsky._resources import resource
from brunovsky.comparison import Run, load_study
from brunovsky.comparison.claims import claims
from brunovsky.comparison.features import features
from brunovsky.comparison.protocol_sections import protocol_sections
from brunovsky.comparison.protocols import swept
from brunovsky.comparison.report.limits import limits
from brunovsky.comparison.report.relatives import relatives
from brunovsky.comparison.report.verdict import verdict
from brunovsky.comparison.sensitivity import step_note
from brunovsky.comparison.study.loops import Loop


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
    assert "natively at half the step and nothing else changed" in step_note("native")
    assert not any("nothing else changed" in step_note(engine) for engine in ("fmpy", "ssp"))
    assert "by the native simulation, which the provenance compares with the FMU" in step_note("fmpy")
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
