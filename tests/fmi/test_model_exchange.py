"""Model exchange: states, events and their times, under fmpy's solvers and call by call."""

import ctypes
import math

import fmpy
import numpy as np
import pytest
import sympy as sp
from fmu_driver import DISCARD, ERROR, OK, Driver

from brunovsky.blocks import TIME, Block, Input, Output, Parameter, State, library, symbols
from brunovsky.native import simulate


def _simulate(fmu, stop, **options):
    return fmpy.simulate_fmu(str(fmu), fmi_type="ModelExchange", stop_time=stop, record_events=False, **options)


def _continuous(instance, time, states):
    instance.done("SetTime", time)
    instance.vector("SetContinuousStates", len(states), list(states))


def _complete(instance):
    event, terminate = ctypes.c_int(9), ctypes.c_int(9)
    instance.done("CompletedIntegratorStep", 1, ctypes.byref(event), ctypes.byref(terminate))
    assert terminate.value == 0
    return bool(event.value)


def test_cvode_gives_the_trajectory_of_the_native_simulation(loop):
    found = _simulate(loop.fmu, 3.0, output_interval=0.01, relative_tolerance=1e-9)
    expected = simulate(loop.block, 3.0, step_size=1e-4)
    for name in ("x", "y", "theta", "eta[1]", "e1[1]"):
        np.testing.assert_allclose(found[name], expected[name].values[::100], atol=1e-5, err_msg=name)


def test_forward_euler_converges_with_order_one(robot):
    inputs = {"v[1]": 0.3, "v[2]": -0.4, "d[1]": 0.1, "d[2]": 0.2}
    signal = np.array(
        [(0.0, *inputs.values()), (1.0, *inputs.values())], dtype=[("time", float), *((one, float) for one in inputs)]
    )
    expected = float(simulate(robot.block, 1.0, inputs=inputs)["x"][-1])
    errors = []
    for size in (0.01, 0.005):  # fmpy's Euler makes one step an output interval
        result = _simulate(robot.fmu, 1.0, solver="Euler", step_size=size, output_interval=size, input=signal)
        errors.append(abs(result["x"][-1] - expected))
    assert 1.8 < errors[0] / errors[1] < 2.2


def test_a_relay_with_hysteresis_switches_at_its_limits(relay, exported):
    result = _simulate(exported(relay).fmu, 2.0, output_interval=0.01)
    since = (result["time"] - 0.15) % 0.4
    down = result["time"] < 0.15
    expected = np.where(down, 0.05 - result["time"], np.where(since < 0.2, -0.1 + since, 0.3 - since))
    np.testing.assert_allclose(result["x"], expected, atol=1e-6)
    assert set(result["u"]) == {-1.0, 1.0}


def test_a_bouncing_ball_bounces_when_it_should(ball, exported):
    result = _simulate(exported(ball).fmu, 1.0, output_interval=0.01, relative_tolerance=1e-8)
    g, e = 9.81, 0.7
    first = math.sqrt(2 / g)
    after = result["time"] - first
    velocity = e * math.sqrt(2 * g)
    assert 2 * velocity / g > 1.0 - first, "only one bounce until the end"
    expected = np.where(after < 0, 1 - g * result["time"] ** 2 / 2, velocity * after - g * after**2 / 2)
    np.testing.assert_allclose(result["height"], expected, atol=1e-5)


def test_a_ball_resets_its_velocity_and_says_so(ball, exported):
    with Driver(exported(ball).folder, "ModelExchange") as instance:
        instance.initialize()
        info = instance.enter_continuous_time()
        assert not info.valuesOfContinuousStatesChanged and not info.nextEventTimeDefined
        _continuous(instance, 0.5, [-1e-9, -4.0])
        instance.done("EnterEventMode")
        info = instance.new_discrete_states()
        assert info.valuesOfContinuousStatesChanged and not info.newDiscreteStatesNeeded
        assert instance.vector("GetContinuousStates", 2) == [-1e-9, 2.8]
        assert not instance.new_discrete_states().valuesOfContinuousStatesChanged


def test_samples_fall_at_their_instants(sampled_integrator, exported):
    signal = np.array([(0.0, 2.0), (1.0, 2.0)], dtype=[("time", float), ("u", float)])
    result = _simulate(
        exported(sampled_integrator).fmu, 1.0, output_interval=0.005, input=signal, start_values={"T": 0.05}
    )
    between = np.abs(result["time"] / 0.05 - np.round(result["time"] / 0.05)) > 1e-3
    count = np.floor(result["time"] / 0.05) + 1
    np.testing.assert_allclose(result["total"][between], 2.0 * 0.05 * count[between], atol=1e-12)


def test_time_events_are_announced(sampled_integrator, exported):
    with Driver(exported(sampled_integrator).folder, "ModelExchange") as instance:
        instance.initialize({"T": 0.25}, start=1.0)
        info = instance.enter_continuous_time()
        assert (info.nextEventTimeDefined, info.nextEventTime) == (1, 1.25)
        _continuous(instance, 1.25, [0.0])
        instance.done("EnterEventMode")
        assert instance.set({"u": 3.0}) == OK
        assert instance.new_discrete_states().nextEventTime == 1.5
        assert instance.get("total") == [0.75]


