"""Sweeps and tuning on toy laws whose curves are known."""

import json
import math

import pytest

from brunovsky.comparison import drawing
from brunovsky.comparison.protocols import Failure, Knob, equal_effort, equal_effort_figure, swept, swept_figure
from brunovsky.comparison.protocols.equal_effort_findings import _slack
from brunovsky.errors import ParameterError, SimulationError


def toy(slopes, iae=lambda law, P: 1.0 / (1.0 + P), effort=lambda law, P: 2.0 * P):
    """Evaluation with an effort rms_u2 = slope * effort(P), and an IAE."""

    def evaluate(law, parameters, case):
        P = parameters["P"]
        return {"iae": iae(law, P), "rms_u2": slopes[law] * effort(law, P), "settling_time": None}

    return evaluate


LAWS = {"layer": {}, "relay": {}}
KNOBS = {law: Knob("P", 0.01, 100.0) for law in LAWS}
SLOPES = {"layer": 1.0, "relay": 3.0}


def told(result) -> str:
    return " ".join(result.findings())


def drawn(figure) -> str:
    with drawing.settings():
        return drawing.svg(figure, "test")


def test_a_sweep_runs_every_law_at_every_value_in_order():
    result = swept(toy(SLOPES), LAWS, "P", [3.0, 0.0, 1.0], metrics=["iae", "settling_time"])
    assert result.laws == ("layer", "relay") and result.values == (0.0, 1.0, 3.0)
    assert result.curve("relay", "iae") == ([0.0, 1.0, 3.0], [1.0, 0.5, 0.25])
    assert result.curve("relay", "settling_time") == ([], [])
    assert len(result.rows()) == 6 and result.rows()[0]["iae [m s]"] == 1.0
    assert drawn(swept_figure(result)).startswith("<svg")


@pytest.mark.parametrize(
    ("curve", "words"),
    [
        (lambda P: 1.0 / (1.0 + P), "falls from 1.00 to 0.250"),
        (lambda P: 1.0 + P, "rises from 1.00 to 4.00"),
        (lambda P: 1.0 + 1e-6 * P, "hardly depends on P from 0 to 3: it varies by less than 0.01\u00a0%"),
        (lambda P: 0.952 + 0.016 * P, "hardly depends on P from 0 to 3: it varies by 4.8\u00a0% of its largest value"),
        (lambda P: 1.0 - 0.016 * P, "hardly depends on P from 0 to 3: it varies by 4.8\u00a0% of its largest value"),
        (lambda P: 0.946 + 0.018 * P, "rises from 0.946 to 1.00"),
        (lambda P: 1.0 - 0.018 * P, "falls from 1.00 to 0.946"),
        (lambda P: 0.0, "hardly depends on P"),
        (lambda P: (P - 1.0) ** 2 + 1.0, "least at 1 (1.00) and largest at 3 (5.00)"),
        (lambda P: None, "defined for fewer than two values"),
    ],
)
def test_the_words_on_a_sweep_follow_its_numbers(curve, words):
    result = swept(toy(SLOPES, iae=lambda _, P: curve(P)), {"layer": {}}, "P", [0.0, 1.0, 3.0], metrics=["iae"])
    assert words in told(result)


def test_no_trend_is_told_of_what_depends_on_the_step():
    result = swept(toy(SLOPES), LAWS, "P", [0.0, 1.0], metrics=["iae"], step_sensitive=["iae"])
    assert "falls" not in told(result) and "no trend is told" in told(result)


@pytest.mark.parametrize("values", [[1.0], [1.0, 1.0], [0.0, math.nan]])
def test_sweeps_over_nothing_are_refused(values):
    with pytest.raises(ParameterError, match="at least two finite values"):
        swept(toy(SLOPES), LAWS, "P", values, metrics=["iae"])
    with pytest.raises(ParameterError, match="at least 1"):
        swept(toy(SLOPES), {}, "P", [0.0, 1.0], metrics=["iae"])


