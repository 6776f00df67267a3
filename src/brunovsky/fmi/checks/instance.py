"""A running instance of an unpacked FMU, with the same calls for FMI 2 and 3; statuses above warning are exceptions."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from fmpy import fmi2, fmi3
from fmpy.fmi1 import FMICallException
from fmpy.model_description import ModelDescription

from brunovsky.fmi.callbacks import logging_callbacks
from brunovsky.fmi.checks.description import binary_path, interfaces
from brunovsky.fmi.checks.experiment import Experiment, size

__all__ = ["FMICallException", "Instance", "Refused"]

_CLASSES = {
    (2, "CoSimulation"): fmi2.FMU2Slave,
    (2, "ModelExchange"): fmi2.FMU2Model,
    (3, "CoSimulation"): fmi3.FMU3Slave,
    (3, "ModelExchange"): fmi3.FMU3Model,
}


class Refused(Exception):
    """A check found something wrong; the message says what."""


class Instance:
    """One instance through one interface.

    Parameters
    ----------
    folder : Path
        Of the unpacked FMU.
    description : ModelDescription
        Its description.
    interface : str
        ``"CoSimulation"`` or ``"ModelExchange"``.
    name : str
        Of the instance.
    token : str, optional
        In place of that of the description.
    """

    def __init__(
        self, folder: Path, description: ModelDescription, interface: str, name: str = "one", token: str | None = None
    ) -> None:
        self.version = int(description.fmiMajorVersion)
        self.description = description
        self.capabilities = interfaces(description)[interface]
        self.messages: list[str] = []
        identifier = self.capabilities.modelIdentifier
        self.fmu: Any = _CLASSES[self.version, interface](
            guid=description.instantiationToken if token is None else token,
            modelIdentifier=identifier,
            unzipDirectory=str(folder),
            instanceName=name,
            libraryPath=str(binary_path(folder, identifier, self.version)),
            requireFunctions=False,
        )
        self._instantiate()

    def _instantiate(self) -> None:
        if self.version == 2:
            self.fmu.instantiate(callbacks=logging_callbacks(lambda _category, message: self.messages.append(message)))
        else:
            self.fmu.instantiate(logMessage=self._log3)

    def _log3(self, _environment: Any, _status: int, _category: Any, message: bytes | None) -> None:
        self.messages.append((message or b"").decode(errors="replace"))

    def initialize(self, run: Experiment, *, leave: bool = True, stop: bool = True) -> None:
        """Enter initialisation mode, and leave it; for model exchange until continuous-time mode."""
        end = run.stop if stop else None
        if self.version == 2:
            self.fmu.setupExperiment(startTime=run.start, stopTime=end)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=run.start, stopTime=end)
        if leave:
            self.fmu.exitInitializationMode()

    def step(self, time: float, length: float) -> None:
        """One whole communication step."""
        answer = self.fmu.doStep(currentCommunicationPoint=time, communicationStepSize=length)
        if answer is not None and answer[1]:
            raise Refused(f"asks to terminate the simulation in the step at {time:g} s")
        if answer is not None and abs(answer[3] - time - length) > 1e-9 * max(1.0, abs(time + length)):
            raise Refused(f"the step from {time:g} s by {length:g} s ended at {answer[3]:g} s, though none may be cut")

    def get(self, variables: Sequence[Any]) -> np.ndarray:
        """Values of doubles, elements of arrays one after the other."""
        if not variables:
            return np.zeros(0)
        references = [one.valueReference for one in variables]
        if self.version == 2:
            return np.array(self.fmu.getReal(references))
        return np.array(self.fmu.getFloat64(references, sum(size(one) for one in variables)))

    def set(self, variables: Sequence[Any], values: Sequence[float]) -> None:
        """Set doubles."""
        if variables:
            function = self.fmu.setReal if self.version == 2 else self.fmu.setFloat64
            function([one.valueReference for one in variables], [float(one) for one in values])

    def directional(self, unknowns: Sequence[Any], known: Any) -> np.ndarray:
        """Derivatives of scalar doubles with respect to one."""
        references = [one.valueReference for one in unknowns]
        return np.array(self.fmu.getDirectionalDerivative(references, [known.valueReference], [1.0]))

    def adjoint(self, unknowns: Sequence[Any], knowns: Sequence[Any], seed: Sequence[float]) -> np.ndarray:
        """Derivatives of the seeded sum of scalar doubles with respect to each known (FMI 3)."""
        references = [[one.valueReference for one in each] for each in (unknowns, knowns)]
        return np.array(self.fmu.getAdjointDerivative(*references, seed, len(knowns)))

    def vector(self, function: str, count: int) -> np.ndarray:
        """What a function of model exchange fills in: ``count`` doubles."""
        array = (ctypes.c_double * max(count, 1))()
        getattr(self.fmu, function)(array, count)
        return np.array(array[:count])

    def free(self) -> None:
        """Free the instance; the library stays loaded, as beside other instances."""
        getattr(self.fmu, f"fmi{self.version}FreeInstance")(self.fmu.component)
