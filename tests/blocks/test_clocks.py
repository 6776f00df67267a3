"""Clocks: what they do to samples, in diagrams too, and what is refused."""

import numpy as np
import pytest
import sympy as sp

import brunovsky as br
from brunovsky.blocks import Block, Clock, Diagram, Input, Output, Parameter, Sample, State, symbols
from brunovsky.errors import ModelError, ParameterError

x, u, h, held = symbols("x", "u", "h", "held")


def holder(**sampling: object) -> Block:
    """Samples its input and integrates what it holds; ``sampling`` replaces the clock."""
    options = sampling or {"clock": "tick"}
    return Block(
        "holder",
        inputs=[Input("u", "m")],
        parameters=[Parameter("h", "s", "period", 0.07, 1e-3)],
        states=[State("x", "m.s", derivative=held)],
        samples=[Sample("held", "m", update=u + x, **options)],  # type: ignore[arg-type]
        clocks=[Clock("tick", "when u is sampled", h)] if not sampling else [],
        outputs=[Output("y", "m", expression=held)],
    )


@pytest.mark.parametrize("engine", ["numpy", "native"])
def test_samples_of_a_clock_are_those_of_its_period(engine: str) -> None:
    for values in ({}, {"h": 0.11}):
        one, other = (
            br.simulate(block, 1.0, step_size=0.01, inputs={"u": 1.0}, parameters=values, engine=engine)
            for block in (holder(), holder(period=h))
        )
        assert np.array_equal(one["y"], other["y"]) and np.array_equal(one["x"], other["x"])
        instants = np.flatnonzero(np.diff(one["y"].values)) + 1
        expected = np.arange(1, len(instants) + 1) * round(100 * values.get("h", 0.07))
        assert list(instants) == list(expected) and len(instants) >= 9


def test_a_clock_is_shown() -> None:
    block = holder()
    assert block.clocks == (Clock("tick", "when u is sampled", h),)
    assert block.samples[0].period == h and block.periods == (h,)
    assert "1 clocks" in repr(block)
    (row,) = [line for line in block.table().splitlines() if line.startswith("| tick")]
    assert [cell.strip() for cell in row.strip("|").split("|")] == ["tick", "clock", "s", "h", "when u is sampled"]


def test_periods_are_numbers_too() -> None:
    for period in (0.1, sp.Rational(1, 10), np.float64(0.1)):
        block = Block("timer", samples=[Sample("s", clock="c")], clocks=[Clock("c", period=period)])
        assert float(block.samples[0].period) == 0.1
    assert Block("timer", samples=[Sample("s")]).samples[0].period == 1


def test_a_block_can_be_made_again_from_its_parts() -> None:
    block = holder()
    assert Block(**{key: getattr(block, key) for key in Block.__dataclass_fields__}) == block


def test_clocks_of_a_diagram_keep_their_samples() -> None:
    loop = Diagram(
        "pair",
        components={"a": holder(), "b": holder()},
        connections={"b.u": "a.y"},
        inputs={"u": "a.u"},
        outputs={"y": "b.y"},
        parameters={"period": "a.h"},
        values={"b.h": 0.2},
    )
    assert [(one.name, str(one.period)) for one in loop.clocks] == [("a.tick", "period"), ("b.tick", "b.h")]
    assert [(one.name, one.clock, one.rank) for one in loop.samples] == [("a.held", "a.tick", 0), ("y", "b.tick", 1)]
    assert [str(one.period) for one in loop.samples] == ["period", "b.h"]
    outer = Diagram("outer", components={"c": loop}, inputs={"u": "c.u"})
    assert [(one.name, one.clock) for one in outer.samples] == [("c.a.held", "c.a.tick"), ("c.y", "c.b.tick")]


