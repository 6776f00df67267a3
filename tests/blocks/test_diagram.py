"""Diagrams: wiring, sharing, units and loops."""

import numpy as np
import pytest
import sympy as sp

import brunovsky as br
from brunovsky.blocks import Block, Diagram, Input, Output, Parameter, Sample, State, symbols
from brunovsky.errors import ModelError

u, x, k = symbols("u", "x", "k")


def gain(value: float = 2.0, unit: str = "m") -> Block:
    return Block(
        "gain",
        inputs=[Input("u", unit)],
        parameters=[Parameter("k", "1", "", value, -5.0, 5.0, tunable=True)],
        outputs=[Output("y", unit, expression=k * u)],
    )


def integrator() -> Block:
    return Block(
        "integrator",
        inputs=[Input("u", "m")],
        parameters=[Parameter("k", "1", "", 2.0, 0.0, 9.0)],
        states=[State("x", "m", derivative=u, start=k)],
        outputs=[Output("y", "m", expression=x)],
    )


def unit_delay() -> Block:
    """Two samples that shift: what comes out is what came in one period before."""
    stored, delayed = symbols("stored", "delayed")
    period = sp.Rational(1, 10)
    return Block(
        "unit_delay",
        inputs=[Input("u", "m")],
        samples=[Sample("delayed", "m", update=stored, period=period), Sample("stored", "m", update=u, period=period)],
        outputs=[Output("y", "m", expression=delayed)],
    )


def loop(**options: object) -> Diagram:
    return Diagram(
        "loop",
        components={"a": gain(), "b": integrator()},
        connections={"a.u": "b.y", "b.u": "a.y"},
        outputs={"out": "b.y"},
        **options,  # type: ignore[arg-type]
    )


def test_flat_names_and_exported_ones() -> None:
    plain = loop()
    assert [one.name for one in plain.parameters] == ["a.k", "b.k"]
    assert [one.name for one in plain.states] == ["out"]  # a state that is exported takes the exported name
    shared = loop(parameters={"gain": ["a.k", "b.k"]}, values={"gain": 3.0})
    (one,) = shared.parameters
    assert (one.name, one.value, one.minimum, one.maximum, one.tunable) == ("gain", 3.0, 0.0, 5.0, False)
    assert shared.states[0].derivative == sp.Symbol("gain", real=True) * sp.Symbol("out", real=True)


def test_a_diagram_in_a_diagram_is_the_same_model() -> None:
    inner = loop(parameters={"k": ["a.k", "b.k"]})
    outer = Diagram("outer", components={"l": inner}, outputs={"out": "l.out"}, parameters={"k": "l.k"})
    one, other = br.simulate(inner, 1.0, step_size=0.01), br.simulate(outer, 1.0, step_size=0.01)
    assert np.array_equal(one["out"], other["out"])
    assert one["out"].values[-1] == pytest.approx(2 * np.exp(2), rel=1e-7)


def test_algebraic_loop_is_refused_with_its_cycle() -> None:
    with pytest.raises(ModelError, match=r"algebraic loop: .*[ab]\.u <- [ab]\.y <- [ab]\.u") as caught:
        Diagram("ring", components={"a": gain(), "b": gain()}, connections={"a.u": "b.y", "b.u": "a.y"})
    assert "put a state or a sample between" in str(caught.value)


def test_sampled_loop_needs_a_unit_delay() -> None:
    held = symbols("held")[0]
    hold = Block(
        "hold",
        inputs=[Input("u", "m")],
        samples=[Sample("held", "m", update=u, period=sp.Rational(1, 10))],
        outputs=[Output("y", "m", expression=held)],
    )
    with pytest.raises(ModelError, match=r"the samples .* feed each other at one instant; put a unit delay between"):
        Diagram("ring", components={"a": hold, "b": hold}, connections={"a.u": "b.y", "b.u": "a.y"})


def test_unit_delay_shifts_by_one_period_and_breaks_loops() -> None:
    result = br.simulate(unit_delay(), 1.0, inputs={"u": lambda t: t}, step_size=0.1)
    assert result["delayed"].values[2:] == pytest.approx(result["time"].values[1:-1])
    held = symbols("held")[0]
    counter = Block(
        "counter",
        inputs=[Input("u", "m")],
        samples=[Sample("held", "m", update=u + 1, period=sp.Rational(1, 10))],
        outputs=[Output("y", "m", expression=held)],
    )
    ring = Diagram(
        "ring",
        components={"delay": unit_delay(), "counter": counter},
        connections={"delay.u": "counter.y", "counter.u": "delay.y"},
        outputs={"count": "counter.y"},
    )
    for engine in ("native", "numpy"):
        count = br.simulate(ring, 1.0, step_size=0.1, engine=engine)["count"].values  # type: ignore[arg-type]
        assert count == pytest.approx(np.arange(1, 12))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"connections": {"a.u": "b.y"}}, r"input 'b\.u' is not connected: connect or export it"),
        ({"connections": {"a.u": "b.y", "b.u": "c.y"}}, r"there is no output 'c\.y'; there are a\.y, b\.y"),
        ({"connections": {"a.w": "b.y", "b.u": "a.y"}}, r"there is no input 'a\.w'"),
        ({"inputs": {"u": "a.u"}}, r"input 'a\.u' is fed twice"),
        ({"outputs": {"z": "b.z"}}, r"there is no output 'b\.z'"),
        ({"parameters": {"k": "b.q"}}, r"there is no parameter 'b\.q'"),
        ({"values": {"b.q": 1.0}}, r"there is no parameter 'b\.q' to give a value to"),
        (
            {"components": {"a": gain(3.0), "b": integrator()}, "parameters": {"k": ["a.k", "b.k"]}},
            r"different defaults",
        ),
        ({"components": {"a": gain(unit="rad"), "b": integrator()}}, r"'a\.u' is in rad and 'b\.y' in m"),
    ],
)
def test_miswiring_is_refused(options: dict[str, object], message: str) -> None:
    parts = {
        "components": {"a": gain(), "b": integrator()},
        "connections": {"a.u": "b.y", "b.u": "a.y"},
        "outputs": {"out": "b.y"},
    }
    with pytest.raises(ModelError, match=message):
        Diagram("loop", **(parts | options))  # type: ignore[arg-type]


def test_boolean_outputs_drive_nothing() -> None:
    flag = Block("flag", outputs=[Output("y", "m", expression=br.blocks.TIME > 1)])
    with pytest.raises(ModelError, match=r"'f\.y' is true or false and cannot drive 'a\.u'"):
        Diagram("d", components={"f": flag, "a": gain()}, connections={"a.u": "f.y"})


def test_blocks_hash_and_compare_by_content() -> None:
    assert br.blocks.closed_loop() == br.blocks.closed_loop()
    assert hash(br.blocks.closed_loop()) == hash(br.blocks.closed_loop())
    assert br.blocks.closed_loop() != br.blocks.closed_loop(br.blocks.pole_placement())
