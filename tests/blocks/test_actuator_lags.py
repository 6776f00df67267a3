"""Actuators that lag: the block by itself, between inner loop and plant, and where the loop loses stability."""

import numpy as np
import pytest
from gallery_blocks import linearized

import brunovsky as br
from brunovsky import analysis
from brunovsky.errors import ModelError, ParameterError

B = br.blocks
U = (B.Variable("u[1]", "m/s2", "forward"), B.Variable("u[2]", "rad/s2", "yaw"))
LINE = {"heading": 0.3, "theta_start": 0.3, "speed": 0.5, "eta_start[1]": 0.5}


@pytest.mark.parametrize("number", [1, 2])
def test_the_step_response_is_the_textbook_s(number):
    block = B.actuator_lags(U, [0.1, 0.3], number=number)
    data = br.simulate(block, 1.0, step_size=1e-3, inputs={"u_command[1]": 1.0, "u_command[2]": 2.0})
    for name, size, lag in (("u[1]", 1.0, 0.1), ("u[2]", 2.0, 0.3)):
        t = data["time"].values / lag
        expected = size * (1 - np.exp(-t) * (1 if number == 1 else 1 + t))
        np.testing.assert_allclose(data[name], expected, atol=1e-9)


def test_it_starts_at_rest_at_its_start_value():
    block = B.actuator_lags(U, 0.1, number=2)
    data = br.simulate(block, 0.5, parameters={"u_start[2]": 3.0}, inputs={"u_command[2]": 3.0})
    np.testing.assert_allclose(data["u[2]"], 3.0, rtol=1e-12)


def test_the_robot_has_the_outputs_of_the_linearized_robot_and_what_is_commanded():
    block, usual = B.robot_with_lags(number=2), B.linearized_robot()
    names = [(one.name, one.unit) for one in usual.outputs]
    assert [(one.name, one.unit) for one in block.outputs] == [*names, ("u_command[1]", "m/s2"),
                                                               ("u_command[2]", "rad/s2")]  # fmt: skip
    assert [one.name for one in block.inputs] == [one.name for one in usual.inputs]
    own = {one.name for one in block.parameters} - {one.name for one in usual.parameters}
    assert own == {"lag[1]", "lag[2]", "u_start[2]"}


def test_without_lag_it_is_the_linearized_robot():
    runs = []
    for plant in (B.robot_with_lags(0.0), B.linearized_robot()):
        loop = B.closed_loop(plant=plant, reference=B.line())
        runs.append(br.simulate(loop, 1.0, parameters=LINE | {"x_start": 0.1}))
    for name in runs[1]:
        np.testing.assert_array_equal(runs[0][name], runs[1][name])
    np.testing.assert_array_equal(runs[0]["u[2]"], runs[0]["u_command[2]"])


def test_the_plant_gets_what_acts_and_the_chains_what_is_commanded():
    loop = B.closed_loop(plant=B.robot_with_lags([0.01, 0.02]), reference=B.line())
    start = {"x_start": 0.1, "u_start[1]": 0.4, "eta_min": 0.0}
    data = br.simulate(loop, 0.5, step_size=1e-4, parameters=LINE | start)
    assert abs(data["u[1]"] - data["u_command[1]"]).max() > 0.05
    for k in (1, 2):
        change = np.gradient(data[f"eta[{k}]"].values, data["time"].values)[1:-1]
        np.testing.assert_allclose(change, data[f"u[{k}]"].values[1:-1], atol=1e-4 * abs(data[f"u[{k}]"].values).max())
        filtered = np.gradient(data[f"u[{k}]"].values, data["time"].values)[1:-1] * (0.01 * k)
        difference = (data[f"u_command[{k}]"] - data[f"u[{k}]"]).values[1:-1]
        np.testing.assert_allclose(filtered[50:], difference[50:], atol=1e-3 * abs(difference).max())
    theta, eta1, eta2, u1 = (data[name].values for name in ("theta", "eta[1]", "eta[2]", "u_command[1]"))
    np.testing.assert_allclose(data["Z2[3]"], -eta1 * eta2 * np.sin(theta) + u1 * np.cos(theta), atol=1e-9)
    assert data["u[1]"].values[0] == data["u_command[1]"].values[0] == 0.4


