"""A block as a python-control system."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import control
import numpy as np

from brunovsky.blocks import Block, NumpyEngine
from brunovsky.errors import ModelError


def to_control(block: Block) -> control.NonlinearIOSystem:
    """Python-control system of a block without modes and samples, to simulate, linearise or interconnect it.

    Parameters
    ----------
    block : Block
        Any block or diagram; Boolean outputs are 0 or 1. Start values stay with the block: pass ``X0`` to the
        simulator (``brunovsky.blocks.NumpyEngine(block)`` after ``initialize`` has them in ``states``).

    Returns
    -------
    control.NonlinearIOSystem
        Inputs, outputs, states and ``params`` with the block's names; SI units. Switching is evaluated at each call,
        not frozen: an adaptive solver sees the discontinuity. For `control.input_output_response`,
        `control.interconnect` (blocks find each other by these names) and `control.linearize`, which numbers inputs and
        outputs anew unless it is told ``copy_names=True``.

    Raises
    ------
    ModelError
        If the block has modes, samples or transitions, which python-control has no place for.
    """
    for kind in ("modes", "samples", "transitions"):
        if getattr(block, kind):
            names = ", ".join(one.name for one in getattr(block, kind))
            raise ModelError(
                f"{block.name} has {kind} ({names}), which python-control cannot hold; use brunovsky.simulate"
            )
    engine = NumpyEngine(block)

    def evaluate(what: str) -> Any:
        def call(t: float, x: Any, u: Any, params: Mapping[str, float]) -> Any:
            engine.time = t
            engine.states, engine.inputs = np.asarray(x, dtype=float), np.asarray(u, dtype=float)
            engine.parameters = np.array([params[one.name] for one in block.parameters])
            engine.update_relations()
            return np.array(getattr(engine, what)())

        return call

    return control.nlsys(
        evaluate("derivatives") if block.states else lambda t, x, u, params: np.zeros(0),
        evaluate("outputs"),
        inputs=[one.name for one in block.inputs],
        outputs=[one.name for one in block.outputs],
        states=[one.name for one in block.states],
        params=block.parameter_values(),
        name=block.name,
    )