def test_relations_are_frozen_between_events(robot):
    with Driver(robot.folder, "ModelExchange") as instance:
        instance.initialize({"eta_min": 0.5})
        instance.enter_continuous_time()
        states = instance.vector("GetContinuousStates", 6)
        assert instance.set({"v[1]": 1.0}) == OK
        inside = [*states[:3], 0.25, *states[4:]]
        _continuous(instance, 0.1, inside)
        assert instance.get("u[2]") == [-4.0], "the exact law still"
        assert instance.get("singular") == [0]
        assert _complete(instance), "a solver that stepped over the crossing is told"
        instance.done("EnterEventMode")
        instance.new_discrete_states()
        assert instance.get("u[2]") == [-1.0], "the guarded law"
        assert instance.get("singular") == [1]
        instance.done("EnterContinuousTimeMode")
        assert not _complete(instance)


def test_indicators_are_those_of_the_contract(robot):
    with Driver(robot.folder, "ModelExchange") as instance:
        instance.initialize({"eta_start[1]": 0.75, "eta_min": 0.25})
        instance.enter_continuous_time()
        assert instance.vector("GetEventIndicators", 2) == pytest.approx([0.5, 1.0], abs=1e-9)


def test_a_crossing_that_a_solver_hits_exactly_is_not_missed(exported):
    x = symbols("x")[0]
    switched = Block(
        "switched",
        "integrator switched on at t = 1 s",
        states=(State("x", "m", "integrator", derivative=sp.Piecewise((1, TIME > 1), (0, True))),),
        outputs=(Output("x", "m", "integrator", x),),
    )
    result = _simulate(exported(switched).fmu, 2.0, output_interval=0.5)
    assert result["x"][-1] == pytest.approx(1.0, abs=1e-6)
    with Driver(exported(switched).folder, "ModelExchange") as instance:
        instance.initialize()
        instance.enter_continuous_time()
        signs = []
        for time in (0.0, 1.0, 1.0 + 1e-9):
            instance.done("SetTime", time)
            signs.append(np.sign(instance.vector("GetEventIndicators", 1)[0]))
        assert signs == [-1, -1, 1], "at the crossing itself the relation has not changed yet, so no event is due"


def test_a_start_on_a_crossing_is_found_at_the_next_completed_step(exported):
    x, x_start = symbols("x", "x_start")
    block = Block(
        "edge",
        "leaves x = 0 upwards, then faster",
        parameters=(Parameter("x_start", "m", "start"),),
        states=(State("x", "m", "state", derivative=sp.Piecewise((2, x > 0), (1, True)), start=x_start),),
        outputs=(Output("x", "m", "state", x),),
    )
    with Driver(exported(block).folder, "ModelExchange") as instance:
        instance.initialize()
        instance.enter_continuous_time()
        assert instance.vector("GetEventIndicators", 1) == [0.0]
        assert instance.vector("GetDerivatives", 1) == [1.0]
        _continuous(instance, 0.1, [0.1])
        assert _complete(instance)
        instance.done("EnterEventMode")
        instance.enter_continuous_time()
        assert instance.vector("GetDerivatives", 1) == [2.0]


def test_derivatives_that_are_not_finite_are_a_discard(robot):
    with Driver(robot.folder, "ModelExchange") as instance:
        instance.initialize({"eta_min": 0.0})
        instance.enter_continuous_time()
        assert instance.set({"v[1]": 1.0}) == OK
        _continuous(instance, 0.1, [0, 0, 0, 0.0, 0, 0])
        values = (ctypes.c_double * 6)()
        assert instance.call("GetDerivatives", values, ctypes.c_size_t(6)) == DISCARD
        assert "logStatusDiscard fmi2GetDerivatives: linearized_robot: u[2] is not finite at t = 0.1 s" in instance.text
        assert "singular at eta[1] = 0" in instance.text
        _continuous(instance, 0.1, [0, 0, 0, 0.5, 0, 0])
        assert instance.vector("GetDerivatives", 6)[4] == -2.0


def test_a_tunable_parameter_changes_at_events_only(loop):
    with Driver(loop.folder, "ModelExchange") as instance:
        instance.initialize()
        instance.new_discrete_states()
        assert instance.set({"rho[1]": 0.5}) == OK
        instance.done("EnterContinuousTimeMode")
        assert instance.get("rho[1]") == [0.5]
        assert instance.set({"rho[1]": 0.9}) == ERROR
        assert "rho[1] is a parameter and cannot be set in continuous-time mode, but in event mode" in instance.text
        assert instance.get("rho[1]") == [0.5]


