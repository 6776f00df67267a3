"""Maps of metrics over one or two keys: grids, failures, convergence with the step, sentences."""

import math

import numpy as np
import pytest
from matplotlib.path import Path

from brunovsky.comparison import drawing
from brunovsky.comparison.protocol_runs import ProtocolRun
from brunovsky.comparison.protocol_sections import _section
from brunovsky.comparison.protocols import Axis, Failure, map_figure, mapped
from brunovsky.errors import ParameterError

X, Y = Axis("theta_start_rad", (-1.0, 0.0, 1.0)), Axis("eta_start_1_m_per_s", (0.5, 2.0))
LAWS = {"a": {}, "b": {"gain": 2.0}}


def evaluate(law, parameters, case, wrong=0.0):
    x, y = parameters[X.key], parameters.get(Y.key, 1.0)
    if x == 0.0 and y == 2.0 and law == "b":
        return Failure("it fell")
    peak = (1.0 + x * x) * y * parameters.get("gain", 1.0)
    return {"iae": peak * (1.0 + (wrong if x == 1.0 else 0.0)), "settling_time": None if x == 1.0 else 3.0}


def test_a_grid_has_its_rows_along_up():
    found = mapped(evaluate, LAWS, X, Y, metrics=["iae"])
    assert np.array_equal(found.grid("a", "iae"), np.outer([0.5, 2.0], [2.0, 1.0, 2.0]))
    assert found.failed("b").tolist() == [[False] * 3, [False, True, False]]
    assert math.isnan(found.grid("b", "iae")[1, 1])


def test_sentences_tell_extremes_their_places_and_what_one_key_does():
    found = mapped(evaluate, LAWS, X, Y, metrics=["iae", "settling_time"])
    told = "\n".join(found.findings())
    assert "Under “b” 1 of 6 runs failed; the first: it fell." in told
    assert "0.500\u00a0m s at least (θ(0) = 0\u00a0rad, η₁(0) = 0.5\u00a0m/s)" in told
    assert "θ(0) alone changes it by a factor of 2.0 to 2.0, row by row" in told
    assert "in 2 of 6 runs it is undefined, as it is beyond the end of the run" in told
    assert "By the IAE “b” is lower than “a” in 0 and higher in 5 of 5 points" in told
    assert (
        "the IAE by a factor of 2.0 with θ(0) alone (median of the rows), by a factor of 8.0 over the map"
        in found.headline()
    )
    assert "0 (“a”), 1 (“b”)" in found.headline()


def test_what_the_step_decides_is_in_no_sentence():
    def finer(law, parameters, case):
        return evaluate(law, parameters, case, wrong=0.02)

    found = mapped(evaluate, LAWS, X, Y, metrics=["iae"], finer=finer, step_sensitive=["iae"])
    assert found.converged("a", "iae").tolist() == [[True, True, False]] * 2
    assert "in 2 it changes by more than 1.0\u00a0% at half the step: left out" in "".join(found.findings())
    rows = found.summary_rows()
    assert (rows[0]["largest"], rows[0]["there"], rows[0]["not converged"]) == (
        4.0,
        "θ(0) = −1\u00a0rad, η₁(0) = 2\u00a0m/s",
        2,
    )


def test_a_run_is_converged_only_if_all_its_mapped_metrics_are():
    def finer(law, parameters, case):
        found = evaluate(law, parameters, case)
        return found | {"settling_time": 3.1} if parameters[X.key] == -1.0 else found

    found = mapped(evaluate, {"a": {}}, X, Y, metrics=["iae", "settling_time"], finer=finer)
    assert found.converged("a", "iae").tolist() == [[False, True, True]] * 2  # undefined at both steps is no change
    assert found.converged("a", "settling_time").tolist() == [[False, True, False]] * 2
    assert found.summary_rows()[0]["not converged"] == 2


def test_failures_of_the_step_are_told_from_those_of_the_law():
    def coarse(law, parameters, case):
        return Failure("it blew up") if parameters[X.key] >= 0.0 else {"iae": 1.0}

    def finer(law, parameters, case):
        return Failure("it blew up") if parameters[X.key] == 1.0 and parameters[Y.key] == 2.0 else {"iae": 1.0}

    found = mapped(coarse, {"a": {}}, X, Y, metrics=["iae"], finer=finer)
    assert "4 (“a”; 1 of these also at half the step)" in found.headline()
    assert "At half the step 1 of the 4 that failed under “a” fails: what failed in the others is the integration." in (
        found.findings()
    )
    assert (found.summary_rows()[0]["failed"], found.summary_rows()[0]["failed at half the step"]) == (4, 1)
    drawn = {line.get_marker(): len(line.get_xdata()) for line in map_figure(found).axes[0].get_lines()}
    assert (drawn["x"], drawn["^"]) == (1, 3)


