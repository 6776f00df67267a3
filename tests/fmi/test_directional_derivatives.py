"""Directional derivatives against differences through the FMU itself, python-control and formulas typed by hand."""

import control
import numpy as np
import pytest
from fmu_driver import OK, Driver

import brunovsky as br
from brunovsky.fmi import shipped_block, shipped_fmus

POINTS = 6


def close(found, expected, tolerance):
    """Each row to a part of its largest entry."""
    scale = 1 + np.max(np.abs(expected), axis=1, keepdims=True, initial=0)
    return bool(np.all(np.abs(found - expected) <= tolerance * scale))


SHIPPED = [one for one in shipped_fmus() if not shipped_block(one).clocks]  # clocks are for FMI 3


@pytest.fixture(params=SHIPPED)
def shipped(request, exported):
    return exported(shipped_block(request.param))


@pytest.fixture(params=[one for one in SHIPPED if one != "super_twisting"])
def exchanged(request, exported):
    """Those that model exchange takes: with the sign function super_twisting is for co-simulation."""
    return exported(shipped_block(request.param))


def random_point(instance, rng, spread):
    knowns = (*instance.states(), *instance.named("input"))
    values = {one: float(rng.normal(scale=spread)) for one in knowns}
    return values | {"time": float(rng.uniform(0, 2))}


def set_point(instance, point):
    """Values in continuous-time mode, relations as they were frozen."""
    states, inputs = instance.states(), instance.named("input")
    instance.done("SetTime", point["time"])
    instance.vector("SetContinuousStates", len(states), [point[one] for one in states])
    if inputs:
        assert instance.set({one: point[one] for one in inputs}) == OK


def go_to(instance, point):
    """The point, with the relations that belong to it, in continuous-time mode; which relations hold, by indicators."""
    set_point(instance, point)
    instance.done("EnterEventMode")
    count = instance.description.numberOfEventIndicators
    sides = tuple(one > 0 for one in instance.vector("GetEventIndicators", count)) if count else ()
    instance.done("EnterContinuousTimeMode")
    return sides


def differences(value_at, point, knowns, part=1e-6):
    """Central differences of a vector of values."""
    columns = []
    for one in knowns:
        step = part * (1 + abs(point[one]))
        ahead, behind = (value_at(point | {one: point[one] + sign * step}) for sign in (1, -1))
        columns.append((ahead - behind) / (2 * step))
    return np.array(columns).T


def test_in_model_exchange_they_are_the_differences_of_each_frozen_branch(exchanged):
    rng, branches = np.random.default_rng(3), set()
    with Driver(exchanged.folder, "ModelExchange") as instance:
        unknowns, knowns = instance.real_unknowns(), ["time", *instance.states(), *instance.named("input")]

        def value_at(point):
            set_point(instance, point)
            return np.array(instance.get(*unknowns))

        instance.initialize()
        instance.enter_continuous_time()
        for spread in np.geomspace(0.01, 3, POINTS):
            point = random_point(instance, rng, spread)
            branches.add(go_to(instance, point))
            expected = differences(value_at, point, knowns)
            set_point(instance, point)
            found = instance.jacobian(unknowns, knowns)
            assert close(found, expected, 2e-6), np.abs(found - expected).max()
            instance.done("EnterEventMode")
            assert (instance.jacobian(unknowns, knowns) == found).all()
            instance.done("EnterContinuousTimeMode")
    assert len(branches) > 1 or not exchanged.block.indicators


def test_in_event_mode_tunable_parameters_are_knowns_too(exchanged):
    tunable = [one.name for one in exchanged.block.parameters if one.tunable]
    with Driver(exchanged.folder, "ModelExchange") as instance:
        unknowns = instance.real_unknowns()

        def value_at(values):
            assert not values or instance.set(values) == OK, instance.text
            return np.array(instance.get(*unknowns))

        instance.initialize()
        instance.enter_continuous_time()
        go_to(instance, random_point(instance, np.random.default_rng(4), 1.0))
        instance.done("EnterEventMode")
        point = dict(zip(tunable, np.array(instance.get(*tunable)) * 1.01 + 1e-3, strict=True))
        expected = differences(value_at, point, tunable) if tunable else np.zeros((len(unknowns), 0))
        value_at(point)
        assert close(instance.jacobian(unknowns, tunable), expected, 2e-6)


def test_in_initialisation_mode_they_go_through_the_start_values(shipped):
    rng = np.random.default_rng(5)
    with Driver(shipped.folder) as instance:
        rows = (one.variable for one in instance.description.initialUnknowns)
        unknowns = [one.name for one in rows if one.type == "Real"]
        knowns = [one for one in (*instance.named("parameter"), *instance.named("input")) if one != "step_size"]
        assert set(instance.states()) <= set(unknowns)

        def value_at(point):
            instance.done("Reset")
            instance.done("SetupExperiment", 0, 0.0, point["time"], 0, 0.0)
            instance.done("EnterInitializationMode")
            assert not knowns or instance.set({one: point[one] for one in knowns}) == OK, instance.text
            return np.array(instance.get(*unknowns))

        starts = {one: instance.variables[one].start for one in knowns}
        for _ in range(2):
            point = {one: float(value) * 1.02 + float(rng.uniform(0.01, 0.05)) for one, value in starts.items()}
            point["time"] = float(rng.uniform(0.1, 2))
            expected = differences(value_at, point, ["time", *knowns])
            value_at(point)
            if instance.directional(unknowns, ["time"], [1.0])[0] != OK:  # the relay switches at once
                assert shipped.block.name == "sliding_mode_relay"
                assert "a transition of the first instant assigned timer[1]" in instance.text
                continue
            found = instance.jacobian(unknowns, ["time", "step_size", *knowns])
            assert not found[:, 1].any(), "nothing depends on step_size"
            assert close(np.delete(found, 1, axis=1), expected, 2e-6), np.abs(np.delete(found, 1, 1) - expected).max()