def test_where_runs_failed_is_told_by_the_values_of_the_knob():
    def evaluate(law, parameters, case):
        return (
            Failure("a step: eta[2] is not finite", words="diverged") if parameters["lag_s"] > 0.007 else {"iae": 1.0}
        )

    words = told(swept(evaluate, {"relay": {}}, "lag_s", [0.001, 0.008, 0.01, 0.012], metrics=["iae"]))
    assert "3 of 4 runs failed; at lag = 0.008, 0.01 and 0.012\u00a0s: diverged." in words and "finite" not in words


def test_failed_runs_are_told_and_never_a_nan():
    def evaluate(law, parameters, case):
        if parameters["P"] == 1.0:
            raise SimulationError("diverged at t = 1 s; shorten the step")
        return None if parameters["P"] > 1.0 else {"iae": math.nan}

    result = swept(evaluate, {"relay": {}}, "P", [0.0, 1.0, 3.0], metrics=["iae"])
    assert [one.failure.reason if one.failure else "" for one in result.trials] == [
        "",
        "diverged at t = 1 s; shorten the step",
        "the run failed without giving a reason",
    ]
    assert "2 of 3 runs failed; at P = 1: diverged at t = 1 s; shorten the step; at P = 3: the run failed" in told(
        result
    )
    assert result.rows()[0]["iae [m s]"] is None
    json.dumps(result.as_dict(), allow_nan=False)
    assert drawn(swept_figure(result)).startswith("<svg")


@pytest.mark.parametrize("target", [0.5, 7.0, 123.0])
@pytest.mark.parametrize(
    "effort", [lambda _, P: 2.0 * P, lambda _, P: P**3, lambda _, P: 5.0 / P], ids=["line", "cube", "falling"]
)
def test_tuning_hits_the_effort_within_one_per_cent(target, effort):
    result = equal_effort(toy(SLOPES, effort=effort), LAWS, KNOBS, "rms_u2", target, metrics=["iae"])
    for one in result.tunings:
        assert one.status == "tuned" and one.monotone
        assert one.trial.value("rms_u2") == pytest.approx(target, rel=0.01)
        exact = SLOPES[one.law] * effort(one.law, one.value)
        assert exact == pytest.approx(target, rel=0.01)
        assert one.runs <= result.budget
    json.dumps(result.as_dict(), allow_nan=False)


def test_equal_effort_tells_the_order_of_the_numbers_and_flips_with_them():
    def found(better):
        iae = {"layer": 1.0, "relay": 1.0} | {better: 0.5}
        return equal_effort(toy(SLOPES, iae=lambda law, _: iae[law]), LAWS, KNOBS, "rms_u2", 6.0, metrics=["iae"])

    assert "lowest under “relay”; under “layer” it is higher by 100" in told(found("relay"))
    assert "lowest under “layer”; under “relay” it is higher by 100" in told(found("layer"))
    assert [row["status"] for row in found("layer").rows()] == ["tuned", "tuned"]
    assert drawn(equal_effort_figure(found("layer"))).startswith("<svg")


def test_the_headline_of_many_laws_tells_the_best_and_the_worst():
    many = [f"law{k}" for k in range(6)]
    iae = dict(zip(many, (3.0, 1.0, 1.001, 2.0, 5.0, 4.0), strict=True))
    found = equal_effort(
        toy(dict.fromkeys(many, 1.0) | {"law0": 2.0}, iae=lambda law, _: iae[law]),
        {law: {} for law in many},
        {law: Knob("P", 0.01, 100.0) for law in many},
        "rms_u2",
        6.0,
        metrics=["iae"],
    )
    text = found.headline()
    assert "of 6 laws, lowest under “law1” (1.00\u00a0m s), from which “law2” is not told apart" in text
    assert "highest under “law4” (5.00\u00a0m s); the table has each." in text
    assert "law3" not in text and "law3" in told(found)
    assert found.tunings[0].value != found.tunings[1].value and told(found) != text


