"""Fronts, hypervolumes and budgets on designs whose front is known."""

import json
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from brunovsky.comparison import drawing
from brunovsky.comparison.protocols import pareto, pareto_figure
from brunovsky.comparison.protocols.designs import designs
from brunovsky.comparison.protocols.front import coverage, dominates, hypervolume, nondominated, territories
from brunovsky.errors import ParameterError

POINTS = st.lists(st.tuples(st.integers(0, 9).map(float), st.integers(0, 9).map(float)), max_size=25)


@settings(max_examples=200, deadline=None)
@given(POINTS)
def test_the_front_is_what_no_other_point_dominates(points):
    kept = [points[k] for k in nondominated(points)]
    assert set(kept) == {one for one in points if not any(dominates(other, one) for other in points)}
    assert kept == sorted(set(kept))


@settings(max_examples=200, deadline=None)
@given(POINTS)
def test_the_hypervolume_is_the_number_of_unit_squares_that_are_dominated(points):
    squares = [(i, j) for i in range(10) for j in range(10)]
    covered = sum(any(x <= i and y <= j for x, y in points) for i, j in squares)
    assert hypervolume(points, (10.0, 10.0)) == covered


def test_a_known_hypervolume():
    assert hypervolume([(1.0, 2.0), (2.0, 1.0), (9.0, 9.0)], (3.0, 3.0)) == 3.0
    assert hypervolume([(3.0, 1.0)], (3.0, 3.0)) == 0.0
    assert hypervolume([], (3.0, 3.0)) == 0.0


def test_coverage_and_territories():
    a, b = [(1.0, 4.0), (2.0, 3.0), (5.0, 1.0)], [(2.0, 3.5), (3.0, 2.0), (6.0, 1.0)]
    assert coverage(a, b) == pytest.approx(2 / 3) and coverage(b, a) == 0.0 and coverage(a, []) is None
    found = territories({"a": a, "b": b})
    assert [(one.law, one.first[0], one.last[0], one.designs) for one in found] == [
        ("a", 1.0, 2.0, 2),
        ("b", 3.0, 3.0, 1),
        ("a", 5.0, 5.0, 1),
    ]


def test_designs_are_even_in_the_logarithm_and_do_not_depend_on_other_laws():
    found = designs({"k": (0.01, 100.0), "P": (1.0, 2.0)}, 64, 3, "relay")
    decades = np.floor(np.log10([one["k"] for one in found]) / 0.5)
    assert np.array_equal(np.unique(decades, return_counts=True)[1], np.full(8, 8))
    assert all(1.0 <= one["P"] <= 2.0 for one in found)
    assert found == designs({"k": (0.01, 100.0), "P": (1.0, 2.0)}, 64, 3, "relay")
    assert found != designs({"k": (0.01, 100.0), "P": (1.0, 2.0)}, 64, 4, "relay")
    assert designs({}, 64, 3, "relay") == [{}]


def hyperbola(offsets, noise=0.0):
    """IAE = offset/k and total variation = offset k (1 + waste): every design without waste is on the front."""

    def evaluate(law, parameters, case):
        k, waste = parameters["k"], parameters.get("waste", 0.0)
        return {"iae": offsets[law] / k, "total_variation_u2": offsets[law] * k * (1.0 + waste)}

    return evaluate


LAWS = {"layer": {}, "relay": {}}
SPACES = {law: {"k": (0.1, 10.0)} for law in LAWS}


def told(result) -> str:
    return " ".join(result.findings())


def test_a_known_front_is_found():
    result = pareto(hyperbola({"layer": 1.0, "relay": 2.0}), LAWS, SPACES, budget=32)
    assert len(result.trials) == 64 and len(result.front("layer")) == 32
    for (x, y), _ in result.front("relay"):
        assert x * y == pytest.approx(4.0)
    assert sum(row["on_front"] for row in result.rows()) == 64
    spaces = SPACES | {"relay": {"k": (0.1, 10.0), "waste": (0.01, 100.0)}}
    wasteful = pareto(hyperbola({"layer": 1.0, "relay": 1.0}), LAWS, spaces, budget=64)
    assert 2 < len(wasteful.front("relay")) < 40
    assert "“layer” dominates" in told(wasteful) or "is dominated by one of “layer”" in told(wasteful)


