"""Derivatives of a block's equations: those of SymPy entry by entry, and C that any block's expressions make."""

import os
import random
import subprocess
import sys

import numpy as np
import pytest
import sympy as sp

import brunovsky as br
from brunovsky.blocks import Block, Input, Output, State, symbols
from brunovsky.fmi import shipped_block, shipped_fmus
from brunovsky.native import jacobian_source
from brunovsky.native.jacobian import columns, jacobian


@pytest.mark.parametrize("name", shipped_fmus())
def test_entries_are_the_derivatives_that_are_not_identically_zero(name: str) -> None:
    block = shipped_block(name)
    knowns, chosen = columns(block), random.Random(1)
    rows = [*(one.derivative for one in block.states), *(one.expression for one in block.outputs)]
    found = jacobian(block).equations.by_row(len(rows))
    values = {one: sp.Float(chosen.uniform(0.5, 1.5)) for one in knowns}
    values |= {one.symbol: sp.true if chosen.random() < 0.5 else sp.false for one in block.relations}
    values |= {one.symbol: sp.Integer(one.start) for one in block.modes}
    for row, expression in zip(found, rows, strict=True):
        smooth = isinstance(expression, sp.Expr)
        expected = {k: sp.diff(expression, known) for k, known in enumerate(knowns) if smooth}
        expected = {k: one for k, one in expected.items() if one != 0}
        assert row.keys() == expected.keys()
        for k, one in expected.items():
            assert float(row[k].xreplace(values)) == pytest.approx(float(one.xreplace(values)), rel=1e-12, abs=1e-12)


def test_starts_and_updates_are_differentiated_too(sampled_integrator: Block, ball: Block) -> None:
    found = jacobian(sampled_integrator)
    period, total = symbols("T", "total")
    assert columns(sampled_integrator)[-1] == total
    assert found.updates.by_row(1) == [{2: period, 3: symbols("u")[0], 4: sp.S.One}]
    assert found.starts.entries == ()
    assert jacobian(ball).starts.by_row(2) == [{0: sp.S.One}, {}]


def test_the_text_depends_on_the_block_alone() -> None:
    program = "import brunovsky as br; print(br.native.jacobian_source(br.blocks.closed_loop()))"
    texts = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.strip()
        for seed in ("1", "2")
    }
    assert texts == {jacobian_source(br.blocks.closed_loop()).strip()}


def test_mathematical_constants_are_numbers_in_c() -> None:
    x, u = symbols("x", "u")
    slope = sp.pi * 2**u + sp.E * sp.log(2) * sp.sin(x) + sp.sqrt(2) + sp.EulerGamma
    outputs = (Output("x", expression=x),)
    block = Block("constants", inputs=(Input("u"),), states=(State("x", derivative=slope),), outputs=outputs)
    native, numpy = (br.simulate(block, 0.1, engine=engine, inputs={"u": 0.3})["x"] for engine in ("native", "numpy"))
    np.testing.assert_allclose(native, numpy, rtol=1e-13)
    text = jacobian_source(block)
    assert "M_" not in text and "3.141592653589793" in text


def test_a_derivative_that_c_has_no_function_for_is_not_a_number() -> None:
    x, u = symbols("x", "u")
    block = Block("gamma", inputs=(Input("u"),), states=(State("x", derivative=u * sp.gamma(x)),))
    assert "entries[0] = c0*u[0]*NAN;" in jacobian_source(block)
    assert "entries[1] = c0;" in jacobian_source(block)
