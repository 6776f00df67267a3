"""Values that transitions alone change: in both engines, and in a diagram."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp

import brunovsky as br
from brunovsky.blocks import Block, Diagram, Input, Mode, Output, Parameter, Sample, State, Transition, held, symbols
from brunovsky.blocks.variables import TIME


def memory() -> Block:
    """Keeps the input of the instant at which it passes ``level``; beside it a sample with a period."""
    u, kept, mode, level, count, x = symbols("u", "kept", "taken", "level", "count", "x")
    return Block(
        "memory",
        inputs=(Input("u", "m", "what is kept"),),
        parameters=(Parameter("level", "m", "where", 0.5), Parameter("kept_start", "m", "before", -1.0)),
        states=(State("x", "m", "integral", derivative=kept),),
        samples=(
            held("kept", "m", "the value kept", symbols("kept_start")[0]),
            Sample("count", "1", "samples", update=count + 1, period=sp.Rational(1, 10)),
        ),
        modes=(Mode("taken", "1", "1 after"),),
        outputs=(Output("kept", "m", "kept", kept), Output("x", "m", "x", x), Output("count", "1", "n", count)),
        transitions=(Transition("take", sp.And(sp.Eq(mode, 0), u > level), {kept: u * TIME, mode: sp.S.One}),),
    )


@pytest.mark.parametrize("solver", ["rk4", "dormand_prince"])
@pytest.mark.parametrize("engine", ["native", "numpy"])
def test_it_keeps_its_value_between_transitions(engine: str, solver: str) -> None:
    data = br.simulate(memory(), 1.0, step_size=0.01, inputs={"u": lambda t: t}, engine=engine, solver=solver)
    kept, time = data["kept"].values, data["time"].values
    taken = float(kept[-1])
    assert 0.25 < taken < 0.27
    assert set(kept) == {-1.0, taken}
    before = kept == -1.0
    assert before[time < 0.5].all() and not before[time > 0.52].any()
    assert data["count"][-1] == pytest.approx(10, abs=1)
    slope = np.diff(data["x"].values) / 0.01
    assert slope[0] == pytest.approx(-1.0) and slope[-1] == pytest.approx(taken)


def test_a_diagram_keeps_it() -> None:
    loop = Diagram("loop", components={"memory": memory()}, inputs={"u": "memory.u"}, outputs={"kept": "memory.kept"})
    assert [one.is_held for one in loop.samples] == [True, False]
    assert br.simulate(loop, 1.0, step_size=0.01, inputs={"u": 0.7})["kept"][-1] == 0.0  # taken at once, at t = 0
