"""Checks of saved states: restored in memory, and by way of bytes."""

from __future__ import annotations

from brunovsky.fmi.checks.report import FAILED, NOT_PROVIDED, PASSED
from brunovsky.fmi.checks.subject import TOLERANCE, Answer, Subject, difference

_BEHIND = 10


def state_round_trip(subject: Subject) -> Answer:
    """Save, step, restore, step: the same outputs."""
    if not subject.capabilities.canGetAndSetFMUstate:
        return NOT_PROVIDED, "canGetAndSetFMUstate is false"
    stepper = subject.started()
    half = subject.run.steps // 2
    subject.record(stepper, half)
    steps = min(_BEHIND, subject.run.steps - half)
    state, memory = stepper.instance.fmu.getFMUState(), stepper.memory()
    first = subject.record(stepper, steps)
    stepper.instance.fmu.setFMUState(state)
    stepper.recall(memory)
    second = subject.record(stepper, steps)
    stepper.instance.fmu.freeFMUState(state)
    stepper.instance.free()
    return _compared(difference(second, first), f"{steps} steps again")


def serialized_state(subject: Subject) -> Answer:
    """Save as bytes, restore in another instance, step: the same outputs."""
    if not subject.capabilities.canSerializeFMUstate:
        return NOT_PROVIDED, "canSerializeFMUstate is false"
    stepper = subject.started()
    half = subject.run.steps // 2
    subject.record(stepper, half)
    steps = min(_BEHIND, subject.run.steps - half)
    state, memory = stepper.instance.fmu.getFMUState(), stepper.memory()
    data = stepper.instance.fmu.serializeFMUState(state)
    first = subject.record(stepper, steps)
    alone = subject.capabilities.canBeInstantiatedOnlyOncePerProcess
    other = stepper if alone else subject.started()  # of the same name: the standard asks for no more
    restored = other.instance.fmu.deserializeFMUState(data)
    other.instance.fmu.setFMUState(restored)
    other.recall(memory)
    second = subject.record(other, steps)
    where = "the same instance" if alone else "another instance"
    return _compared(difference(second, first), f"{len(data)} bytes, {steps} steps in {where}")


def _compared(apart: float, what: str) -> Answer:
    if apart <= TOLERANCE:
        return PASSED, f"{what}: " + ("the same numbers" if apart == 0 else f"differ by {apart:.1e}")
    return FAILED, f"{what}: outputs differ by {apart:.1e} of their largest"