def test_the_hypervolume_comes_near_that_of_the_curve():
    result = pareto(hyperbola({"layer": 1.0}), {"layer": {}}, SPACES, budget=1024, reference=(10.0, 10.0))
    exact = 100.0 - 1.0 - math.log(100.0)  # of y = 1/x within [0.1, 10] squared
    assert result.hypervolumes["layer"] == pytest.approx(exact, rel=0.01)


def test_the_words_on_fronts_flip_with_the_numbers():
    better = pareto(hyperbola({"layer": 1.0, "relay": 2.0}), LAWS, SPACES, budget=64)
    assert "Every design on the front of “relay” is dominated by one of “layer”." in told(better)
    worse = pareto(hyperbola({"layer": 2.0, "relay": 1.0}), LAWS, SPACES, budget=64)
    assert "Every design on the front of “layer” is dominated by one of “relay”." in told(worse)
    crossing = {"layer": {"k": (0.1, 0.9)}, "relay": {"k": (1.1, 10.0)}}
    apart = pareto(hyperbola({"layer": 1.0, "relay": 1.0}), LAWS, crossing, budget=64)
    assert "No design on the front of “layer” or “relay” is dominated" in told(apart)
    assert "“relay” from 0.1" in told(apart) and "and “layer” from 1.1" in told(apart)


def test_no_law_is_ranked_by_an_objective_that_depends_on_the_step():
    result = pareto(
        hyperbola({"layer": 1.0, "relay": 2.0}), LAWS, SPACES, budget=16, step_sensitive=["total_variation_u2"]
    )
    assert "rank no law" in told(result) and "dominated" not in told(result) and "hypervolumes" not in told(result)


def test_the_reference_point_is_stated():
    result = pareto(hyperbola({"layer": 1.0, "relay": 2.0}), LAWS, SPACES, budget=16)
    worst = [max(point[k] for front in result.fronts.values() for point in front) for k in (0, 1)]
    assert result.reference == (1.1 * worst[0], 1.1 * worst[1])
    assert "With the reference point (" in told(result)
    given_point = pareto(hyperbola({"layer": 1.0}), {"layer": {}}, SPACES, budget=16, reference=(5.0, 5.0))
    assert given_point.reference == (5.0, 5.0)


def test_a_law_without_knobs_and_one_that_always_fails():
    def evaluate(law, parameters, case):
        return {"iae": 1.0, "total_variation_u2": 2.0} if law == "layer" else None

    result = pareto(evaluate, LAWS, {"layer": {}, "relay": {"k": (0.1, 1.0)}}, budget=8)
    assert len(result.trials) == 9 and result.hypervolumes["relay"] == 0.0
    assert "The one design of “layer” is its front" in told(result) and "has no front" in told(result)
    assert "all of 8 runs failed" in told(result)
    json.dumps(result.as_dict(), allow_nan=False)
    nothing = pareto(lambda law, parameters, case: None, LAWS, SPACES, budget=8)
    assert nothing.reference is None and nothing.hypervolumes == {}
    json.dumps(nothing.as_dict(), allow_nan=False)
    with drawing.settings():
        for one in (result, nothing):
            assert drawing.svg(pareto_figure(one), "test").startswith("<svg")


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"budget": 48}, "power of two"),
        ({"objectives": ("iae", "iae")}, "two metrics that differ"),
        ({"spaces": {"layer": {}}}, "no space for relay"),
        ({"spaces": {law: {"k": (0.0, 1.0)} for law in LAWS}}, "range of k"),
    ],
)
def test_unusable_requests_are_refused(wrong, words):
    with pytest.raises(ParameterError, match=words):
        pareto(hyperbola({"layer": 1.0, "relay": 1.0}), LAWS, **({"spaces": SPACES} | wrong))
