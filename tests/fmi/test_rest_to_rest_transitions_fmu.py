"""The closed loop from rest to rest as FMU takes the same transitions as the native engine, step for step."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave
from rest_to_rest_scenarios import SCENARIOS, STEP, Scenario, compared, driven

import brunovsky as br
from brunovsky.blocks import Block
from brunovsky.native import NativeEngine

MODES = [f"regulator.supervisor.{one}" for one in ("leg", "choice", "carry", "search")]


class Fmu:
    """An FMU in co-simulation as a target of a scenario; besides its outputs it shows the inner modes."""

    def __init__(self, folder: str, version: int, scenario: Scenario, outputs: list[str]) -> None:
        description = read_model_description(folder)
        self.version, self.time = version, 0.0
        self.references = {one.name: one.valueReference for one in description.modelVariables}
        kind = FMU2Slave if version == 2 else FMU3Slave
        self.fmu = kind(
            guid=description.guid, unzipDirectory=folder, instanceName="one",
            modelIdentifier=description.coSimulation.modelIdentifier,
        )  # fmt: skip
        self.integers = ["mode", *MODES]
        self.reals = [one for one in outputs if one != "mode"]
        self.fmu.instantiate()
        if version == 2:
            self.fmu.setupExperiment(startTime=0.0)
        self.set_parameters(scenario.start)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set_parameters(self, values: Mapping[str, float]) -> None:
        write = self.fmu.setReal if self.version == 2 else self.fmu.setFloat64
        write([self.references[one] for one in values], list(values.values()))

    def set_inputs(self, values: Mapping[str, float]) -> None:
        self.set_parameters(values)

    def step(self) -> None:
        self.fmu.doStep(currentCommunicationPoint=self.time, communicationStepSize=STEP)
        self.time += STEP

    def outputs(self) -> list[float]:
        reals, integers = ([self.references[one] for one in names] for names in (self.reals, self.integers))
        if self.version == 2:
            return [*self.fmu.getReal(reals), *self.fmu.getInteger(integers)]
        return [*self.fmu.getFloat64(reals), *self.fmu.getInt32(integers)]


class Native:
    """Compiled code with the same values."""

    def __init__(self, block: Block, scenario: Scenario) -> None:
        self.engine = NativeEngine(block, STEP)
        self.engine.set_parameters(scenario.start)
        self.engine.initialize()
        self.inputs = [one.name for one in block.inputs]
        self.names = [one.name for one in block.outputs]
        self.modes = [[one.name for one in block.modes].index(one) for one in MODES]
        self.set_parameters = self.engine.set_parameters

    def set_inputs(self, values: Mapping[str, float]) -> None:
        for name, value in values.items():
            self.engine.inputs[self.inputs.index(name)] = value

    def step(self) -> None:
        self.engine.advance(STEP)

    def outputs(self) -> list[float]:
        values = dict(zip(self.names, self.engine.outputs(), strict=True))
        mode = values.pop("mode")
        return [*values.values(), mode, *(self.engine.modes[one] for one in self.modes)]


@pytest.mark.slow
@pytest.mark.parametrize("version", [2, 3])
def test_the_fmu_takes_the_same_transitions(exported: Callable[..., object], version: int) -> None:
    block = br.blocks.rest_to_rest()
    folder = str(exported(block, version).folder)
    names = [one.name for one in block.outputs]
    for scenario in SCENARIOS.values():
        fmu = Fmu(folder, version, scenario, names)
        found, native = (np.array(list(driven(one, scenario))) for one in (fmu, Native(block, scenario)))
        fmu.fmu.terminate()
        fmu.fmu.freeInstance()
        assert (found[:, len(names) - 1 :] == native[:, len(names) - 1 :]).all()
        compared(found, native, 1e-9)
