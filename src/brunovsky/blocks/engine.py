"""A running block in plain NumPy: the readable statement of the semantics that compiled targets must reproduce.

Between events relations are frozen. At an event: due samples in the order of their rank, then relations and
transitions until nothing changes. A communication step is cut at sample instants; each piece is integrated by
classical RK4 in equal substeps no longer than ``step_size``, each of which begins with an event. On the way out
relations are evaluated once more, so that outputs belong to the state reached and to the inputs of the step;
samples and transitions of that instant wait for the next step and its inputs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import sympy as sp
from sympy.printing.numpy import NumPyPrinter

from brunovsky.blocks.block import Block
from brunovsky.blocks.variables import TIME, Check
from brunovsky.errors import ParameterError, SimulationError

MAX_EVENT_ITERATIONS = 20
MAX_SUBSTEPS = 1e9
STEP_ROUNDING = 1e-9  # a step is cut into ceil(h/step_size - STEP_ROUNDING) substeps
INSTANT_ROUNDING = 1e-6  # a sample is due this part of its period or step early, against rounding of time

Array = np.ndarray[Any, np.dtype[np.float64]]


class _Printer(NumPyPrinter):  # type: ignore[misc]
    """NumPy code with Piecewise as nested ``where``, which takes Boolean scalars as they are."""

    def _print_Piecewise(self, expr: sp.Piecewise) -> str:
        text: str = self._print(expr.args[-1].expr)
        for value, condition in reversed(expr.args[:-1]):
            text = f"{self._module_format('numpy.where')}({self._print(condition)}, {self._print(value)}, {text})"
        return text


def step_count(length: float, step_size: float) -> int:
    """Number of equal substeps of at most ``step_size`` that make up a step of this length."""
    return max(1, math.ceil(length / step_size - STEP_ROUNDING))


class NumpyEngine:
    """A running instance of a block, evaluated by NumPy.

    Attributes
    ----------
    time : float
        Current time, s.
    parameters, inputs, states, samples, modes, relations : ndarray
        Current values in the block's order of declaration; relations are 0 or 1.
    step_size : float
        Longest substep of the integration, s.
    """

    def __init__(self, block: Block, step_size: float = 1e-3) -> None:
        self.block = block
        self.step_size = step_size
        self._arguments = [
            TIME,
            *([one.symbol for one in group] for group in (block.states, block.inputs, block.parameters)),
            *([one.symbol for one in group] for group in (block.samples, block.modes, block.relations)),
        ]
        self._derivatives = self._function([one.derivative for one in block.states])
        self._outputs = self._function([one.expression for one in block.outputs])
        self._indicators = self._function(block.indicators)
        self._relations = [self._function([one.expression]) for one in block.relations]
        self._guards = self._function([one.guard for one in block.transitions])
        self._assignments = [self._function(list(one.assign.values())) for one in block.transitions]
        self._updates = self._function([one.update for one in block.samples])
        self._starts = self._function([*(one.start for one in block.states), *(one.start for one in block.samples)])
        self._periods = self._function([one.period for one in block.samples])
        self._explanations = [one for one in block.checks if one.when == "failure"]
        self._conditions = self._function([one.condition for one in self._explanations])
        self.reset()

    def _function(self, expressions: Any) -> Callable[[], list[float]]:
        call = sp.lambdify(self._arguments, list(expressions), modules="numpy", printer=_Printer, cse=True)

        def evaluate() -> list[float]:
            with np.errstate(all="ignore"):
                values = (self.states, self.inputs, self.parameters, self.samples, self.modes, self.relations)
                return [float(one) for one in call(np.float64(self.time), *values)]

        return evaluate

    def reset(self) -> None:
        """Back to default parameters and inputs, before initialisation."""
        block = self.block
        self.time = self.start_time = 0.0
        self.parameters = np.array([one.value for one in block.parameters])
        self.inputs = np.array([one.start for one in block.inputs])
        self.states = np.zeros(len(block.states))
        self.samples = np.zeros(len(block.samples))
        self.modes = np.zeros(len(block.modes), dtype=int)
        self.relations = np.zeros(len(block.relations), dtype=int)
        self._due = np.zeros(len(block.samples), dtype=int)

    def set_parameters(self, values: Mapping[str, float]) -> None:
        """Replace parameters by name; ParameterError if unknown, not finite or out of range."""
        current = {one.name: float(value) for one, value in zip(self.block.parameters, self.parameters, strict=True)}
        self.parameters = np.array(list(self.block.parameter_values(current | dict(values)).values()))

    def initialize(self, start_time: float = 0.0) -> None:
        """Start values, then the events of the first instant.

        Raises
        ------
        ParameterError
            If the parameters violate a check of the block.
        SimulationError
            If an output or derivative is not finite.
        """
        names = dict(zip((one.name for one in self.block.parameters), self.parameters, strict=True))
        for check in self.block.failed_checks(names, "start"):
            raise ParameterError(f"{self.block.name}: {check.message}")
        self.time = self.start_time = start_time
        starts = np.array(self._starts())
        self.states, self.samples = np.split(starts, [len(self.block.states)])
        self.modes = np.array([one.start for one in self.block.modes], dtype=int)
        self._due[:] = 0
        for sample, period in zip(self.block.samples, self._periods(), strict=True):
            if not (period > 0 and math.isfinite(period)):
                raise self._failure(sample.name, "has a period that is not positive and finite", [])
        self.event()
        self._check_finite()

    def event(self) -> None:
        """Due samples, then relations and transitions until nothing changes."""
        if len(self.samples):
            self._run_samples()
        self.update_relations()
        for _ in range(MAX_EVENT_ITERATIONS):
            if not self._run_transitions():
                return
            self.update_relations()
        if any(self._guards()):
            raise self._failure(
                "events", f"do not end: transitions still fire after {MAX_EVENT_ITERATIONS} iterations", []
            )

    def update_relations(self) -> None:
        """Evaluate the relations, each after those it depends on."""
        for index, relation in enumerate(self._relations):
            self.relations[index] = relation()[0] > 0

    def _run_samples(self) -> None:
        periods = np.array(self._periods())
        instants = self.start_time + self._due * periods
        due = instants <= self.time + INSTANT_ROUNDING * np.minimum(periods, self.step_size)
        self.update_relations()
        for rank in sorted({one.rank for one in self.block.samples}):
            chosen = due & np.array([one.rank == rank for one in self.block.samples])
            if chosen.any():
                self.samples = np.where(chosen, self._updates(), self.samples)
                self.update_relations()
        self._due += due

    def _run_transitions(self) -> bool:
        fired = [index for index, guard in enumerate(self._guards()) if guard]
        values = [(self.block.transitions[index], self._assignments[index]()) for index in reversed(fired)]
        for transition, new in values:
            for target, value in zip(transition.assign, new, strict=True):
                for group, array in (
                    (self.block.states, self.states),
                    (self.block.samples, self.samples),
                    (self.block.modes, self.modes),
                ):
                    for index, one in enumerate(group):
                        if one.symbol == target:
                            array[index] = value
        return bool(fired)

    def next_sample_time(self) -> float:
        """Instant of the next sample, infinity if the block has none."""
        if not len(self.samples):
            return math.inf
        return float(np.min(self.start_time + self._due * np.array(self._periods())))

    def advance(self, length: float) -> None:
        """One communication step of ``length`` seconds with the inputs held.

        Raises
        ------
        SimulationError
            If a value is not finite; the instance then has the state from before the step.
        """
        self._advance_to(self.time + length)

    def _advance_to(self, end: float) -> None:
        self._check_length(end - self.time)
        start = self.time
        arrays = (self.states, self.samples, self.modes, self.relations, self._due)
        saved = [one.copy() for one in arrays]
        try:
            self.event()
            while self.time < end:
                sample = self.next_sample_time()
                stop = sample if sample < end - INSTANT_ROUNDING * self.step_size else end
                self._integrate(stop)
                if stop < end:
                    self.event()
            self.update_relations()
            self._check_finite()
        except SimulationError as error:
            self.states, self.samples, self.modes, self.relations, self._due = saved
            self.time = error.time = start
            raise

    def _check_length(self, length: float) -> None:
        if length / self.step_size > MAX_SUBSTEPS:
            raise self._failure("step_size", "is too small: the step would take over a billion substeps", [])
        for sample, period in zip(self.block.samples, self._periods(), strict=True):
            if length / period > MAX_SUBSTEPS:
                problem = "has too short a period: the step would take over a billion samples"
                raise self._failure(sample.name, problem, [])

    def _integrate(self, stop: float) -> None:
        begin = self.time
        count = step_count(stop - begin, self.step_size)
        size = (stop - begin) / count
        for index in range(count):
            if index:
                self.event()
            time, start = begin + index * size, self.states
            stages: list[tuple[float, Array]] = []
            slopes: list[Array] = []
            for fraction in (0.0, 0.5, 0.5, 1.0):
                previous = slopes[-1] if slopes else np.zeros_like(start)
                stages.append((time + fraction * size, start + fraction * size * previous))
                slopes.append(self._slope(*stages[-1]))
            k1, k2, k3, k4 = slopes
            self.states = start + size / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            self.time = begin + (index + 1) * size
            if not np.isfinite(self.states).all():
                variable = self.block.states[int(np.argmin(np.isfinite(self.states)))].name
                self.states, self.time = start, time
                raise self._failure(variable, "is not finite after the step", self._failed_checks(stages))
        self.time = stop

    def _slope(self, time: float, states: Array) -> Array:
        self.time, self.states = time, states
        return np.array(self.derivatives())

    def derivatives(self) -> list[float]:
        """Derivatives of the states, of the frozen branch."""
        return self._derivatives()

    def outputs(self) -> list[float]:
        """Outputs in order of declaration; Boolean ones as 0 or 1."""
        return self._outputs()

    def indicators(self) -> list[float]:
        """Event indicators."""
        return self._indicators()

    def values(self) -> list[float]:
        """Outputs, states, samples and modes, one row of a recording."""
        return [*self.outputs(), *self.states, *self.samples, *self.modes]

    def run(self, inputs: Array, length: float) -> Array:
        """Rows of :meth:`values` over equal communication steps.

        Parameters
        ----------
        inputs : ndarray, shape (n + 1, number of inputs)
            Value of each input from each instant on.
        length : float
            Of a communication step, s.

        Returns
        -------
        ndarray, shape (n + 1, number of recorded values)
            After the events of each instant. If a step fails, the SimulationError has the rows until then
            as ``rows``.
        """
        rows: list[list[float]] = []
        begin = self.time
        try:
            for index, row in enumerate(inputs):
                if index:
                    self._advance_to(begin + index * length)  # roundings of time must not add up
                self.inputs = np.array(row, dtype=float)
                self.event()
                rows.append(self.values())
        except SimulationError as error:
            error.rows = np.array(rows)
            raise
        return np.array(rows)

    def _check_finite(self) -> None:
        for variable, value in zip(self.block.outputs, self.outputs(), strict=True):
            if not math.isfinite(value):
                raise self._failure(variable.name, "is not finite")
        for state, value in zip(self.block.states, self.derivatives(), strict=True):
            if not math.isfinite(value):
                raise self._failure(f"der({state.name})", "is not finite")

    def _failed_checks(self, points: Iterable[tuple[float, Array]]) -> list[Check]:
        """Checks that explain a failure: those that do not hold at the first finite point where one does not."""
        before = self.time, self.states
        try:
            for self.time, self.states in points:
                if not np.isfinite(self.states).all():
                    break
                failed = [one for one, held in zip(self._explanations, self._conditions(), strict=True) if not held]
                if failed:
                    return failed
            return []
        finally:
            self.time, self.states = before

    def _failure(self, variable: str, problem: str, reasons: Sequence[Check] | None = None) -> SimulationError:
        reasons = self._failed_checks([(self.time, self.states)]) if reasons is None else reasons
        hint = f": {reasons[0].message}" if reasons else ""
        return SimulationError(
            f"{self.block.name}: {variable} {problem} at t = {self.time:.9g} s{hint}",
            block=self.block.name,
            variable=variable,
            time=self.time,
            reason=reasons[0].name if reasons else "diverged",
        )
