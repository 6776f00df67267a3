"""Co-simulation: the numbers of the native engine, whatever else happens in the process."""

import ctypes

import fmpy
import numpy as np
import pytest
from fmu_driver import ERROR, OK, Driver

from brunovsky.blocks import library
from brunovsky.native import NativeEngine


def _fmu_run(instance, steps, length, inputs, values=None):
    """Outputs after initialisation and after each step; inputs change at every communication point."""
    instance.initialize(values)
    rows = [instance.outputs()]
    for index in range(steps):
        if inputs:
            assert instance.set({name: signal(index * length) for name, signal in inputs.items()}) == OK
        assert instance.step(index * length, length) == OK, instance.text
        rows.append(instance.outputs())
    return rows


def _engine_run(block, steps, length, inputs, values=None):
    engine = NativeEngine(block)
    engine.set_parameters(values or {})
    engine.initialize()
    names = [one.name for one in block.inputs]
    rows = [engine.outputs()]
    for index in range(steps):
        for name, signal in inputs.items():
            engine.inputs[names.index(name)] = signal(index * length)
        engine.time = index * length
        engine.advance(length)
        rows.append(engine.outputs())
    return rows


CASES = {
    "linearized_robot": (
        library.linearized_robot,
        {"v[1]": np.sin, "v[2]": np.cos},
        {"u_start[1]": 0.3, "rho[2]": 0.9},
    ),
    "closed_loop": (library.closed_loop, {"d[1]": lambda t: 0.2, "d[2]": lambda t: 0.1 * t}, {"phi": 0.1}),
    "sampled_integrator": (None, {"u": np.cos}, {"T": 0.07}),
    "zoo": (None, {"u": lambda t: 1 + np.sin(9 * t)}, {"gain": 0.7}),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("length", [0.01, 0.0137, 0.0004])
def test_same_numbers_as_the_native_engine(name, length, exported, request):
    make, inputs, values = CASES[name]
    block = make() if make else request.getfixturevalue(name)
    with Driver(exported(block).folder) as instance:
        found = _fmu_run(instance, 60, length, inputs, values)
    expected = _engine_run(block, 60, length, inputs, values)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


def test_bouncing_ball_and_relay_are_those_of_the_engine(ball, relay, exported):
    for block in (ball, relay):
        with Driver(exported(block).folder) as instance:
            np.testing.assert_array_equal(_fmu_run(instance, 200, 0.01, {}), _engine_run(block, 200, 0.01, {}))


def test_fifty_interleaved_instances_do_not_disturb_each_other(robot):
    jerks = np.linspace(-1, 1, 50)
    alone = []
    for jerk in jerks:
        with Driver(robot.folder) as instance:
            alone.append(_fmu_run(instance, 10, 0.01, {"v[1]": lambda t, jerk=jerk: jerk})[-1])
    together = [Driver(robot.folder, name=f"robot {index}".encode()) for index in range(50)]
    for one in together:
        one.initialize()
    for index in range(10):
        for one, jerk in zip(together, jerks, strict=True):
            assert one.set({"v[1]": jerk}) == OK
            assert one.step(index * 0.01, 0.01) == OK
    assert [one.outputs() for one in together] == alone
    assert len({tuple(one) for one in alone}) == 50
    for one in together:
        one.library.fmi2FreeInstance(one.handle)


def test_an_error_in_one_instance_leaves_another_alone(robot):
    with Driver(robot.folder) as good, Driver(robot.folder) as bad:
        good.initialize()
        bad.initialize()
        assert good.step(0.0, 0.01) == OK
        assert bad.step(5.0, 0.01) == ERROR
        assert good.messages == []
        assert good.step(0.01, 0.01) == OK


def test_reset_and_run_again_gives_the_same(loop):
    with Driver(loop.folder) as instance:
        first = _fmu_run(instance, 50, 0.01, {"d[1]": np.sin}, {"P": 1.0})
        instance.done("Reset")
        changed = _fmu_run(instance, 50, 0.01, {"d[1]": np.sin})
        instance.done("Terminate")
        instance.done("Reset")
        again = _fmu_run(instance, 50, 0.01, {"d[1]": np.sin}, {"P": 1.0})
    assert first == again
    assert first[-1] != changed[-1]


def test_time_of_the_master_may_round_differently(robot):
    with Driver(robot.folder) as summed, Driver(robot.folder) as counted:
        summed.initialize()
        counted.initialize()
        time = 0.0
        for index in range(20000):
            assert summed.step(time, 1e-4) == OK, summed.text
            assert counted.step(index * 1e-4, 1e-4) == OK, counted.text
            time += 1e-4
        np.testing.assert_allclose(summed.outputs(), counted.outputs(), atol=1e-9)


def test_outputs_follow_the_inputs_set_at_a_communication_point(exported):
    controller = exported(library.sliding_mode())
    with Driver(controller.folder) as instance:
        instance.initialize()
        assert instance.get("v[1]") == [0.0]
        assert instance.set({"Z1[3]": 1.0}) == OK
        (v,) = instance.get("v[1]")
        assert v == -5.0 - 2.5 - 10.0, "the saturated branch of S = 1; the linear one would be -65"
        assert instance.step(0.0, 0.01) == OK
        assert instance.get("v[1]") == [v]


def test_reading_does_not_change_the_run(zoo, exported):
    folder = exported(zoo).folder
    with Driver(folder) as read, Driver(folder) as unread:
        read.initialize()
        unread.initialize()
        for index in range(40):
            for one in (read, unread):
                assert one.set({"u": 1 + np.sin(index)}) == OK
            read.outputs()
            read.get("der(x)", "held", "hidden")
            assert read.step(index * 0.03, 0.03) == OK
            assert unread.step(index * 0.03, 0.03) == OK
        assert read.outputs() == unread.outputs()


def test_initialization_mode_computes_from_the_parameters_and_inputs_of_the_moment(robot):
    with Driver(robot.folder) as instance:
        instance.done("SetupExperiment", 0, 0.0, 2.0, 0, 0.0)
        instance.done("EnterInitializationMode")
        assert instance.get("time", "x", "Z2[2]", "u[2]") == [2.0, 0.0, 1.0, 0.0]
        assert instance.set({"x_start": 3.0, "eta_start[1]": 2.0}) == OK
        assert instance.get("x", "Z2[2]", "der(y)") == [3.0, 2.0, 2.0]
        assert instance.set({"v[1]": 4.0}) == OK
        assert instance.get("u[2]") == [-2.0]
        instance.done("ExitInitializationMode")
        assert instance.get("x", "u[2]") == [3.0, -2.0]


def test_step_size_sets_the_internal_step(robot):
    runs = []
    for size in (0.02, 0.01, 1e-4):
        with Driver(robot.folder) as instance:
            values = {"step_size": size, "eta_start[2]": 2.0, "u_start[1]": 1.0}
            runs.append(_fmu_run(instance, 10, 0.1, {"v[1]": np.cos}, values)[-1])
    errors = [np.max(np.abs(np.subtract(one, runs[-1]))) for one in runs[:2]]
    assert errors[1] > 0
    assert 12 < errors[0] / errors[1] < 20, "classical Runge-Kutta is of order 4"


def test_tunable_parameters_change_between_steps(robot):
    with Driver(robot.folder) as instance:
        instance.initialize({"u_start[1]": 1.0})
        assert instance.set({"rho[1]": 2.0}) == OK
        assert instance.get("der(eta[1])") == [2.0]
        assert instance.step(0.0, 0.1) == OK
        assert instance.get("eta[1]") == [pytest.approx(1.2)]


def test_a_step_of_no_length_does_nothing_and_says_so(robot):
    with Driver(robot.folder) as instance:
        instance.initialize()
        before = instance.outputs()
        assert instance.step(0.0, 0.0) == OK
        assert "logStatusWarning fmi2DoStep: a communication step of 0 s at t = 0 s does nothing" in instance.text
        assert instance.outputs() == before
        assert instance.step(0.0, 0.01) == OK


def test_status_functions_answer_for_the_last_step(robot):
    with Driver(robot.folder) as instance:
        instance.initialize()
        status, time, terminated, text = ctypes.c_int(9), ctypes.c_double(), ctypes.c_int(9), ctypes.c_char_p()
        assert instance.step(0.0, 0.25) == OK
        instance.done("GetStatus", 0, ctypes.byref(status))
        instance.done("GetRealStatus", 2, ctypes.byref(time))
        instance.done("GetBooleanStatus", 3, ctypes.byref(terminated))
        instance.done("GetStringStatus", 1, ctypes.byref(text))
        assert (status.value, time.value, terminated.value, text.value) == (OK, 0.25, 0, b"")
        assert instance.step(0.0, 0.25) == ERROR
        instance.done("GetStatus", 0, ctypes.byref(status))
        assert status.value == ERROR


def _state(instance):
    state = ctypes.c_void_p()
    instance.done("GetFMUstate", ctypes.byref(state))
    return state


def test_a_stored_state_continues_exactly_as_before(zoo, exported):
    with Driver(exported(zoo).folder) as instance:
        instance.initialize({"gain": 1.5})
        for index in range(13):
            assert instance.step(index * 0.03, 0.03) == OK
        state = _state(instance)

        def rest():
            rows = []
            for index in range(13, 30):
                assert instance.set({"u": 1 + np.sin(index)}) == OK
                assert instance.step(index * 0.03, 0.03) == OK, instance.text
                rows.append(instance.outputs())
            return rows

        first = rest()
        instance.done("Terminate")
        instance.done("SetFMUstate", state)
        assert rest() == first
        instance.done("Reset")
        instance.done("SetFMUstate", state)
        assert rest() == first
        instance.done("FreeFMUstate", ctypes.byref(state))
        assert state.value is None
        instance.done("FreeFMUstate", ctypes.byref(state))


def test_a_serialized_state_moves_to_another_instance(zoo, exported):
    folder = exported(zoo).folder
    with Driver(folder) as first, Driver(folder, name=b"two") as second:
        first.initialize({"x_start": 0.25})
        assert first.step(0.0, 0.35) == OK
        state, size, copy = _state(first), ctypes.c_size_t(), ctypes.c_void_p()
        first.done("SerializedFMUstateSize", state, ctypes.byref(size))
        data = ctypes.create_string_buffer(size.value)
        first.done("SerializeFMUstate", state, data, size)
        second.done("DeSerializeFMUstate", data, size, ctypes.byref(copy))
        second.done("SetFMUstate", copy)
        assert second.outputs() == first.outputs()
        assert second.step(0.35, 0.1) == first.step(0.35, 0.1) == OK
        assert second.outputs() == first.outputs()
        first.done("FreeFMUstate", ctypes.byref(state))
        second.done("FreeFMUstate", ctypes.byref(copy))


def test_fmpy_runs_the_closed_loop_onto_its_circle(loop):
    result = fmpy.simulate_fmu(str(loop.fmu), fmi_type="CoSimulation", stop_time=5)
    radius = np.hypot(result["x"], result["y"])
    assert radius[0] == 2.5
    assert abs(radius[-1] - 2**0.5) < 1e-3
    assert not result["singular"].any()
