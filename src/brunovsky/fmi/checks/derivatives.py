"""Derivatives by central differences, through the FMU: against directional derivatives and declared dependencies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from fmpy.fmi1 import FMICallException

from brunovsky.fmi.checks.experiment import size
from brunovsky.fmi.checks.report import FAILED, NOT_PROVIDED, PASSED
from brunovsky.fmi.checks.stepping import Exchange, Stepper
from brunovsky.fmi.checks.subject import Answer, Subject

_LIMIT = 1e-5
"""Of the difference of derivatives, relative to the largest value beside it."""
_NOTHING = 1e-7
_STEPS = 3


@dataclass(frozen=True)
class Place:
    """An instance where derivatives are taken, with what depends there (unknowns) on what (knowns, states first).

    ``remark`` says why it isn't the usual place.
    """

    stepper: Stepper
    unknowns: tuple[Any, ...]
    states: tuple[Any, ...]
    inputs: tuple[Any, ...]
    remark: str = ""

    @property
    def knowns(self) -> tuple[Any, ...]:
        """States and inputs."""
        return (*self.states, *self.inputs)


@dataclass(frozen=True)
class Slopes:
    """Derivatives of unknowns (rows) by knowns (columns); ``smooth`` where two differences agree."""

    unknowns: tuple[Any, ...]
    knowns: tuple[Any, ...]
    values: np.ndarray
    smooth: np.ndarray
    given: np.ndarray | None
    remark: str = ""


def directional_derivatives(subject: Subject) -> Answer:
    """What the FMU says against central differences."""
    if not subject.capabilities.providesDirectionalDerivative:
        return NOT_PROVIDED, "providesDirectionalDerivative is false"
    found = _slopes(subject, derivatives=True)
    if found.given is None or not found.values.size:
        return PASSED, "there is no known on which a continuous unknown depends"
    apart = np.where(found.smooth, np.abs(found.given - found.values) / (1.0 + np.abs(found.values)), 0.0)
    row, column = np.unravel_index(np.argmax(np.where(np.isnan(apart), np.inf, apart)), apart.shape)
    worst = apart[row, column]
    what = f"{int(found.smooth.sum())} of them, off central differences by at most {worst:.1e}{found.remark}"
    if worst <= _LIMIT:
        return PASSED, what
    names = f"d {found.unknowns[row].name} / d {found.knowns[column].name}"
    return (
        FAILED,
        f"{names} is given as {found.given[row, column]:.6g}, differences say {found.values[row, column]:.6g}",
    )


def declared_dependencies(subject: Subject) -> Answer:
    """Nothing may change by what the description doesn't list."""
    found = _slopes(subject, derivatives=False)
    if not found.values.size:
        return PASSED, "there is no known on which a continuous unknown depends"
    listed = {id(one.variable): one.dependencies for one in _structure(subject)}
    for row, unknown in enumerate(found.unknowns):
        dependencies = listed.get(id(unknown))
        if dependencies is None:  # none declared: all
            continue
        known = {id(one) for one in dependencies}
        for column, one in enumerate(found.knowns):
            slope = found.values[row, column]
            if id(one) not in known and unknown is not one and abs(slope) > _NOTHING:
                return (
                    FAILED,
                    f"{unknown.name} changes by {slope:.3g} with {one.name}, which its dependencies don't list",
                )
    return PASSED, f"{found.values.size} pairs, none beyond those declared changes"


def _structure(subject: Subject) -> Sequence[Any]:
    structure = subject.description
    if subject.interface == "CoSimulation":
        return list(structure.initialUnknowns)
    return [*structure.outputs, *structure.derivatives]


def _continuous(unknowns: Sequence[Any]) -> tuple[Any, ...]:
    """Variables of the unknowns that are continuous scalars."""
    return tuple(
        one.variable for one in unknowns
        if one.variable.type in ("Real", "Float64") and one.variable.variability == "continuous"
        and size(one.variable) == 1 and not one.variable.clocks
    )  # fmt: skip


def place(subject: Subject, *, derivatives: bool = True) -> Place:
    """Of co-simulation in initialisation mode, of model exchange in continuous-time mode, after a few steps.

    Where initialisation mode refuses the derivatives that are wanted, co-simulation too is taken after a few steps:
    an event of the first instant may leave none there.
    """
    unknowns = _continuous(_structure(subject))
    inputs = tuple(one for one in subject.inputs if size(one) == 1)
    if subject.interface == "CoSimulation":
        stepper = subject.stepper(subject.instance())
        stepper.instance.initialize(stepper.run, leave=False)
        if not (derivatives and unknowns and inputs) or _answers(stepper, unknowns, inputs[0]):
            return Place(stepper, unknowns, (), inputs)
        stepper.instance.free()
        remark = f"; after {_STEPS} steps, as initialisation mode refuses them: {subject.last_message}"
        stepper = subject.started()
        subject.record(stepper, min(_STEPS, subject.run.steps))
        return Place(stepper, _continuous(subject.description.outputs), (), inputs, remark)
    stepper = subject.started()
    subject.record(stepper, min(_STEPS, subject.run.steps))
    states = tuple(one.variable.derivative for one in subject.description.derivatives)
    if any(size(one) > 1 for one in states):
        states = ()
    return Place(stepper, unknowns, states, inputs)


def _answers(stepper: Stepper, unknowns: Sequence[Any], known: Any) -> bool:
    try:
        stepper.instance.directional(unknowns, known)
    except FMICallException:
        return False
    return True


def _slopes(subject: Subject, *, derivatives: bool) -> Slopes:
    here = place(subject, derivatives=derivatives)
    assign = _setter(here.stepper, here.states)
    found = _measured(here.stepper, here.unknowns, here.knowns, assign, derivatives)
    return replace(found, remark=here.remark)


def _setter(stepper: Stepper, states: Sequence[Any]) -> Callable[[Any, float], None]:
    instance = stepper.instance
    start = instance.vector("getContinuousStates", len(states)) if states else np.zeros(0)
    places = {id(one): place for place, one in enumerate(states)}

    def assign(known: Any, value: float) -> None:
        if id(known) in places and isinstance(stepper, Exchange):
            x = start.copy()
            x[places[id(known)]] = value
            stepper.slope(stepper.time, x)
        else:
            instance.set([known], [value])

    return assign


def _measured(
    stepper: Stepper,
    unknowns: tuple[Any, ...],
    knowns: tuple[Any, ...],
    assign: Callable[[Any, float], None],
    derivatives: bool,
) -> Slopes:
    values = np.zeros((len(unknowns), len(knowns)))
    smooth, given = np.ones(values.shape, dtype=bool), np.zeros(values.shape) if derivatives else None
    for column, known in enumerate(knowns if unknowns else ()):
        at = float(stepper.instance.get([known])[0])
        if given is not None:
            given[:, column] = stepper.instance.directional(unknowns, known)
        width = 1e-5 * max(abs(at), abs(float(known.nominal or 1.0)))

        def at_distance(distance: float, known: Any = known, at: float = at) -> np.ndarray:
            assign(known, at + distance)
            return stepper.instance.get(unknowns)

        wide, narrow = ((at_distance(one) - at_distance(-one)) / (2 * one) for one in (width, width / 2))
        here, above = at_distance(0.0), at_distance(width / 4)
        one_sided = (above - here) / (width / 4)
        values[:, column] = narrow
        scale = 1e-3 * (1.0 + np.abs(narrow))
        smooth[:, column] = (np.abs(wide - narrow) < scale) & (np.abs(one_sided - narrow) < scale)
        assign(known, at)
    stepper.instance.free()
    return Slopes(unknowns, knowns, values, smooth, given)