def test_states_may_be_set_as_variables_as_casadi_does(robot):
    with Driver(robot.folder, "ModelExchange") as instance:
        instance.initialize()
        instance.done("EnterEventMode")
        assert instance.set({"eta[1]": 0.0}) == OK
        assert instance.get("singular") == [1], "in event mode relations follow"
        instance.enter_continuous_time()
        assert instance.set({"x": 3.0, "eta[1]": 0.5, "v[1]": 1.0}) == OK
        assert instance.vector("GetContinuousStates", 6) == [3.0, 0, 0, 0.5, 0, 0]
        assert instance.get("der(y)", "singular") == [0.5, 1]
        assert instance.set({"x": math.nan}) == ERROR
        assert instance.set({"Z1[1]": 1.0}) == ERROR, "an output of another name, though equal to x"


def test_states_without_bounds_have_nominals(robot):
    with Driver(robot.folder, "ModelExchange") as instance:
        assert instance.vector("GetNominalsOfContinuousStates", 6) == [1.0] * 6


def test_nominal_values_are_those_of_the_states(exported):
    states = [State("x", "m", nominal=1e-6), State("y", "m"), State("z", "m", nominal=250)]
    with Driver(exported(Block("nominal", states=states)).folder, "ModelExchange") as instance:
        assert instance.vector("GetNominalsOfContinuousStates", 3) == [1e-6, 1.0, 250.0]


def test_a_stored_state_restores_the_mode_and_the_frozen_relations(robot):
    with Driver(robot.folder, "ModelExchange") as instance:
        instance.initialize({"eta_min": 0.5})
        instance.enter_continuous_time()
        assert instance.set({"v[1]": 1.0}) == OK
        _continuous(instance, 0.1, [0, 0, 0, 0.25, 0, 0])
        state = ctypes.c_void_p()
        instance.done("GetFMUstate", ctypes.byref(state))
        instance.done("EnterEventMode")
        instance.new_discrete_states()
        assert instance.get("u[2]") == [-1.0]
        instance.done("SetFMUstate", state)
        assert instance.get("u[2]", "time") == [-4.0, 0.1]
        instance.done("EnterEventMode")
        instance.done("FreeFMUstate", ctypes.byref(state))


def test_events_are_logged_where_asked_for(ball, exported):
    with Driver(exported(ball).folder, "ModelExchange") as instance:
        category = (ctypes.c_char_p * 1)(b"logEvents")
        instance.done("SetDebugLogging", 1, ctypes.c_size_t(1), category)
        instance.initialize()
        instance.enter_continuous_time()
        _continuous(instance, 0.5, [-1e-9, -4.0])
        instance.done("EnterEventMode")
        instance.new_discrete_states()
        assert instance.text == "logEvents event at t = 0.5 s changed continuous states"
        category[0] = b"logNothing"
        assert instance.call("SetDebugLogging", 1, ctypes.c_size_t(1), category) == ERROR
        assert "there is no log category 'logNothing'" in instance.text


def test_a_block_without_states_runs_under_cvode(exported):
    circle = exported(library.circle())
    result = _simulate(circle.fmu, 2.0, output_interval=0.5)
    np.testing.assert_allclose(result["Z1d[1]"], math.sqrt(2) * np.cos(0.5 * result["time"]), atol=1e-12)


def test_a_chattering_law_is_refused_before_it_starts(loop):
    for values, refused in (({"phi": 0.0}, True), ({"phi": 0.0, "P": 0.0}, False)):
        with Driver(loop.folder, "ModelExchange") as instance:
            instance.done("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
            instance.done("EnterInitializationMode")
            assert instance.set(values) == OK
            assert instance.call("ExitInitializationMode") == (ERROR if refused else OK)
            assert ("set phi > 0, or P = 0, or use co-simulation" in instance.text) == refused
    with Driver(loop.folder) as instance:
        instance.initialize({"phi": 0.0})
        assert instance.step(0.0, 0.01) == OK


def test_a_check_that_a_tuned_parameter_breaks_is_due_at_the_event(loop):
    with Driver(loop.folder, "ModelExchange") as instance:
        instance.initialize()
        instance.new_discrete_states()
        assert instance.set({"phi": 0.0}) == OK
        info = ctypes.create_string_buffer(64)
        assert instance.call("NewDiscreteStates", info) == ERROR
        assert "phi = 0" in instance.text
        assert instance.call("EnterContinuousTimeMode") == ERROR
        assert instance.set({"P": 0.0}) == OK, "the order of setting them does not matter"
        instance.enter_continuous_time()


def test_inputs_change_in_continuous_time(exported):
    x, u = symbols("x", "u")
    block = Block(
        "lag",
        "first-order lag",
        inputs=(Input("u", "m", "input"),),
        states=(State("x", "m", "state", derivative=u - x),),
        outputs=(Output("x", "m", "state", x), Output("rate", "m/s", "rate", u - x)),
    )
    with Driver(exported(block).folder, "ModelExchange") as instance:
        instance.initialize()
        instance.enter_continuous_time()
        assert instance.set({"u": 2.0}) == OK
        assert instance.get("rate", "der(x)") == [2.0, 2.0]
        assert instance.vector("GetDerivatives", 1) == [2.0]
