"""A running block in compiled code, with the interface of :class:`brunovsky.blocks.NumpyEngine`."""

from __future__ import annotations

import ctypes
import weakref
from collections.abc import Mapping
from typing import Any

import numpy as np

from brunovsky.blocks import Block
from brunovsky.blocks.engine import SOLVERS, Solver, check_solver
from brunovsky.errors import ParameterError, SimulationError
from brunovsky.native.library import load_library

Array = np.ndarray[Any, np.dtype[np.float64]]


def _view(name: str, group: str, kind: type = float) -> property:
    """Property for a vector of the C engine: a view of its memory, set element by element."""

    def read(self: NativeEngine) -> Any:
        count = len(getattr(self.block, group))
        pointer = getattr(self._engine.contents, name)
        return np.ctypeslib.as_array(pointer, (count,)) if count else np.empty(0, kind)

    def write(self: NativeEngine, values: Any) -> None:
        read(self)[:] = values

    return property(read, write, doc=f"Current {group}, a view of the engine's memory.")


class NativeEngine:
    """A running instance of a block in compiled code.

    Parameters
    ----------
    block : Block
        Compiled on first use, then taken from the cache.
    step_size, solver, tolerance
        As those of :class:`brunovsky.blocks.NumpyEngine`.

    Raises
    ------
    ParameterError
        For an unknown solver, or a tolerance out of its range.
    CompilerError
        If there is no C compiler or it fails.
    """

    parameters = _view("p", "parameters")
    inputs = _view("u", "inputs")
    states = _view("x", "states")
    samples = _view("q", "samples")
    modes = _view("m", "modes", int)
    relations = _view("r", "relations", int)

    def __init__(self, block: Block, step_size: float = 1e-3, solver: Solver = "rk4", tolerance: float = 1e-6) -> None:
        check_solver(solver, tolerance)
        self.block = block
        library = load_library(block)
        self._library = library
        model = ctypes.addressof(ctypes.c_char.in_dll(library, "brunovsky_model"))
        self._engine = library.engine_new(model, step_size)
        if not self._engine:
            raise MemoryError(f"no memory for an instance of {block.name}")
        weakref.finalize(self, library.engine_free, self._engine)
        self._engine.contents.solver = SOLVERS.index(solver) + 1
        self._engine.contents.tolerance = tolerance

    @property
    def time(self) -> float:
        """Current time, s."""
        return float(self._engine.contents.time)

    @time.setter
    def time(self, value: float) -> None:
        self._engine.contents.time = value

    @property
    def step_size(self) -> float:
        """Longest substep of RK4, s."""
        return float(self._engine.contents.step_size)

    @step_size.setter
    def step_size(self, value: float) -> None:
        self._engine.contents.step_size = value

    def reset(self) -> None:
        """Back to default parameters and inputs, before initialisation."""
        self._library.engine_reset(self._engine)

    def set_parameters(self, values: Mapping[str, float]) -> None:
        """Replace parameters by name; ParameterError if unknown, not finite or out of range."""
        current = {one.name: float(value) for one, value in zip(self.block.parameters, self.parameters, strict=True)}
        self.parameters = list(self.block.parameter_values(current | dict(values)).values())

    def initialize(self, start_time: float = 0.0, *, model_exchange: bool = False) -> None:
        """Start values, then the events of the first instant.

        Raises
        ------
        ParameterError
            If the parameters violate a check of the block.
        SimulationError
            If an output or derivative is not finite.
        """
        names = dict(zip((one.name for one in self.block.parameters), map(float, self.parameters), strict=True))
        whens = ("start", "model exchange") if model_exchange else ("start",)
        for check in self.block.failed_checks(names, *whens):
            raise ParameterError(f"{self.block.name}: {check.message}")
        self._done(self._library.engine_start(self._engine, start_time, model_exchange))

    def event(self) -> None:
        """Due samples, then relations and transitions until nothing changes."""
        self._done(self._library.engine_event(self._engine))

    def update_relations(self) -> None:
        """Evaluate the relations, each after those it depends on."""
        self._library.engine_relations(self._engine)

    def next_sample_time(self) -> float:
        """Instant of the next sample, infinity if the block has none."""
        return float(self._library.engine_next_sample(self._engine))

    def advance(self, length: float) -> None:
        """One communication step; on failure SimulationError, and the state from before it."""
        self._done(self._library.engine_advance(self._engine, length))

    def outputs(self) -> list[float]:
        """Outputs in order of declaration; Boolean ones as 0 or 1."""
        self._library.engine_outputs(self._engine)
        return list(self._engine.contents.y[: len(self.block.outputs)])

    def derivatives(self) -> list[float]:
        """Derivatives of the states, of the frozen branch."""
        return self._vector("derivatives", len(self.block.states))

    def indicators(self) -> list[float]:
        """Event indicators."""
        return self._vector("indicators", len(self.block.indicators))

    def _vector(self, name: str, count: int) -> list[float]:
        values = np.empty(count)
        getattr(self._library, f"engine_{name}")(self._engine, values.ctypes.data)
        return [float(one) for one in values]

    def run(self, inputs: Array, length: float) -> Array:
        """Rows of outputs, states, samples and modes over equal steps; as :meth:`NumpyEngine.run`."""
        block = self.block
        table = np.ascontiguousarray(inputs, dtype=float)
        width = len(block.outputs) + len(block.states) + len(block.samples) + len(block.modes)
        rows = np.empty((len(table), width))
        count = self._library.engine_run(self._engine, len(table) - 1, length, table.ctypes.data, rows.ctypes.data)
        if count < len(table):
            error = self._failure()
            error.rows = rows[:count]
            raise error
        return rows

    def _done(self, status: int) -> None:
        if status:
            raise self._failure()

    def _failure(self) -> SimulationError:
        engine = self._engine.contents
        return SimulationError(
            engine.message.decode(),
            block=self.block.name,
            variable=engine.variable.decode(),
            time=engine.time,
            reason=engine.reason.decode(),
        )
