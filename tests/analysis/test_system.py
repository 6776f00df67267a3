"""Every shipped block as a python-control system: the same numbers, and python-control's own tools on it."""

import math

import control
import numpy as np
import pytest

import brunovsky as br
from brunovsky import analysis

SHIPPED = ["robot", "linearized_robot", "circle", "sliding_mode", "pole_placement", "closed_loop", "errors"]
ACCURATE = {"solve_ivp_kwargs": {"rtol": 1e-10, "atol": 1e-12}}
CIRCLE_START = {"x_start": 2**0.5 + 0.02, "eta_start[1]": 2**0.5 / 2, "eta_start[2]": 0.5}


def start_of(block, parameters=None):
    engine = br.blocks.NumpyEngine(block)
    engine.set_parameters(block.parameter_values(parameters))
    engine.initialize()
    return np.array(engine.states, dtype=float)


@pytest.mark.parametrize("name", SHIPPED)
def test_names_and_parameters_are_those_of_the_block(name):
    block = getattr(br.blocks, name)()
    system = br.to_control(block)
    assert isinstance(system, control.NonlinearIOSystem)
    for labels, variables in (
        (system.input_labels, block.inputs),
        (system.output_labels, block.outputs),
        (system.state_labels, block.states),
    ):
        assert labels == [one.name for one in variables]
    assert system.params == block.parameter_values() and system.name == block.name


@pytest.mark.parametrize("name", SHIPPED)
def test_response_agrees_with_native_simulation(name):
    """Smooth inputs on every channel; the native one holds them over a step of 0.1 ms, which bounds the agreement."""
    block = getattr(br.blocks, name)()
    system = br.to_control(block)
    time = np.linspace(0.0, 0.2, 21)
    signals = [lambda t, k=k: 0.3 * math.sin(t + k) for k in range(len(block.inputs))]
    values = np.array([[signal(t) for t in time] for signal in signals]).reshape(len(signals), len(time))
    response = control.input_output_response(system, time, values if signals else 0, start_of(block), **ACCURATE)
    native = br.simulate(
        block, 0.2, step_size=1e-4, inputs={one.name: s for one, s in zip(block.inputs, signals, strict=True)}
    )
    outputs = np.asarray(response.outputs).reshape(len(block.outputs), len(time))
    for row, output in zip(outputs, block.outputs, strict=True):
        expected = native[output.name].values[::100].astype(float)
        # python-control interpolates its inputs linearly between the 21 instants, the native steps hold them
        np.testing.assert_allclose(row, expected, atol=3e-4 * (1 + np.max(np.abs(expected))), err_msg=output.name)


def test_without_inputs_the_agreement_is_that_of_the_solvers():
    block = br.blocks.closed_loop(br.blocks.pole_placement())
    system = br.to_control(block)
    time = np.linspace(0.0, 0.6, 7)
    start = start_of(block, CIRCLE_START)
    response = control.input_output_response(system, time, np.zeros((2, 7)), start, **ACCURATE)
    native = br.simulate(block, 0.6, step_size=1e-4, parameters=CIRCLE_START)
    for row, output in zip(response.outputs, block.outputs, strict=True):
        expected = native[output.name].values[::1000].astype(float)
        np.testing.assert_allclose(row, expected, atol=2e-8 * (1 + np.max(np.abs(expected))), err_msg=output.name)


def test_parameters_of_a_call_reach_the_system():
    system = br.to_control(br.blocks.circle())
    at = system.output(0.0, [], [], params={"radius": 3.0, "phase": math.pi / 2})
    named = dict(zip(system.output_labels, at, strict=True))
    assert (named["Z1d[1]"], named["Z2d[1]"]) == pytest.approx((0.0, 3.0))
    usual = dict(zip(system.output_labels, system.output(0.0, [], []), strict=True))
    assert usual["Z1d[1]"] == pytest.approx(2**0.5)  # the call before left nothing behind


