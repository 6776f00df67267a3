"""Experiments of a block, run by the native engine as a master of co-simulation runs the FMU.

All parameters and starts have their default values. Times and the communication step are those of the default
experiment. Inputs are set at the beginning of each step and held.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

from brunovsky.blocks import Block
from brunovsky.errors import ParameterError, SimulationError
from brunovsky.fmi.definitions import COMMUNICATION_STEP, STOP_TIME
from brunovsky.native import NativeEngine

STEPS, STEPS_PER_ROW = round(STOP_TIME / COMMUNICATION_STEP), 10
_RISE = 0.1
"""Of the last input's ramp, in nominal values."""

_CLOCKS = "when its clocks tick is up to the importer, and the format of experiments cannot say it"


@dataclass(frozen=True)
class Experiment:
    """What is run.

    Parameters
    ----------
    name, description : str
        For people; the name is that of its files too.
    ramps : mapping of str to (float, float)
        Values of each input at start and stop, on a straight line between; inputs that are not named keep their start.
    """

    name: str
    description: str
    ramps: Mapping[str, tuple[float, float]]


@dataclass(frozen=True)
class Run:
    """What came of an experiment.

    Parameters
    ----------
    experiment : Experiment
        What was run.
    times : tuple of float
        Instants of the rows, s.
    rows : tuple of tuple of float
        Outputs in the order of the block, Boolean ones as 0 or 1.
    failure : str
        Why there are no rows; empty where there are.
    """

    experiment: Experiment
    times: tuple[float, ...] = ()
    rows: tuple[tuple[float, ...], ...] = ()
    failure: str = ""


def experiments(block: Block) -> tuple[Experiment, ...]:
    """The default experiment; and where there are inputs, one in which each rises at a rate of its own."""
    default = Experiment("default", "default experiment, inputs at their start values", {})
    if not block.inputs:
        return (default,)
    count = len(block.inputs)
    ramps = {
        one.name: (one.start, one.start + _RISE * one.nominal * number / count)
        for number, one in enumerate(block.inputs, 1)
    }
    return (default, Experiment("ramps", "each input rises on a straight line, each at another rate", ramps))


@lru_cache(maxsize=64)
def runs(block: Block) -> tuple[Run, ...]:
    """Runs of all experiments of a block; one that ends before its time says why and has no rows.

    Raises
    ------
    CompilerError
        If there is no C compiler or it fails.
    """
    if block.clocks:
        return tuple(Run(one, failure=_CLOCKS) for one in experiments(block))
    return tuple(_run(block, one) for one in experiments(block))


def _run(block: Block, experiment: Experiment) -> Run:
    engine = NativeEngine(block)
    starts = [experiment.ramps.get(one.name, (one.start, one.start)) for one in block.inputs]
    times, rows = [], []
    try:
        for step in range(STEPS + 1):
            if step:
                engine.advance(COMMUNICATION_STEP)
            else:
                engine.inputs = [first for first, _ in starts]
                engine.initialize()
            if step % STEPS_PER_ROW == 0:
                times.append(step * COMMUNICATION_STEP)
                rows.append(tuple(engine.outputs()))
            engine.inputs = [first + (last - first) * step / STEPS for first, last in starts]
    except (ParameterError, SimulationError) as error:
        return Run(experiment, failure=str(error))
    return Run(experiment, tuple(times), tuple(rows))
