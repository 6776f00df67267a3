"""Scalars that become arrays of FMI 3: which ones, with what start values, texts and dependencies."""

from collections.abc import Callable

import pytest
from fmpy.model_description import ModelDescription

from brunovsky.blocks import Block, Output, Parameter, State, library, symbols
from brunovsky.fmi import scalar_variables
from brunovsky.fmi.arrays import array_variables, spans
from brunovsky.fmi.variables import reference_offsets

Describe = Callable[..., ModelDescription]


def test_the_dependencies_of_an_array_are_those_of_its_elements(described: Describe) -> None:
    def kinds(description: ModelDescription, name: str) -> dict[str, str]:
        one = next(one for one in description.outputs if one.variable.name == name)
        return dict(zip((known.name for known in one.dependencies), one.dependenciesKind, strict=True))

    block = library.closed_loop()
    scalars, arrays = described(block), described(block, arrays=True)
    assert kinds(scalars, "S[1]")["x"] == kinds(arrays, "S")["x"] == "tunable"
    elements = kinds(scalars, "v[1]").keys() | kinds(scalars, "v[2]").keys()
    assert kinds(arrays, "v").keys() == elements - {"center[1]", "center[2]"} | {"center"}
    initial = {one.variable.name: {known.name for known in one.dependencies} for one in arrays.initialUnknowns}
    assert "center" in initial["S"] and "center[1]" not in initial["S"]


def _table(*names: str) -> Block:
    return Block(
        "table", parameters=[Parameter(one, "m", f"number {one} of all", k, -k) for k, one in enumerate(names, 1)]
    )


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (["a[1]", "a[2]", "a[3]", "b"], {"a": (3,), "b": ()}),
        (["A[1,1]", "A[1,2]", "A[1,3]", "A[2,1]", "A[2,2]", "A[2,3]"], {"A": (2, 3)}),
        (["p.a[1]", "p.a[2]", "q[1].a[1]", "q[1].a[2]"], {"p.a": (2,), "q[1].a": (2,)}),
        (["A[1,1]", "A[2,1]", "A[1,2]", "A[2,2]"], dict.fromkeys(["A[1,1]", "A[2,1]", "A[1,2]", "A[2,2]"], ())),
        (["A[1,1]", "A[1,2]", "A[2,1]"], dict.fromkeys(["A[1,1]", "A[1,2]", "A[2,1]"], ())),
        (["a[2]", "a[3]"], {"a[2]": (), "a[3]": ()}),
        (["a[1]", "b", "a[2]"], {"a[1]": (), "b": (), "a[2]": ()}),
        (["a[1]"], {"a[1]": ()}),
        (["a", "a[1]", "a[2]"], {"a": (), "a[1]": (), "a[2]": ()}),
    ],
)
def test_complete_consecutive_elements_are_an_array(names: list[str], expected: dict[str, tuple[int, ...]]) -> None:
    block = _table(*names)
    found = array_variables(scalar_variables(block, 3))
    assert {one.name: one.shape for one in found if one.name not in ("time", "step_size")} == expected
    lengths = spans(found, reference_offsets(block)["end"])
    if lengths is None:
        assert not any(expected.values())
    else:
        assert sum(lengths) == len(lengths)
        assert [lengths[one.first.reference] for one in found] == [len(one.elements) for one in found]


def test_an_array_has_the_starts_and_text_of_all_elements(described: Describe) -> None:
    variables = {one.name: one for one in described(_table("a[1]", "a[2]", "b"), arrays=True).modelVariables}
    a = variables["a"]
    assert (a.start, a.min, a.shape, a.valueReference) == ("1.0 2.0", None, (2,), 3)
    assert a.description == "number a[1], a[2] of all"
    assert (variables["b"].start, variables["b"].min) == ("3.0", "-3.0")


@pytest.mark.parametrize(
    ("order", "shown", "merged"),
    [
        (["x[1]", "x[2]"], [], True),
        (["x[1]", "x[2]"], ["x[1]", "x[2]"], True),
        (["x[2]", "x[1]"], ["x[1]", "x[2]"], False),  # the order of the derivatives is that of the states
        (["x[1]", "y", "x[2]"], ["x[1]", "x[2]"], False),
        (["x[1]", "y", "x[2]"], [], False),
        (["x[1]", "x[2]"], ["x[1]"], False),
    ],
)
def test_states_are_an_array_where_their_derivatives_are(
    order: list[str], shown: list[str], merged: bool, described: Describe
) -> None:
    block = Block(
        "chain",
        states=[State(one, "m", derivative=-symbols(one)[0] * k) for k, one in enumerate(order, 1)],
        outputs=[Output(one, "m", expression=symbols(one)[0]) for one in shown],
    )
    description = described(block, arrays=True)
    names = {one.name for one in description.modelVariables}
    assert ({"x", "der(x)"} <= names, "x[1]" in names, "der(x[1])" in names) == (merged, not merged, not merged)
    ordered = [
        element
        for one in description.derivatives
        for element in [one.variable.derivative.name] * (one.variable.shape or (1,))[0]
    ]
    assert ordered == (["x", "x"] if merged else order)