def test_interconnected_by_the_student_it_is_the_shipped_closed_loop():
    parts = [br.to_control(getattr(br.blocks, name)()) for name in ("circle", "sliding_mode", "linearized_robot")]
    outputs = ["x", "y", "u[2]", "S[1]"]
    # by name: circle -> controller -> robot, and the robot's chains back
    wired = control.interconnect(
        parts, inputs=["d[1]", "d[2]"], outputs=outputs, warn_duplicate=False, check_unused=False
    )
    shipped = br.to_control(br.blocks.closed_loop())
    start = start_of(br.blocks.closed_loop(), CIRCLE_START)
    time = np.linspace(0.0, 0.2, 5)
    disturbance = np.array([0.1 * np.sin(time), 0.2 * np.cos(time)])
    options = {"solve_ivp_kwargs": {"rtol": 1e-8, "atol": 1e-10}}
    ours = control.input_output_response(shipped, time, disturbance, start, **options)
    theirs = control.input_output_response(wired, time, disturbance, start, **options)
    for name in outputs:
        a, b = (one.outputs[one.output_labels.index(name)] for one in (ours, theirs))
        np.testing.assert_allclose(a, b, atol=1e-6 * (1 + np.max(np.abs(b))), err_msg=name)


def test_linearised_closed_loop_has_the_designed_poles():
    """On a circle the chains' errors are linear whatever the state: the poles follow from the errors' Jacobian."""
    block = br.blocks.closed_loop(br.blocks.pole_placement())
    system = br.to_control(block)
    on_circle = start_of(block, CIRCLE_START | {"x_start": 2**0.5})
    found = control.linearize(system, on_circle, [0.0, 0.0], t=0.0, eps=1e-7)
    turning = np.zeros((6, 6))  # the frame of the reference turns at the rate of the circle
    frame = np.eye(6)
    frame[:2, :2] = [[0.0, 1.0], [-1.0, 0.0]]
    turning[0, 1], turning[1, 0] = 0.5, -0.5
    poles = np.linalg.eigvals(frame @ found.A @ frame.T + turning)
    loop = analysis.actuator_loop([2500.0, 550.0, 15.0], analysis.steady_motion(br.blocks.circle()))
    expected = control.feedback(loop, np.eye(2)).poles()
    for one in expected:
        assert np.min(np.abs(poles - one)) < 1e-4


def test_linearised_inner_loop_is_two_chains():
    block = br.blocks.linearized_robot()
    point = [0.3, -0.2, 0.7, 0.8, 0.4, -0.1]
    whole = br.to_control(block)
    system = control.linearize(whole, point, [0.0] * 4, eps=1e-7)
    chains = analysis.chains()
    rows = [whole.output_labels.index(name) for name in chains.output_labels]
    markov = [system.C[rows] @ np.linalg.matrix_power(system.A, k) @ system.B[:, :2] for k in range(2)]
    ours = [chains.C @ np.linalg.matrix_power(chains.A, k) @ chains.B for k in range(2)]
    np.testing.assert_allclose(markov[0], ours[0], atol=1e-5)  # v reaches z'' alone, and each its own
    assert np.linalg.matrix_rank(system.B[:, :2]) == 2
    step = control.input_output_response(
        whole, [0.0, 0.05, 0.1], np.array([[2.0], [-1.0], [0.0], [0.0]]) * np.ones(3), point, **ACCURATE
    )
    first = [step.outputs[row] for row in rows]
    for chain, v in ((first[:3], 2.0), (first[3:], -1.0)):
        z, dz, ddz = (one[0] for one in chain)
        t = step.time
        np.testing.assert_allclose(chain[0], z + dz * t + ddz * t**2 / 2 + v * t**3 / 6, atol=1e-9)
        np.testing.assert_allclose(chain[2], ddz + v * t, atol=1e-8)
    np.testing.assert_allclose(ours[1][[1, 4]], np.eye(2))
