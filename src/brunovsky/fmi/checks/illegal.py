"""Calls that the standard forbids: each must be refused with an error, and leave the instance to be freed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fmpy.fmi1 import FMICallException

from brunovsky.fmi.checks.experiment import real_variables, size
from brunovsky.fmi.checks.instance import Instance
from brunovsky.fmi.checks.report import FAILED, PASSED
from brunovsky.fmi.checks.subject import Answer, Subject


def wrong_token(subject: Subject) -> Answer:
    """No instance for another token than that of the description."""
    try:
        other = subject.instance(token="{00000000-0000-0000-0000-000000000000}")
    except Exception:
        return PASSED, "another token gives no instance"
    other.free()
    return FAILED, "it is instantiated with another token than its description has"


def illegal_calls(subject: Subject) -> Answer:
    """A few calls in the wrong state or with wrong arguments."""
    fresh = subject.instance()
    running = subject.started("running")
    calls = _calls(subject, fresh, running.instance)
    accepted = [name for name, call in calls.items() if not _refused(call)]
    fresh.free()
    running.instance.free()
    if accepted:
        return FAILED, f"accepted: {', '.join(accepted)}"
    return PASSED, f"{len(calls)} refused: {', '.join(calls)}"


def _refused(call: Callable[[], Any]) -> bool:
    try:
        call()
    except FMICallException as error:
        return bool(error.status in (2, 3))
    return False


def _calls(subject: Subject, fresh: Instance, running: Instance) -> dict[str, Callable[[], Any]]:
    run, variables = subject.run, subject.description.modelVariables
    unknown = max(one.valueReference for one in variables) + 1_000_003
    get = running.fmu.getReal if running.version == 2 else running.fmu.getFloat64
    calls: dict[str, Callable[[], Any]] = {"reading a variable that there isn't": lambda: get([unknown])}
    if subject.interface == "CoSimulation":
        calls["a step before initialisation"] = lambda: fresh.fmu.doStep(run.start, run.step)
        calls["a step backwards"] = lambda: running.fmu.doStep(run.start, -run.step)
    else:
        calls["setting the time before initialisation"] = lambda: fresh.fmu.setTime(run.start)
        calls["leaving event mode outside of it"] = lambda: running.fmu.enterContinuousTimeMode()
    calls["leaving initialisation twice"] = lambda: running.fmu.exitInitializationMode()
    states = [one.variable.derivative for one in subject.description.derivatives]
    outputs = [one for one in real_variables(variables, "output") if one not in states]
    if outputs:
        calls["setting an output"] = lambda: running.set(outputs[:1], [0.0] * size(outputs[0]))
    return calls
