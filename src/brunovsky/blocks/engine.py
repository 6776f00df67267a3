"""A running block in plain NumPy: the readable statement of the semantics that compiled targets must reproduce.

Between events relations are frozen. At an event: due samples in the order of their rank, then relations and
transitions until nothing changes. A communication step is cut at sample instants; each piece is integrated by one of
two methods. Classical RK4 takes equal substeps no longer than ``step_size``, each of which begins with an event.
Dormand-Prince 5(4) chooses its steps by the tolerance; where a relation is no longer what it is frozen at, the step is
cut just after the change, relations and transitions are evaluated there, and it begins afresh. On the way out
relations are evaluated once more, so that outputs belong to the state reached and to the inputs of the step;
samples and transitions of that instant wait for the next step and its inputs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Literal

import numpy as np
import sympy as sp
from sympy.printing.numpy import NumPyPrinter

from brunovsky.blocks import dormand_prince
from brunovsky.blocks.block import Block
from brunovsky.blocks.variables import TIME, Check
from brunovsky.errors import ParameterError, SimulationError

MAX_EVENT_ITERATIONS = 20
MAX_SUBSTEPS = 1e9
STEP_ROUNDING = 1e-9  # a step is cut into ceil(h/step_size - STEP_ROUNDING) substeps
INSTANT_ROUNDING = 1e-6  # a sample is due this part of its period or step early, against rounding of time

CHECKED_FRACTIONS = (0.25, 0.5, 0.75, 1.0)  # of a Dormand-Prince step, where relations are compared
LOCATION = 1e-9  # part of a step, or of step_size if shorter, within which a change is located
MAX_STEPS = 100_000  # of Dormand-Prince within a time of step_size
MAX_EVENTS, CROWD = 200, 1e-3  # of Dormand-Prince within this part of step_size
LEAST_TOLERANCE, LARGEST_TOLERANCE = 1e-13, 1.0
EPSILON = float(np.finfo(float).eps)

Solver = Literal["rk4", "dormand_prince"]
SOLVERS: tuple[Solver, ...] = ("rk4", "dormand_prince")
REMEDY = "use solver RK4, a boundary layer, hysteresis or a sampled law"

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


def check_solver(solver: str, tolerance: float) -> None:
    """Refuse a method that does not exist and a tolerance that it cannot keep.

    Raises
    ------
    ParameterError
        The message has the names or the range.
    """
    if solver not in SOLVERS:
        raise ParameterError(f"there is no solver {solver!r}; use {' or '.join(map(repr, SOLVERS))}")
    if not (isinstance(tolerance, int | float) and LEAST_TOLERANCE <= tolerance <= LARGEST_TOLERANCE):
        raise ParameterError(f"tolerance = {tolerance!r} is out of its range from {LEAST_TOLERANCE:g} to 1")


class NumpyEngine:
    """A running instance of a block, evaluated by NumPy.

    Parameters
    ----------
    block : Block
        What runs.
    step_size : float
        Longest substep of RK4, s. Dormand-Prince locates events within a billionth of it at most, and gives up where it
        takes over 200 events within its thousandth part or over 100 000 steps within all of it.
    solver : {"rk4", "dormand_prince"}
        Method of integration.
    tolerance : float
        Of Dormand-Prince, 1e-13 to 1: relative error of a step; a hundredth of it is added as the absolute one, in
        the unit of each state.

    Attributes
    ----------
    time : float
        Current time, s.
    parameters, inputs, states, samples, modes, relations : ndarray
        Current values in the block's order of declaration; relations are 0 or 1.
    step_size, solver, tolerance
        As given.

    Raises
    ------
    ParameterError
        For an unknown solver, or a tolerance out of its range.
    """

    def __init__(self, block: Block, step_size: float = 1e-3, solver: Solver = "rk4", tolerance: float = 1e-6) -> None:
        check_solver(solver, tolerance)
        self.block = block
        self.step_size, self.solver, self.tolerance = step_size, solver, tolerance
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
        self._nominal = np.array([one.nominal for one in block.states], dtype=float)
        self._held = np.array([one.is_held for one in block.samples], dtype=bool)
        self._periods = self._function([sp.S.One if one.is_held else one.period for one in block.samples])
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
        self._settle()

    def _settle(self) -> None:
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
        due = self._instants(periods) <= self.time + INSTANT_ROUNDING * np.minimum(periods, self.step_size)
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
        return float(np.min(self._instants(np.array(self._periods()))))

    def _instants(self, periods: Array) -> Array:
        """When each sample is due next, s: never, where it is held."""
        return np.where(self._held, math.inf, self.start_time + self._due * periods)

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
                if self.solver == "rk4":
                    self._integrate_rk4(stop)
                else:
                    self._integrate_dormand_prince(stop)
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

    def _integrate_rk4(self, stop: float) -> None:
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
                variable = self._culprit(self.states)
                self.states, self.time = start, time
                raise self._failure(variable, "is not finite after the step", self._failed_checks(stages))
        self.time = stop

    def _integrate_dormand_prince(self, stop: float) -> None:
        window, steps, crowd, events = self.time, 0, self.time, 0
        size, growth = 0.0, dormand_prince.LARGEST_FACTOR
        first: Array | None = None
        while self.time < stop:
            time, start = self.time, self.states
            if time > window + self.step_size:
                window, steps = time, 0
            if time > crowd + CROWD * self.step_size:
                crowd, events = time, 0
            if first is None:
                first = self._first_slope()
                size = dormand_prince.first_size(
                    self._slope, time, start, first, stop - time, self.tolerance, self._nominal
                )
            last = 1.01 * size >= stop - time
            size = stop - time if last else size
            step = dormand_prince.attempt(self._slope, time, start, first, size)
            self.time, self.states = time, start
            error, steps = step.error(self.tolerance, self._nominal), steps + 1
            if not error <= 1:
                self._check_rejected(step, steps, 16 * EPSILON * max(abs(time), abs(stop)))
                size, growth = size * min(dormand_prince.factor(error), dormand_prince.SAFETY), 1.0
                continue
            fraction = self._first_change(step)
            if fraction is None or time + fraction * size >= stop:  # an event at the end is the caller's
                self.time, self.states, first = stop if last else time + size, step.end, step.slopes[-1]
                size, growth = size * min(dormand_prince.factor(error), growth), dormand_prince.LARGEST_FACTOR
            else:
                self.time, self.states, first = time + fraction * size, step.at(fraction), None
                self._settle()
                events += 1
            if steps >= MAX_STEPS:
                why = f"it is stiff or hardly stops switching; take a smaller step_size, or {REMEDY}"
                problem = f"needs over {MAX_STEPS} steps within {self.step_size:g} s: {why}"
                raise self._failure("solver", problem, [])
            if events > MAX_EVENTS:
                problem = f"do not end: over {MAX_EVENTS} within {CROWD * self.step_size:g} s; {REMEDY}"
                raise self._failure("events", problem, [])

    def _first_slope(self) -> Array:
        slopes = np.array(self.derivatives())
        if not np.isfinite(slopes).all():
            raise self._failure(f"der({self._culprit(slopes)})", "is not finite")
        return slopes

    def _culprit(self, values: Array) -> str:
        return self.block.states[int(np.argmin(np.isfinite(values)))].name

    def _check_rejected(self, step: dormand_prince.Step, steps: int, smallest: float) -> None:
        """Error if a rejected step cannot be followed by a smaller one."""
        if step.size > smallest and steps < MAX_STEPS:
            return
        reasons = self._failed_checks(step.points)
        if not np.isfinite(step.end).all():
            raise self._failure(self._culprit(step.end), "is not finite after the step", reasons)
        raise self._failure("solver", f"finds no step that keeps the tolerance of {self.tolerance:g}", reasons)

    def _first_change(self, step: dormand_prince.Step) -> float | None:
        """Part of a step just after which relations first differ from what they are frozen at, None if nowhere."""
        if not self.block.acting_relations:
            return None
        before = 0.0
        for after in CHECKED_FRACTIONS:
            if self._differs(step, after):
                break
            before = after
        else:
            return None
        width = (LOCATION * min(self.step_size, step.size) + 4 * EPSILON * abs(self.time)) / step.size
        while after - before > width:
            middle = 0.5 * (before + after)
            if not before < middle < after:
                break
            before, after = (before, middle) if self._differs(step, middle) else (middle, after)
        return after

    def _differs(self, step: dormand_prince.Step, fraction: float) -> bool:
        time, states, frozen = self.time, self.states, self.relations.copy()
        self.time, self.states = time + fraction * step.size, step.at(fraction)
        self.update_relations()
        acting = len(self.block.acting_relations)
        differs = bool((self.relations[:acting] != frozen[:acting]).any())
        self.time, self.states, self.relations = time, states, frozen
        return differs

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