def test_contours_have_the_same_levels_for_all_laws_and_labels_that_differ():
    def steep(law, parameters, case):
        return {"iae": 1.0 + 0.08 * parameters["a"] / 9.0 + 0.02 * (law == "b")}

    def finer(law, parameters, case):
        return {"iae": 5.0} if parameters["a"] == 9.0 else steep(law, parameters, case)

    axis = Axis("a", tuple(map(float, range(10))))
    found = mapped(steep, LAWS, axis, Axis("b", (0.0, 1.0, 2.0)), metrics=["iae"], finer=finer)
    figure = map_figure(found)
    told = [[text.get_text() for text in axes.texts] for axes in figure.axes[:2]]
    assert told == [["1.02", "1.04", "1.06"], ["1.04", "1.06", "1.08"]]
    assert figure.axes[2].get_ylim()[1] == pytest.approx(1.02 + 0.08 * 8.0 / 9.0)  # the last column is not converged


def test_a_step_sensitive_metric_without_runs_at_half_the_step_ranks_nothing():
    told = mapped(evaluate, LAWS, X, Y, metrics=["iae"], step_sensitive=["iae"]).findings()
    assert any("ranks no law" in one for one in told)
    assert not any(one.startswith("By the") for one in told)


def test_points_at_zero_are_in_no_factor_and_are_told():
    def zero(law, parameters, case):
        x, y = parameters[X.key], parameters[Y.key]
        return {"iae": 0.0 if x == 0.0 else y + x, "rms_tail_error": 0.0}

    found = mapped(zero, {"a": {}}, X, Axis(Y.key, (2.0, 3.0)), metrics=["iae", "rms_tail_error"])
    told = found.findings()
    assert "; it is 0 in 2 of 6 points; elsewhere θ(0) alone changes it by a factor of 2.0 to 3.0" in told[0]
    assert told[1].endswith("it is 0 in 6 of 6 points.")
    assert "by a factor of 4.0 over the map (0 in 2 of 6 points, left out here)" in found.headline()
    assert "the RMS position error (last quarter) not at all (it is 0 in all 6 points)" in found.headline()


@pytest.mark.parametrize(("slope", "hardly"), [(0.02, True), (0.03, False)])
def test_what_hardly_depends_on_a_key_is_told_so(slope, hardly):
    found = mapped(lambda law, p, _: {"iae": 1.0 + slope * p[X.key]}, {"a": {}}, X, Y, metrics=["iae"])
    assert ("alone hardly changes it, by 3.9\u00a0% of the largest in a row" in found.findings()[0]) == hardly
    assert ("the IAE by 3.9\u00a0% of its largest value" in found.headline()) == hardly
    assert ("by a factor of" in found.headline()) != hardly


def test_two_maps_of_a_scenario_are_told_apart_by_their_titles():
    def titles(up):
        result = mapped(evaluate, {"a": {}}, X, up, metrics=["iae"])
        section = _section(ProtocolRun(None, result, (), (), {}), 1, "Circle", {}, False)
        return section.title, section.caption, section.table.caption

    assert titles(Y)[0] == "Map over θ(0) and η₁(0): Circle (starts swept)"
    assert not set(titles(Y)) & set(titles(Axis("x_start_m", (0.5, 1.0)))) | set(titles(Y)) & set(titles(None))


def test_cells_of_a_colour_are_one_path():
    across, up = Axis("a", tuple(range(40))), Axis("b", tuple(range(30)))

    def diagonal(law, parameters, case):
        a, b = parameters["a"], parameters["b"]
        return {"iae": None if a == b else 100.0 + a + b}

    found = mapped(diagonal, {"a": {}}, across, up, metrics=["iae"])
    patches = map_figure(found).axes[0].patches
    assert len(patches) == 32 and len({one.get_facecolor() for one in patches}) == 32
    corners = np.concatenate([one.get_path().vertices[one.get_path().codes != Path.CLOSEPOLY] for one in patches])
    width, height = np.ptp(corners.reshape(-1, 4, 2), axis=1).T
    assert np.sum(width * height) == pytest.approx(40 * 30 - 30)  # all but the 30 that are undefined


@pytest.mark.parametrize("up", [Y, None])
def test_the_figure_crosses_failures(up):
    with drawing.settings():
        figure = map_figure(mapped(evaluate, LAWS, X, up, metrics=["iae", "settling_time"]), {"a": "the first"})
        assert "svg" in drawing.svg(figure, "map")
    crosses = [line for axes in figure.axes for line in axes.get_lines() if line.get_marker() == "x"]
    assert sum(len(line.get_xdata()) for line in crosses) == (2 if up else 0)


def test_metrics_that_are_defined_nowhere_are_drawn_and_told_so():
    found = mapped(lambda *_: {"iae": None}, LAWS, X, Y, metrics=["iae"])
    assert "nowhere on the map" in found.findings()[0]
    assert "no metric of “a”" in found.headline()
    map_figure(found)


@pytest.mark.parametrize(
    ("across", "up"),
    [(Axis("a", (1.0,)), None), (Axis("a", (1.0, 1.0)), None), (X, X), (X, Axis("b", (2.0, math.nan)))],
)
def test_axes_that_are_none_are_refused(across, up):
    with pytest.raises(ParameterError, match="mapped"):
        mapped(evaluate, LAWS, across, up, metrics=["iae"])
