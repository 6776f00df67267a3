"""Advancing an instance by communication steps: by its own solver, or in model exchange by RK4."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np

from brunovsky.fmi.checks.experiment import Experiment
from brunovsky.fmi.checks.instance import Instance, Refused

_MOST_ITERATIONS = 100


class Stepper:
    """An instance in co-simulation and the number of steps it has made."""

    def __init__(self, instance: Instance, run: Experiment) -> None:
        self.instance = instance
        self.run = run
        self.count = 0

    @property
    def time(self) -> float:
        """Now, in s."""
        return self.run.start + self.count * self.run.step

    def start(self) -> None:
        """Initialise."""
        self.count = 0
        self.instance.initialize(self.run)

    def advance(self) -> None:
        """One communication step."""
        self.instance.step(self.time, self.run.step)
        self.count += 1

    def memory(self) -> Any:
        """What has to be put back together with the state of the FMU."""
        return self.count

    def recall(self, memory: Any) -> None:
        """Put back what :meth:`memory` gave."""
        self.count = memory


class Exchange(Stepper):
    """An instance in model exchange, integrated by RK4; events take effect at the ends of its steps."""

    def __init__(self, instance: Instance, run: Experiment) -> None:
        super().__init__(instance, run)
        self.states = int(instance.description.numberOfContinuousStates)
        self.indicators = int(instance.description.numberOfEventIndicators)
        self.next_event = np.inf
        self.signs = np.zeros(0)

    def start(self) -> None:
        """Initialise, and resolve the events of the first instant."""
        super().start()
        self._events()

    def memory(self) -> Any:
        """Count, next time event and signs of the indicators."""
        return self.count, self.next_event, self.signs.copy()

    def recall(self, memory: Any) -> None:
        """Put them back."""
        self.count, self.next_event, self.signs = memory

    def advance(self) -> None:
        """One step, in parts where time events fall within."""
        time, end = self.time, self.run.start + (self.count + 1) * self.run.step
        closeness = 1e-12 * max(1.0, abs(end))
        while time < end - closeness:
            target = end if self.next_event > end - closeness else max(self.next_event, time + closeness)
            self._step(time, target - time)
            time = target
            self._completed(time >= self.next_event - closeness)
        self.count += 1

    def _step(self, time: float, length: float) -> None:
        if self.states:
            x = self.instance.vector("getContinuousStates", self.states)
            k1 = self.slope(time, x)
            k2 = self.slope(time + length / 2, x + length / 2 * k1)
            k3 = self.slope(time + length / 2, x + length / 2 * k2)
            k4 = self.slope(time + length, x + length * k3)
            self._set(time + length, x + length / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
        else:
            self.instance.fmu.setTime(time + length)

    def _set(self, time: float, x: np.ndarray) -> None:
        self.instance.fmu.setTime(time)
        self.instance.fmu.setContinuousStates((ctypes.c_double * len(x))(*x), len(x))

    def slope(self, time: float, x: np.ndarray) -> np.ndarray:
        """Derivatives of the continuous states."""
        self._set(time, x)
        function = "getDerivatives" if self.instance.version == 2 else "getContinuousStateDerivatives"
        return self.instance.vector(function, self.states)

    def _completed(self, due: bool) -> None:
        wanted, ends = self.instance.fmu.completedIntegratorStep()
        if ends:
            raise Refused(f"asks to terminate the simulation at {self.time:g} s")
        if due or wanted or np.any(self._signs() != self.signs):
            self.instance.fmu.enterEventMode()
            self._events()

    def _signs(self) -> np.ndarray:
        if not self.indicators:
            return np.zeros(0)
        return self.instance.vector("getEventIndicators", self.indicators) > 0

    def _events(self) -> None:
        fmu = self.instance.fmu
        update = fmu.newDiscreteStates if self.instance.version == 2 else fmu.updateDiscreteStates
        for _ in range(_MOST_ITERATIONS):
            needed, ends, _, _, defined, at = update()
            if ends:
                raise Refused(f"asks to terminate the simulation at {self.time:g} s")
            if not needed:
                break
        else:
            raise Refused(f"the event iteration at {self.time:g} s has no end after {_MOST_ITERATIONS} rounds")
        self.next_event = at if defined else np.inf
        fmu.enterContinuousTimeMode()
        self.signs = self._signs()