TUNABLE = Parameter("h", "s", "", 0.1, 1e-3, tunable=True)
SAMPLE, OTHER = Sample("s", clock="c"), Sample("q", clock="d")


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"samples": [SAMPLE]}, r"sample 's' has no clock 'c'; there is none"),
        ({"samples": [SAMPLE, OTHER], "clocks": [Clock("c")]}, r"sample 'q' has no clock 'd'; there is c"),
        ({"clocks": [Clock("c")]}, r"the clock 'c' has no samples; write Sample\(…, clock='c'\), or leave it out"),
        (
            {"samples": [Sample("s", period=sp.S(2), clock="c")], "clocks": [Clock("c")]},
            r"sample 's' has the clock 'c' and the period 2 as well; leave the period out",
        ),
        (
            {"samples": [SAMPLE], "clocks": [Clock("c", period=h)], "parameters": [TUNABLE]},
            r"period of clock 'c' is the tunable parameter 'h'; a period must be fixed",
        ),
        (
            {"samples": [SAMPLE], "clocks": [Clock("c", period=h)], "parameters": [Parameter("h", "s")]},
            r"period of clock 'c' is 0 s; it must be positive",
        ),
        (
            {"samples": [SAMPLE], "clocks": [Clock("c", period=-1.0)]},
            r"period of clock 'c' is -1 s; it must be positive",
        ),
        ({"samples": [SAMPLE], "clocks": [Clock("c", period=sp.oo)]}, r"is inf s; it must be positive and finite"),
        ({"samples": [SAMPLE], "clocks": [Clock("c", period=sp.nan)]}, r"is nan s; it must be positive and finite"),
        ({"samples": [SAMPLE], "clocks": [Clock("c", period=sp.I)]}, r"is I, not a positive number"),
        ({"samples": [SAMPLE], "clocks": [Clock("c", period=True)]}, r"is True, not a positive number"),
        ({"samples": [SAMPLE], "clocks": [Clock("c", period=None)]}, r"is None, not a positive number"),
        ({"samples": [SAMPLE], "clocks": [Clock("c", period="2 s")]}, r"is '2 s', not a positive number"),
        (
            {"samples": [SAMPLE], "clocks": [Clock("c", period=h)]},
            r"is h, not a positive number or the symbol of a par",
        ),
        (
            {"samples": [SAMPLE], "clocks": [Clock("c", period=2 * h)], "parameters": [Parameter("h", "s", "", 1.0)]},
            r"is 2\*h, not a positive number or the symbol of a parameter",
        ),
        ({"samples": [SAMPLE, Sample("c")], "clocks": [Clock("c")]}, r"'c' and 'c' share a name"),
        ({"samples": [SAMPLE], "clocks": [Clock("c"), Clock("c")]}, r"'c' and 'c' share a name"),
        ({"samples": [SAMPLE], "clocks": [Clock("c d")]}, r"'c d' is not a legal variable name"),
        ({"samples": [SAMPLE], "clocks": Clock("c")}, r"clocks must be a sequence; write clocks=\[Clock"),
        ({"samples": [SAMPLE], "clocks": [Sample("c")]}, r"clocks must be made of Clock"),
    ],
)
def test_what_no_importer_could_tick_is_refused(parts: dict[str, object], message: str) -> None:
    with pytest.raises(ModelError, match=message):
        Block("bad", **parts)  # type: ignore[arg-type]


@pytest.mark.parametrize("value", [0, -1.0, float("inf"), float("nan"), "1", None, True])
def test_nominal_values_are_positive(value: object) -> None:
    for parts in (
        {"inputs": [Input("a", nominal=value)]},  # type: ignore[arg-type]
        {"states": [State("a", nominal=value)]},  # type: ignore[arg-type]
        {"outputs": [Output("a", nominal=value)]},  # type: ignore[arg-type]
    ):
        with pytest.raises(ParameterError, match="nominal value of 'a' is"):
            Block("bad", **parts)  # type: ignore[arg-type]


def test_a_relation_that_only_samples_read_is_no_state_event() -> None:
    block = Block(
        "mixed",
        inputs=(Input("u"),),
        states=(State("x", derivative=sp.sign(x - 1) + held),),
        samples=(Sample("held", update=sp.sign(u) * sp.Abs(x), period=sp.Rational(1, 10)),),
        outputs=(Output("held", expression=held),),
    )
    assert block.indicators == (x - 1,)
    assert len(block.relations) > len(block.acting_relations)
    assert block.relations[: len(block.acting_relations)] == block.acting_relations
    assert br.blocks.library.sliding_mode_sampled().indicators == ()
    options = {"step_size": 0.25, "inputs": {"u": np.cos}, "solver": "dormand_prince"}
    found, plain = (br.simulate(block, 5.0, engine=engine, **options) for engine in ("native", "numpy"))
    np.testing.assert_allclose(found["x"], plain["x"], rtol=1e-12, atol=1e-12)
    assert float(found["held"].max() - found["held"].min()) > 1
