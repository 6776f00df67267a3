"""Variables as FMI 3 shows them: each scalar by itself, or elements ``name[1]`` to ``name[n]`` as one array.

An array has the value reference of its first element. Its elements are scalars of one kind in the order of their value
references, row by row where it has two dimensions or more.
"""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from brunovsky.fmi.variables import ScalarVariable

_ELEMENT = re.compile(r"(?P<der>der\()?(?P<stem>[^()]*)\[(?P<indices>[\d,]+)\](?(der)\))", re.ASCII)


@dataclass(frozen=True)
class ArrayVariable:
    """Scalar variables under one name and value reference.

    Parameters
    ----------
    name : str
        Of the array; of the variable itself where it is a scalar.
    shape : tuple of int
        Sizes of its dimensions, empty for a scalar.
    elements : tuple of ScalarVariable
        Row by row.
    """

    name: str
    shape: tuple[int, ...]
    elements: tuple[ScalarVariable, ...]

    @property
    def first(self) -> ScalarVariable:
        """First element, whose kind, unit and value reference are those of all."""
        return self.elements[0]

    @property
    def description(self) -> str:
        """Text of all elements once: what they share at their beginning and end, and between it what differs."""
        return _joined([one.description for one in self.elements])

    def common(self, attribute: str) -> float | None:
        """Value of a numerical attribute that all elements share, None where they don't."""
        values: set[float | None] = {getattr(one, attribute) for one in self.elements}
        return values.pop() if len(values) == 1 else None


def array_variables(variables: Sequence[ScalarVariable], arrays: bool = True) -> tuple[ArrayVariable, ...]:
    """Variables of an FMU 3 in the order of their value references.

    Parameters
    ----------
    variables : sequence of ScalarVariable
        The whole table of :func:`brunovsky.fmi.scalar_variables`.
    arrays : bool
        Whether elements are merged: those with complete indices from 1 whose value references follow each other and
        that agree in causality, variability, initial, type, unit and clocks. Elements that are continuous states
        are merged where their derivatives can be as well.
    """
    groups = _groups(variables) if arrays else {}
    states = {one.derivative_of for one in variables if one.derivative_of}
    whole = [one for one in groups.values() if _keeps_states_whole(one, states, groups)]
    arrays_of = {element.name: one for one in whole for element in one.elements}
    found = [arrays_of.get(one.name, ArrayVariable(one.name, (), (one,))) for one in variables]
    return tuple(dict.fromkeys(found))


def spans(variables: Sequence[ArrayVariable], end: int) -> list[int] | None:
    """Number of elements behind each value reference below ``end``: 0 within an array; None if there are no arrays."""
    if not any(one.shape for one in variables):
        return None
    result = [1] * end
    for one in variables:
        for element in one.elements:
            result[element.reference] = 0
        result[one.first.reference] = len(one.elements)
    return result


def _groups(variables: Sequence[ScalarVariable]) -> dict[str, ArrayVariable]:
    """Complete runs of elements by the name of their array."""
    taken = {one.name for one in variables}
    groups = {}
    for run in _runs(variables):
        name, shape = _array_name(run[0]), _shape(run)
        if name and shape and len(run) > 1 and name not in taken:
            groups[name] = ArrayVariable(name, shape, tuple(run))
    return groups


def _runs(variables: Sequence[ScalarVariable]) -> Iterator[list[ScalarVariable]]:
    run: list[ScalarVariable] = []
    for one in variables:
        if run and (_kind(one) != _kind(run[-1]) or one.reference != run[-1].reference + 1):
            yield run
            run = []
        run.append(one)
    if run:
        yield run


def _kind(one: ScalarVariable) -> tuple[object, ...]:
    clocked = (one.type, one.unit, one.clocks, one.indicator, bool(one.derivative_of))
    return (_array_name(one), one.causality, one.variability, one.initial, *clocked)


def _array_name(one: ScalarVariable) -> str | None:
    match = _ELEMENT.fullmatch(one.name)
    if match is None or one.type == "Clock":
        return None
    return f"der({match['stem']})" if match["der"] else match["stem"]


def _shape(run: Sequence[ScalarVariable]) -> tuple[int, ...] | None:
    """Shape that the elements fill, row by row; None if they don't."""
    indices = [_indices(one) for one in run]
    if not indices[0] or len({len(one) for one in indices}) != 1:
        return None
    shape = tuple(map(max, zip(*indices, strict=True)))
    complete = itertools.product(*(range(1, size + 1) for size in shape))
    return shape if math.prod(shape) == len(indices) and indices == list(complete) else None


def _indices(one: ScalarVariable) -> tuple[int, ...]:
    match = _ELEMENT.fullmatch(one.name)
    return tuple(map(int, match["indices"].split(","))) if match else ()


def _keeps_states_whole(one: ArrayVariable, states: set[str], groups: Mapping[str, ArrayVariable]) -> bool:
    """Whether no element is a state or its derivative, or all are and the states and their derivatives are arrays."""

    def behind(name: str) -> list[str]:
        elements = groups[name].elements if name in groups else ()
        return [element.derivative_of or element.name for element in elements]

    names = behind(one.name)
    if not states & set(names):
        return True
    stem = one.name.removeprefix("der(").removesuffix(")")
    return states.issuperset(names) and behind(stem) == names == behind(f"der({stem})")


def _joined(texts: Sequence[str]) -> str:
    """Words that all texts have at their beginning and end, and between them once each what differs."""
    words = [one.split() for one in texts]
    if all(one == words[0] for one in words):
        return texts[0]
    start = _shared(words)
    end = _shared([one[start:][::-1] for one in words])
    between = dict.fromkeys(" ".join(one[start : len(one) - end]).rstrip(",;") for one in words)
    separator = ", " if start or end else "; "
    return " ".join([*words[0][:start], separator.join(between), *words[0][len(words[0]) - end :]])


def _shared(words: Sequence[Sequence[str]]) -> int:
    """Number of words that all texts begin with."""
    columns = zip(*words, strict=False)
    return sum(1 for _ in itertools.takewhile(lambda column: len(set(column)) == 1, columns))
