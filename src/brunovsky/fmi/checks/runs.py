"""Checks of whole runs: life cycle, finite outputs, the same run again, two instances, the stop time."""

from __future__ import annotations

import numpy as np
from fmpy.fmi1 import FMICallException

from brunovsky.fmi.checks.report import FAILED, NOT_PROVIDED, PASSED
from brunovsky.fmi.checks.subject import TOLERANCE, Answer, Subject, difference


def life_cycle(subject: Subject) -> Answer:
    """Instantiate, initialise, step, terminate, free."""
    rows = subject.reference
    return PASSED, f"{len(rows) - 1} steps of {subject.run.step:g} s, terminated and freed"


def finite_outputs(subject: Subject) -> Answer:
    """No NaN or infinity in what is compared."""
    rows = subject.reference
    wrong = np.argwhere(~np.isfinite(rows))
    if len(wrong):
        step, column = wrong[0]
        time = subject.run.start + step * subject.run.step
        return FAILED, f"{_column_name(subject, int(column))} is {rows[step, column]} at {time:g} s"
    return PASSED, f"{rows.size} values"


def _column_name(subject: Subject, column: int) -> str:
    names = [one.name for one in subject.compared for _ in range(int(np.prod(one.shape or (1,))))]
    return str(names[column])


def _compared(found: np.ndarray, expected: np.ndarray, what: str) -> Answer:
    apart = difference(found, expected)
    status = PASSED if apart <= TOLERANCE else FAILED
    return status, f"{what}: " + (
        "the same numbers" if apart == 0 else f"outputs differ by {apart:.1e} of their largest"
    )


def rerun(subject: Subject) -> Answer:
    """A second instance behind the first."""
    stepper = subject.started("again")
    found = subject.record(stepper)
    stepper.instance.free()
    return _compared(found, subject.reference, "a new instance")


def reset(subject: Subject) -> Answer:
    """The same instance after a reset."""
    expected = subject.reference
    stepper = subject.started()
    subject.record(stepper, max(1, subject.run.steps // 2))
    stepper.instance.fmu.terminate()
    stepper.instance.fmu.reset()
    stepper.start()
    found = subject.record(stepper)
    stepper.instance.free()
    return _compared(found, expected, "after a reset")


def two_instances(subject: Subject) -> Answer:
    """Two instances in turns, the second started while the first is on its way."""
    if subject.capabilities.canBeInstantiatedOnlyOncePerProcess:
        return NOT_PROVIDED, "only one instance in a process"
    expected = subject.reference
    head = subject.run.steps // 3
    first = subject.started("first")
    rows = [subject.record(first, head)]
    second = subject.started("second")
    others = [subject.outputs(second)]
    for _ in range(subject.run.steps - head):
        first.advance()
        second.advance()
        rows.append(subject.outputs(first)[None])
        others.append(subject.outputs(second))
    first.instance.free()
    second.advance()  # the one that is left still works
    second.instance.free()
    both = np.concatenate([*rows, np.array(others)])
    return _compared(both, np.concatenate([expected, expected[: len(others)]]), "two in turns")


def stop_time(subject: Subject) -> Answer:
    """A step beyond the stop time is refused; up to it, the life cycle has shown."""
    stepper = subject.started()
    subject.record(stepper)
    try:
        stepper.advance()
    except FMICallException as error:
        return PASSED, f"a step beyond {subject.run.stop:g} s is refused (status {error.status})"
    finally:
        stepper.instance.free()
    return FAILED, f"steps beyond the stop time, {subject.run.stop:g} s, that it was given"
