"""The parameter `solver` of co-simulation: Dormand-Prince with the experiment's tolerance, as the native engine."""

import ctypes
import math

import numpy as np
import pytest
from fmu_driver import ERROR, OK, Driver

from brunovsky.blocks import library
from brunovsky.native import NativeEngine

DORMAND_PRINCE = 2


def _initialize(instance, values=None, tolerance=None):
    instance.done("SetupExperiment", int(tolerance is not None), tolerance or 0.0, 0.0, 0, 0.0)
    instance.done("EnterInitializationMode")
    assert instance.set({"solver": DORMAND_PRINCE}) == OK, instance.text
    if values:
        assert instance.set(values) == OK, instance.text
    instance.done("ExitInitializationMode")


def _engine(block, values=None, tolerance=1e-6):
    engine = NativeEngine(block, 1e-3, "dormand_prince", tolerance)
    engine.set_parameters(values or {})
    engine.initialize()
    return engine


@pytest.mark.parametrize("tolerance", [None, 1e-4, 1e-9])
@pytest.mark.parametrize("length", [1e-6, 0.0137, 0.5, 10.0])
@pytest.mark.parametrize("name", ["linearized_robot", "closed_loop", "zoo", "relay", "sampled_integrator"])
def test_same_numbers_as_the_native_engine(name, length, tolerance, exported, request):
    block = getattr(library, name)() if hasattr(library, name) else request.getfixturevalue(name)
    engine = _engine(block, tolerance=tolerance or 1e-6)
    with Driver(exported(block).folder) as instance:
        _initialize(instance, tolerance=tolerance)
        assert instance.get("solver") == [DORMAND_PRINCE]
        for index in range(min(20, max(1, round(10 / length)))):
            engine.time = index * length
            engine.advance(length)
            assert instance.step(index * length, length) == OK, instance.text
            np.testing.assert_allclose(instance.outputs(), engine.outputs(), rtol=1e-12, atol=1e-12)


def test_the_tolerance_of_the_experiment_decides(loop):
    ends = []
    for tolerance in (1e-3, 1e-6, 1e-9, 1e-11):
        with Driver(loop.folder) as instance:
            _initialize(instance, tolerance=tolerance)
            assert instance.step(0.0, 2.0) == OK
            ends.append(instance.get("x")[0])
    errors = np.abs(np.subtract(ends[:3], ends[3]))
    assert errors[0] > 10 * errors[1] > 100 * errors[2]


def test_reset_goes_back_to_rk4_and_the_default_tolerance(loop):
    with Driver(loop.folder) as instance:
        _initialize(instance, tolerance=1e-3)
        instance.done("Reset")
        assert instance.call("SetupExperiment", 0, 0.0, 0.0, 0, 0.0) == OK
        instance.done("EnterInitializationMode")
        assert instance.get("solver") == [1]
        instance.done("ExitInitializationMode")
        assert instance.step(0.0, 0.1) == OK
        first = instance.outputs()
    engine = NativeEngine(loop.block)
    engine.initialize()
    engine.advance(0.1)
    np.testing.assert_allclose(first, engine.outputs(), rtol=0, atol=1e-12)


@pytest.mark.parametrize("tolerance", [-1.0, 0.0, 1e-20, 2.0, math.inf, math.nan])
def test_a_tolerance_that_cannot_be_kept_is_refused_where_it_is_used(robot, tolerance):
    with Driver(robot.folder) as instance:
        instance.done("SetupExperiment", 1, tolerance, 0.0, 0, 0.0)
        instance.done("EnterInitializationMode")
        assert instance.set({"solver": DORMAND_PRINCE}) == OK
        assert instance.call("ExitInitializationMode") == ERROR
        assert "out of the range of this solver, from 1e-13 to 1" in instance.text
        assert instance.set({"solver": 1}) == OK, "RK4 does without"
        instance.done("ExitInitializationMode")
        assert instance.step(0.0, 0.1) == OK


def test_the_sign_function_is_an_error_that_keeps_the_state(loop):
    with Driver(loop.folder) as instance:
        _initialize(instance, {"phi": 0.0})
        assert instance.step(0.0, 0.3) == OK
        before = instance.outputs()
        assert instance.step(0.3, 0.3) == ERROR
        assert "events do not end" in instance.text and "use solver RK4, a boundary layer" in instance.text
        assert instance.outputs() == before
        assert instance.set({"phi": 0.05}) == OK
        assert instance.step(0.3, 0.3) == OK, instance.text


def test_reading_and_restoring_do_not_change_the_run(zoo, exported):
    folder = exported(zoo).folder
    with Driver(folder) as read, Driver(folder) as unread:
        for one in (read, unread):
            _initialize(one, tolerance=1e-5)
        for index in range(30):
            for value in (5.0, 1 + math.sin(index)):
                assert read.set({"u": value}) == OK
                read.outputs()
            assert unread.set({"u": 1 + math.sin(index)}) == OK
            state = ctypes.c_void_p()
            read.done("GetFMUstate", ctypes.byref(state))
            assert read.step(index * 0.07, 0.07) == OK
            read.done("SetFMUstate", state)
            read.done("FreeFMUstate", ctypes.byref(state))
            assert read.get("solver") == [DORMAND_PRINCE]
            assert read.step(index * 0.07, 0.07) == unread.step(index * 0.07, 0.07) == OK
            assert read.outputs() == unread.outputs()


def test_the_solver_does_not_matter_to_model_exchange(robot):
    with Driver(robot.folder, "ModelExchange") as instance:
        instance.done("SetupExperiment", 1, -1.0, 0.0, 0, 0.0)
        instance.done("EnterInitializationMode")
        assert instance.set({"solver": DORMAND_PRINCE}) == OK
        instance.done("ExitInitializationMode")