@pytest.mark.parametrize("number", [1, 2])
@pytest.mark.parametrize("actuator", [1, 2])
def test_stability_is_lost_at_the_margin_of_the_loop_at_this_actuator(actuator, number):
    """Independent of this block: margins come from the loop that `actuator_loop` derives by linearisation."""
    gain = analysis.sliding_gain([500, 10, 1], 5)
    found = analysis.loop_margins(analysis.actuator_loop_transfer(gain, analysis.SteadyMotion(0.5), actuator))
    limit = found.lag if number == 1 else found.two_lags
    names = {"u[1]": ("y_start", "e2[1]"), "u[2]": ("x_start", "e1[1]")}[f"u[{actuator}]"]
    lags = [0.0, 0.0]
    for factor, grows in ((0.97, False), (1.03, True)):
        lags[actuator - 1] = factor * limit
        loop = B.closed_loop(plant=B.robot_with_lags(lags, number=number), reference=B.line())
        start = {"P": 0.0, "speed": 0.5, "eta_start[1]": 0.5, names[0]: 1e-6}
        error = abs(br.simulate(loop, 12.0, parameters=start)[names[1]])
        early, late = (float(error.sel(time=slice(*part)).max()) for part in ((5, 6), (11, 12)))
        assert (late > early) == grows


def test_any_plant_may_have_them():
    linearization = linearized("manipulator")
    inputs = [B.Variable(str(one)) for one in linearization.system.inputs]
    values = dict.fromkeys(map(str, linearization.system.parameters), 1.0)
    parts = {"parameters": values}
    usual = br.linearized_block(linearization, **parts)
    block = br.linearized_block(linearization, **parts, actuators=B.actuator_lags(inputs, 1e-3))
    assert len(block.states) == len(usual.states) + len(inputs)
    target = {"target[1]": 0.2, "target[2]": 0.1}
    ends = []
    for plant in (usual, block):
        loop = B.closed_loop(B.pole_placement(plant, [[4.0, 4.0]] * 2), plant=plant, reference=B.set_point(plant))
        ends.append(br.simulate(loop, 8.0, parameters=target).isel(time=-1))
    for i in (1, 2):
        assert float(ends[1][f"Z{i}[1]"]) == pytest.approx(target[f"target[{i}]"], abs=1e-4)


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (lambda: B.robot_with_lags(-0.1), ParameterError, "time constants in s"),
        (lambda: B.robot_with_lags(np.nan), ParameterError, "time constants in s"),
        (lambda: B.robot_with_lags([0.1, 0.1, 0.1]), ModelError, "one for each"),
        (lambda: B.robot_with_lags(number=0), ModelError, "at least one"),
        (lambda: B.robot_with_lags(number=True), ModelError, "at least one"),
        (lambda: B.actuator_lags(()), ModelError, "at least one"),
        (lambda: br.simulate(B.robot_with_lags(), 0.1, parameters={"lag[1]": 0.0}), ParameterError, "lag 0"),
        (
            lambda: br.linearized_block(B.robot_linearization(), actuators=B.actuator_lags(U)),
            ModelError,
            "u_command",
        ),
        (lambda: br.linearized_block(B.robot_linearization(), actuators=B.circle()), ModelError, "u_command"),
        (lambda: br.linearized_block(B.robot_linearization(), actuators=5), ModelError, "no block"),
    ],
)
def test_bad_input_is_refused_with_a_remedy(call, kind, message):
    with pytest.raises(kind, match=message):
        call()


def test_measured_chains_behind_actuators_are_refused():
    linearization = B.robot_linearization()
    inputs = [B.Variable(str(one)) for one in linearization.system.inputs]
    with pytest.raises(ModelError, match="measured=True or actuators"):
        br.linearized_block(linearization, measured=True, actuators=B.actuator_lags(inputs))