def test_they_are_the_linearisation_of_python_control(exchanged):
    if exchanged.block.samples or exchanged.block.modes:
        return  # python-control has no place for them
    system = br.to_control(exchanged.block)
    real = [index for index, one in enumerate(exchanged.block.outputs) if not one.is_boolean]
    with Driver(exchanged.folder, "ModelExchange") as instance:
        instance.initialize()
        instance.enter_continuous_time()
        point = random_point(instance, np.random.default_rng(6), 0.7) | {"time": 0.0}
        go_to(instance, point)
        states, inputs = instance.states(), [one.name for one in exchanged.block.inputs]
        found = instance.jacobian(
            [*(f"der({one})" for one in states), *(exchanged.block.outputs[k].name for k in real)], [*states, *inputs]
        )
        model = control.linearize(system, [point[k] for k in states], [point[k] for k in inputs], eps=1e-7)
        expected = np.block([[model.A, model.B], [model.C[real], model.D[real]]])
        assert close(found, np.asarray(expected), 1e-4)


def test_between_steps_they_are_the_differences_by_inputs_and_parameters(shipped):
    with Driver(shipped.folder) as instance:
        unknowns = instance.real_unknowns()
        tunable = [one.name for one in shipped.block.parameters if one.tunable]
        knowns = [*instance.named("input"), *tunable]

        def value_at(values):
            assert not values or instance.set(values) == OK
            return np.array(instance.get(*unknowns))

        instance.initialize()
        assert instance.step(0.0, 0.01) == OK
        rng = np.random.default_rng(7)
        point = {
            one: value * 1.01 + float(rng.uniform(0.1, 0.3))
            for one, value in zip(knowns, instance.get(*knowns), strict=True)
        }
        expected = differences(value_at, point, knowns) if knowns else np.zeros((len(unknowns), 0))
        value_at(point)
        assert close(instance.jacobian(unknowns, knowns), expected, 2e-6)


def test_co_simulation_and_model_exchange_agree_at_the_same_state(exchanged):
    with Driver(exchanged.folder) as stepped, Driver(exchanged.folder, "ModelExchange") as exchange:
        states, inputs = stepped.states(), stepped.named("input")
        unknowns, knowns = stepped.real_unknowns(), ["time", *states, *inputs, *stepped.named("parameter")]
        stepped.initialize()
        assert stepped.step(0.0, 0.01) == OK
        values = {one: 0.1 * index + 0.2 for index, one in enumerate(inputs)}
        assert not inputs or stepped.set(values) == OK
        found = stepped.jacobian(unknowns, knowns)
        exchange.initialize()
        exchange.enter_continuous_time()
        go_to(exchange, values | dict(zip(states, stepped.get(*states), strict=True)) | {"time": 0.01})
        assert (exchange.jacobian(unknowns, knowns) == found).all()
        assert stepped.step(0.01, 0.01) == OK
        after = stepped.jacobian(unknowns, knowns)
        assert (after != found).any() or not states
        stepped.done("Terminate")
        assert (stepped.jacobian(unknowns, knowns) == after).all()


def test_directions_add_up(loop):
    with Driver(loop.folder) as instance:
        instance.initialize()
        unknowns, knowns = instance.real_unknowns(), ["time", *instance.states(), "d[1]", "rho[2]"]
        seed = np.arange(1.0, len(knowns) + 1)
        status, found = instance.directional(unknowns, knowns, seed)
        assert status == OK
        np.testing.assert_allclose(found, instance.jacobian(unknowns, knowns) @ seed, rtol=1e-12, atol=1e-9)
        status, twice = instance.directional(unknowns, ["time", "time"], [1.0, 2.0])
        np.testing.assert_allclose(twice, 3 * instance.jacobian(unknowns, ["time"])[:, 0], rtol=1e-15)
        assert instance.directional(unknowns, [], []) == (OK, [0.0] * len(unknowns))
        assert instance.directional([], knowns, seed) == (OK, [])


@pytest.mark.parametrize("speed", [0.7, 0.02, -0.02, -0.7])
def test_inside_the_guard_the_law_has_the_guards_slope(robot, speed):
    with Driver(robot.folder) as instance:
        instance.initialize({"eta_start[1]": speed, "theta_start": 0.3})
        inverse = 1 / speed if abs(speed) > 0.05 else speed / 0.05**2
        expected = [[-np.cos(0.3) * inverse, -np.sin(0.3) * inverse]]
        np.testing.assert_allclose(instance.jacobian(["u[2]"], ["v[1]", "v[2]"]), expected, rtol=1e-14)


@pytest.mark.parametrize(("error", "inside"), [(1e-5, True), (0.5, False), (-0.5, False)])
def test_in_the_boundary_layer_the_gain_of_the_relay_is_p_over_phi(exported, error, inside):
    with Driver(exported(br.blocks.sliding_mode()).folder) as instance:
        instance.initialize({"Z1[1]": error})
        c1, c2, c3, q, p, phi = instance.get("C[1]", "C[2]", "C[3]", "Q", "P", "phi")
        gain = q + (p / phi if inside else 0)
        expected = [-gain * c1 / c3, -gain * c2 / c3 - c1 / c3, -gain - c2 / c3]
        found = instance.jacobian(["v[1]"], ["Z1[1]", "Z1[2]", "Z1[3]"])
        np.testing.assert_allclose(found, [expected], rtol=1e-13)