def test_what_the_tolerance_of_the_tuning_explains_is_not_told():
    near = equal_effort(
        toy(SLOPES, iae=lambda law, P: 1.0 + 0.005 * (law == "relay")), LAWS, KNOBS, "rms_u2", 6.0, metrics=["iae"]
    )
    assert "lowest under" not in told(near) and "(within 1.0\u00a0%, the tolerance of numbers" in told(near)


def test_the_slack_is_that_of_the_offsets_achieved():
    """An IAE that goes with the tenth power of the effort, five per cent apart."""

    def found(effort):
        iae = {"layer": 1.0, "relay": 1.05}
        evaluate = toy(SLOPES, iae=lambda law, P: iae[law] * (SLOPES[law] * effort(law, P)) ** 10, effort=effort)
        return equal_effort(evaluate, LAWS, KNOBS, "rms_u2", 6.0, metrics=["iae"])

    exact = found(lambda _, P: 2.0 * P)
    offsets = [one.trial.value("rms_u2") / 6.0 - 1.0 for one in exact.tunings]
    assert _slack(exact, "layer", "relay", "iae") == pytest.approx(10.0 * sum(map(abs, offsets)), rel=0.05)
    assert "under “relay” it is higher by" in told(exact) and "which counts as equal" in told(exact)

    def steps(law, P):  # of 0.8 per cent, with the target in the middle of one
        return 6.024 / SLOPES[law] * 1.008 ** round(math.log(P * SLOPES[law] / 6.0) / math.log(1.008))

    coarse = found(steps)
    assert "lowest under" not in told(coarse) and "which the offsets from the target explain" in told(coarse)


def test_the_step_is_judged_at_the_tuned_designs():
    iae = {"a": 1.0, "b": 2.0, "c": 3.0, "d": 4.0}

    def evaluate(law, parameters, case, wrong=()):
        P = parameters["P"]
        effort = P * (1.05 if "effort" in wrong and law == "d" else 1.0)
        return {
            "rms_u2": effort,
            "iae": iae[law] * (1.5 if law in wrong else 1.0),
            "settling_time": 1.0 + (law in wrong),
        }

    def found(*wrong):
        return equal_effort(
            evaluate,
            {law: {} for law in iae},
            {law: Knob("P", 0.01, 100.0) for law in iae},
            "rms_u2",
            6.0,
            metrics=["iae"],
            step_sensitive=["iae"],  # of the untuned runs, which decide no more
            finer=lambda law, parameters, case: evaluate(law, parameters, case, wrong),
        )

    assert not found().step_sensitive and "lowest under “a”" in told(found())
    some = found("a", "effort")
    assert "lowest under “b”" in told(some) and "(a)" not in told(some)
    assert "Not ranked are “a” and “d”: their values change by more than 1.0\u00a0% at half the step." in told(some)
    none = found("a", "b", "c")
    assert none.step_sensitive == {"iae"}
    assert "The IAE depends on the step of the simulation under “a”, “b” and “c”: it ranks no law." in told(none)
    json.dumps(none.as_dict(), allow_nan=False)


@pytest.mark.parametrize("sensitive", ["iae", "rms_u2"])
def test_no_law_is_ranked_by_what_depends_on_the_step(sensitive):
    result = equal_effort(
        toy(SLOPES), LAWS, KNOBS, "rms_u2", 6.0, metrics=["iae", "settling_time"], step_sensitive=[sensitive]
    )
    assert "lowest under" not in told(result) and "depends on the step" in told(result)


