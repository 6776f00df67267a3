"""What the checks of a run share: instances of one FMU through one interface, and its trajectory."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path

import numpy as np
from fmpy.model_description import ModelDescription

from brunovsky.fmi.checks.description import interfaces
from brunovsky.fmi.checks.experiment import Experiment, experiment, real_variables
from brunovsky.fmi.checks.instance import Instance
from brunovsky.fmi.checks.stepping import Exchange, Stepper

Answer = tuple[str, str]
"""Status and detail of a check."""

TOLERANCE = 1e-10
"""Of what must be equal, relative to the largest value: tools may sum in another order, no more."""


class Subject:
    """An unpacked FMU, seen through one interface."""

    def __init__(self, folder: Path, description: ModelDescription, interface: str) -> None:
        self.folder = folder
        self.description = description
        self.interface = interface
        self.capabilities = interfaces(description)[interface]
        self.run = experiment(description)
        variables = description.modelVariables
        self.inputs = real_variables(variables, "input", "continuous")
        self.compared = real_variables(variables, "output") or real_variables(variables, "local", "continuous")
        self._last: Instance | None = None

    @property
    def last_message(self) -> str:
        """What the newest instance logged last."""
        return self._last.messages[-1] if self._last and self._last.messages else ""

    def instance(self, name: str = "one", token: str | None = None) -> Instance:
        """A fresh instance."""
        self._last = Instance(self.folder, self.description, self.interface, name, token)
        return self._last

    def stepper(self, instance: Instance, run: Experiment | None = None) -> Stepper:
        """What advances an instance."""
        kind = Stepper if self.interface == "CoSimulation" else Exchange
        return kind(instance, run or self.run)

    def started(self, name: str = "one", run: Experiment | None = None) -> Stepper:
        """An instance that is initialised, at the start time."""
        stepper = self.stepper(self.instance(name), run)
        stepper.start()
        return stepper

    def outputs(self, stepper: Stepper) -> np.ndarray:
        """What is compared, now."""
        return stepper.instance.get(self.compared)

    def record(self, stepper: Stepper, steps: int | None = None) -> np.ndarray:
        """What is compared, now and after each of some steps: one row each."""
        rows = [self.outputs(stepper)]
        for _ in range(self.run.steps if steps is None else steps):
            stepper.advance()
            rows.append(self.outputs(stepper))
        return np.array(rows)

    @cached_property
    def reference(self) -> np.ndarray:
        """Trajectory of one instance alone."""
        stepper = self.started()
        rows = self.record(stepper)
        stepper.instance.fmu.terminate()
        stepper.instance.free()
        return rows


def difference(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest difference, relative to the largest value of each column; the same NaN or infinity is no difference."""
    if expected.size == 0:
        return 0.0
    same = (found == expected) | (np.isnan(found) & np.isnan(expected))
    with np.errstate(invalid="ignore", over="ignore"):
        scale = np.maximum(np.max(np.abs(np.where(np.isfinite(expected), expected, 0.0)), axis=0), 1e-300)
        apart = np.where(same, 0.0, np.abs(found - expected) / scale)
    return float(np.max(np.where(np.isnan(apart), np.inf, apart)))
