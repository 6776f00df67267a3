"""Nominal values scale the absolute tolerance of Dormand-Prince, the same in both engines."""

import numpy as np
import pytest
import sympy as sp

import brunovsky as br
from brunovsky.blocks import Block, Output, State, Variable, symbols

SMALL = 2.0**-30  # a power of two, by which floating-point numbers scale exactly


def oscillator(unit: float, nominal: float) -> Block:
    """Van der Pol's oscillator, its states in multiples of the unit."""
    z, y = symbols("z", "y")
    slope = (1 - (z * sp.Integer(round(1 / unit))) ** 2) * y - z
    return Block(
        "oscillator",
        states=[
            State("z", derivative=y, start=sp.Float(0.5 * unit), nominal=nominal),
            State("y", derivative=slope, start=sp.Float(0.0), nominal=nominal),
        ],
        outputs=[Output("z", expression=z)],
    )


def run(block: Block, engine: str) -> np.ndarray:
    return br.simulate(block, 6.0, step_size=3.0, solver="dormand_prince", tolerance=1e-3, engine=engine)["z"].values


@pytest.mark.parametrize("engine", ["native", "numpy"])
def test_a_model_in_other_units_takes_the_same_steps(engine: str) -> None:
    reference = run(oscillator(1.0, 1.0), engine)
    scaled, wrong = (run(oscillator(SMALL, nominal), engine) / SMALL for nominal in (SMALL, 1.0))
    assert abs(scaled - reference).max() < 1e-13  # but for the rounding of a square, the same numbers
    assert abs(wrong - reference).max() > 1e-5


@pytest.mark.parametrize("nominal", [1e-3, 1.0, 50.0])
def test_engines_agree(nominal: float) -> None:
    native, numpy = (run(oscillator(1.0, nominal), engine) for engine in ("native", "numpy"))
    np.testing.assert_allclose(native, numpy, rtol=1e-12, atol=1e-12)


def test_a_large_nominal_value_admits_larger_errors() -> None:
    exact = br.simulate(oscillator(1.0, 1.0), 6.0, step_size=1e-4)["z"].values[-1]
    errors = [abs(run(oscillator(1.0, nominal), "native")[-1] - exact) for nominal in (1.0, 1e4)]
    assert errors[0] < 1e-2 < errors[1]


def test_labels_give_a_plant_its_nominal_values() -> None:
    z, u = sp.symbols("z:2", real=True), sp.Symbol("u", real=True)
    system = br.AffineSystem(z, (u,), [z[1], 0], [0, 1], (z[0],))
    labels = {
        z[0]: Variable("gap", "m", "air gap", nominal=1e-3),
        z[1]: Variable("rate", "m/s", "its rate", nominal=1e-2),
        u: Variable("force", "m/s2", "per mass", nominal=9.81),
    }
    plant = br.blocks.plant_block(system, "gap", labels=labels)
    assert [one.nominal for one in (*plant.states, *plant.inputs, *plant.outputs)] == [1e-3, 1e-2, 9.81, 1e-3, 1e-2]
    assert [one.nominal for one in plant.parameters] == [1e-3, 1e-2]
    behind = br.linearized_block(
        br.linearize(system), "behind", labels=labels, actuators=br.blocks.actuator_lags(plant.inputs, number=2)
    )
    found = {one.name: one.nominal for one in (*behind.states, *behind.outputs)}
    assert [found[name] for name in ("gap", "rate", "force", "force_command")] == [1e-3, 1e-2, 9.81, 9.81]
    assert {one.nominal for one in behind.states if "stage" in one.name} == {9.81}


def test_what_is_connected_in_the_shipped_loop_has_equal_nominal_values() -> None:
    loop = br.blocks.closed_loop()
    inputs = {f"{key}.{one.name}": one.nominal for key, part in loop.components.items() for one in part.inputs}
    outputs = {f"{key}.{one.name}": one.nominal for key, part in loop.components.items() for one in part.outputs}
    assert {target: outputs[source] for target, source in loop.connections.items()} == {
        target: inputs[target] for target in loop.connections
    }