@pytest.mark.parametrize(
    ("effort", "status", "words"),
    [
        (lambda _, P: 0.01 * P, "out of range", "and 1.00 over P from 0.01 to 100, and the target is 4.00"),
        (lambda _, P: 3.0 + 2.5 * math.sin(2.0 * math.log(P)), "ambiguous", "not monotone"),
        (lambda _, P: 1.0 if P < 0.5 else 9.0, "jumps", "jumps past its target"),
        (lambda _, P: None, "failed", "no run over"),
    ],
)
def test_a_law_that_can_not_be_tuned_says_why(effort, status, words):
    def evaluate(law, parameters, case):
        found = effort(law, parameters["P"])
        return Failure("singular at t = 2 s", singular=True) if found is None else {"rms_u2": found, "iae": 1.0}

    result = equal_effort(evaluate, LAWS, KNOBS, "rms_u2", 4.0, metrics=["iae"])
    assert [one.status for one in result.tunings] == [status, status]
    assert words in told(result) and "nothing to compare" in told(result)
    assert all(one.trial is None and one.runs <= 40 for one in result.tunings)
    assert all(row["failure"] and row["rms_u2 [rad/s²]"] is None for row in result.rows())
    json.dumps(result.as_dict(), allow_nan=False)
    assert drawn(equal_effort_figure(result)).startswith("<svg")


def test_a_failure_where_the_target_is_looked_for_is_told():
    def evaluate(law, parameters, case):
        return Failure("diverged") if 1.0 < parameters["P"] < 3.0 else {"rms_u2": parameters["P"]}

    one = equal_effort(evaluate, {"relay": {}}, KNOBS, "rms_u2", 2.0, metrics=[]).tunings[0]
    assert one.status == "failed" and "the run at P = " in one.reason and one.reason.endswith("failed: diverged")


def test_the_budget_is_kept():
    one = equal_effort(
        toy(SLOPES, effort=lambda _, P: math.exp(P)), {"relay": {}}, KNOBS, "rms_u2", 9.0, metrics=[], scan=9, budget=10
    ).tunings[0]
    assert one.status == "budget" and one.runs == 10


@pytest.mark.parametrize(
    "wrong", [{"target": 0.0}, {"target": math.nan}, {"rtol": 0.0}, {"scan": 2}, {"budget": 5}, {"knobs": {}}]
)
def test_unusable_requests_are_refused(wrong):
    given = {"knobs": KNOBS, "effort": "rms_u2", "target": 1.0, "metrics": []} | wrong
    with pytest.raises(ParameterError, match="equal_effort"):
        equal_effort(toy(SLOPES), LAWS, **given)


@pytest.mark.parametrize("ends", [(0.0, 1.0), (2.0, 1.0), (1.0, math.inf)])
def test_a_knob_without_a_logarithmic_range_is_refused(ends):
    with pytest.raises(ParameterError, match="range of P"):
        Knob("P", *ends)


def test_the_figure_has_a_row_for_each_law_and_the_markers_of_the_legend():
    laws = {f"law{k}": {} for k in range(8)}  # more than there are styles
    result = equal_effort(
        toy(dict.fromkeys(laws, 1.0), iae=lambda law, _: 1.0),
        laws,
        {law: Knob("P", 0.01, 100.0) for law in laws},
        "rms_u2",
        6.0,
        metrics=["iae", "settling_time"],
    )
    figure = equal_effort_figure(result)
    curve, iae, undefined = figure.axes
    assert [one.get_text() for one in iae.get_yticklabels()] == list(laws) and not undefined.get_lines()
    assert [float(one.get_ydata()[0]) for one in iae.get_lines()] == list(range(8))

    def looks(lines):
        return [(one.get_marker(), one.get_markerfacecolor(), one.get_markersize()) for one in lines]

    legend = looks(figure.legends[0].get_lines())
    tuned = [one for one in curve.get_lines() if one.get_linestyle() == "None"]
    assert looks(iae.get_lines()) == looks(tuned) == legend
    assert len(set(legend)) == 8


def test_all_panels_of_a_sweep_have_numbers():
    result = swept(toy(SLOPES), LAWS, "P", [0.0, 1.0, 2.0], metrics=["iae", "rms_u2", "settling_time"])
    figure = swept_figure(result)
    figure.canvas.draw()
    assert all(any(one.get_visible() for one in axes.get_xticklabels()) for axes in figure.axes[:3])
