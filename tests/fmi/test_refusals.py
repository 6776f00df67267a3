"""Bad input: each has an error status and one line that names what and where, and leaves the instance usable."""

import ctypes
import dataclasses
import math

import pytest
import sympy as sp
from fmu_driver import DISCARD, ERROR, FUNCTIONS, OK, Driver

from brunovsky.blocks import Block, Check, Mode, Output, Parameter, Transition, library, symbols
from brunovsky.errors import ModelError
from brunovsky.fmi import component, export_fmu


@pytest.fixture
def instance(robot):
    with Driver(robot.folder) as one:
        yield one


@pytest.fixture
def exchange(robot):
    with Driver(robot.folder, "ModelExchange") as one:
        yield one


def _usable(instance):
    instance.done("Reset")
    instance.initialize()
    assert instance.step(0.0, 0.01) == OK


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("name", ["x_start", "rho[1]", "v[2]", "step_size"])
def test_values_that_are_not_finite_are_named(instance, name, value):
    assert instance.set({name: value}) == ERROR
    assert f"logStatusError fmi2SetReal: {name} cannot be set to {value:g}" in instance.text.replace("-nan", "nan")
    assert len(instance.messages) == 1
    _usable(instance)


def test_nothing_is_set_if_one_value_is_bad(instance):
    instance.initialize()
    assert instance.set({"v[1]": 5.0, "rho[1]": 3.0, "v[2]": math.nan}) == ERROR
    assert instance.get("v[1]", "rho[1]", "v[2]") == [0.0, 1.0, 0.0]
    assert instance.step(0.0, 0.01) == OK


def test_states_and_time_of_model_exchange_must_be_finite(exchange):
    exchange.initialize()
    exchange.enter_continuous_time()
    values = (ctypes.c_double * 6)(0, 0, math.nan, 1, 0, 0)
    assert exchange.call("SetContinuousStates", values, ctypes.c_size_t(6)) == ERROR
    assert "state theta cannot be set to nan" in exchange.text.replace("-nan", "nan")
    assert exchange.vector("GetContinuousStates", 6) == [0, 0, 0, 1, 0, 0]
    assert exchange.call("SetTime", math.inf) == ERROR
    assert exchange.get("time") == [0.0]


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("rho[1]", -0.1, "rho[1] = -0.1 is out of its range from 0 to inf"),
        ("eta_min", -1.0, "eta_min = -1 is out of its range from 0 to inf"),
        ("step_size", 0.0, "step_size = 0 is out of its range from 1e-09"),
        ("step_size", -1.0, "step_size = -1 is out of its range from 1e-09"),
        ("solver", 3, "solver = 3 is out of its range from 1 to 2"),
        ("solver", 0, "solver = 0 is out of its range from 1 to 2"),
        ("x", 1.0, "x is calculated and cannot be set"),
        ("der(x)", 1.0, "der(x) is calculated and cannot be set"),
        ("singular", 1, "singular is calculated and cannot be set"),
        ("time", 1.0, "time is the independent variable"),
    ],
)
def test_values_out_of_range_and_calculated_variables_are_refused(instance, name, value, text):
    assert instance.set({name: value}) == ERROR
    assert text in instance.text
    _usable(instance)


@pytest.mark.parametrize("name", ["x_start", "step_size", "solver"])
def test_fixed_parameters_are_fixed_after_initialisation(instance, name):
    assert instance.set({name: 1}) == OK
    instance.done("Reset")
    instance.initialize()
    assert instance.set({name: 1}) == ERROR
    assert (
        f"{name} is a fixed parameter and cannot be set while the instance is between communication steps"
        in instance.text
    )


@pytest.mark.parametrize("reference", [10**6, 2**32 - 1])
def test_unknown_value_references_are_named(instance, reference):
    instance.initialize()
    vector, values = (ctypes.c_uint * 1)(reference), (ctypes.c_double * 1)()
    for function in ("GetReal", "SetReal"):
        assert instance.call(function, vector, ctypes.c_size_t(1), values) == ERROR
        assert f"there is no variable with value reference {reference}" in instance.text


def test_there_are_no_strings(instance):
    instance.initialize()
    assert instance.call("GetString", None, ctypes.c_size_t(0), None) == OK
    vector, values = (ctypes.c_uint * 1)(0), (ctypes.c_char_p * 1)()
    for function in ("GetString", "SetString"):
        assert instance.call(function, vector, ctypes.c_size_t(1), values) == ERROR
        assert "no variables of type String" in instance.text


def test_a_singular_start_names_the_singularity_and_can_be_corrected(instance, exchange):
    for one in (instance, exchange):
        one.done("SetupExperiment", 0, 0.0, 0.0, 0, 0.0)
        one.done("EnterInitializationMode")
        assert one.set({"eta_start[1]": 0.0, "eta_min": 0.0}) == OK
        assert one.status_of_get("x") == ERROR
        assert one.call("ExitInitializationMode") == ERROR
        assert one.text == (
            "logStatusError fmi2ExitInitializationMode: linearized_robot: u[2] is not finite at t = 0 s: "
            "the linearising law is singular at eta[1] = 0; start away from it or set eta_min > 0"
        )
        assert one.set({"eta_min": 0.05}) == OK
        assert one.get("singular") == [1]
        one.done("ExitInitializationMode")


def test_a_step_into_the_singularity_fails_with_the_state_intact(instance):
    # dyadic numbers: the internal step of 2**-9 s meets eta[1] = 0 exactly
    instance.initialize({"eta_min": 0.0, "eta_start[1]": 1.0, "u_start[1]": -1.0, "step_size": 2.0**-9})
    assert instance.step(0.0, 0.5) == OK
    before = instance.outputs()
    assert before[3] == 0.5
    assert instance.step(0.5, 0.5) == ERROR
    assert len(instance.messages) == 1
    assert "fmi2DoStep: linearized_robot: " in instance.text
    assert "is not finite" in instance.text
    assert "at t = 0.998046875 s: " in instance.text, "the internal step that failed"
    assert "singular at eta[1] = 0" in instance.text
    assert instance.outputs() == before
    assert instance.get("time") == [0.5]
    assert instance.step(0.5, 0.25) == OK, "a shorter step may be tried"


@pytest.mark.parametrize(
    ("time", "length", "text"),
    [
        (0.5, 0.1, "the communication point is t = 0.5 s, but the instance is at t = 0 s"),
        (0.0, -0.1, "a communication step of -0.1 s from t = 0 s is not a finite step forward"),
        (0.0, math.nan, "is not a finite step forward"),
        (0.0, math.inf, "is not a finite step forward"),
        (math.nan, 0.1, "is not a finite step forward"),
        (0.0, 1e7, "the step would take over a billion substeps"),
        (0.0, 1e300, "the step would take over a billion substeps"),
    ],
)
def test_steps_that_cannot_be_made(instance, time, length, text):
    instance.initialize()
    assert instance.step(time, length) == ERROR
    assert text in instance.text.replace("-nan", "nan")
    assert instance.step(0.0, 0.01) == OK


def test_no_step_passes_the_stop_time(instance):
    instance.initialize(stop=0.3)
    for index in range(3):
        assert instance.step(index * 0.1, 0.1) == OK, "rounding may not matter"
    assert instance.step(0.3, 0.1) == ERROR
    assert "passes the stop time, 0.3 s" in instance.text


@pytest.mark.parametrize(("start", "stop"), [(math.nan, 1.0), (math.inf, 1.0), (1.0, 0.5), (0.0, math.nan)])
def test_an_experiment_needs_finite_times_in_order(instance, start, stop):
    assert instance.call("SetupExperiment", 0, 0.0, start, 1, stop) == ERROR
    assert "has no length" in instance.text
    _usable(instance)


def test_a_tuned_parameter_that_breaks_a_check_fails_the_step(loop):
    with Driver(loop.folder) as one:
        one.initialize()
        assert one.set({"C[3]": 0.0}) == OK
        assert one.status_of_get("v[1]") == ERROR
        assert one.step(0.0, 0.01) == ERROR
        assert "C[3] = 0 leaves v out of the surface" in one.text
        assert one.set({"C[3]": 2.0}) == OK
        assert one.step(0.0, 0.01) == OK


def test_events_without_end_are_an_error(exported):
    mode = symbols("mode")[0]
    block = Block(
        "endless",
        modes=(Mode("mode", "1", "flips", 1),),
        outputs=(Output("y", "1", "mode", 2 * mode),),
        transitions=(Transition("flip", sp.true, {mode: -mode}),),
    )
    with Driver(exported(block).folder) as one:
        one.done("EnterInitializationMode")
        assert one.call("ExitInitializationMode") == ERROR
        assert "endless: events do not end: transitions still fire after 20 iterations" in one.text


def test_a_period_of_nothing_is_an_error(sampled_integrator, exported):
    period = Parameter("T", "s", "period", 0.03, -1.0)
    with Driver(exported(dataclasses.replace(sampled_integrator, name="idle", parameters=(period,))).folder) as one:
        one.done("EnterInitializationMode")
        assert one.set({"T": 0.0}) == OK
        assert one.call("ExitInitializationMode") == ERROR
        assert "total has a period that is not positive and finite" in one.text


@pytest.mark.parametrize(
    ("period", "text"),
    [
        (0.5, "step_size is too small: the step would take over a billion substeps"),
        (1e-5, "total has too short a period: the step would take over a billion samples"),
    ],
)
def test_a_step_that_would_not_end_is_refused_where_there_are_samples_too(sampled_integrator, exported, period, text):
    with Driver(exported(sampled_integrator).folder) as one:
        one.initialize({"T": period, "step_size": 0.5})
        assert one.step(0.0, 1e12 * period) == ERROR
        assert text in one.text


def test_a_failure_near_the_singularity_that_has_another_cause_does_not_blame_it(instance):
    instance.initialize({"eta_start[1]": 0.0})
    assert instance.step(0.0, 1e12) == ERROR
    assert instance.text.endswith("the step would take over a billion substeps at t = 0 s")


def test_null_pointers_are_refused(instance):
    instance.initialize()
    one = ctypes.c_size_t(1)
    reference = (ctypes.c_uint * 1)(0)
    for function, arguments in {
        "GetReal": (None, one, None),
        "SetReal": (reference, one, None),
        "GetBoolean": (reference, one, None),
        "GetFMUstate": (None,),
        "SetFMUstate": (None,),
        "SerializedFMUstateSize": (None, None),
        "GetRealStatus": (2, None),
        "SetDebugLogging": (1, one, None),
    }.items():
        assert instance.call(function, *arguments) == ERROR, function
        assert instance.text == f"logStatusError fmi2{function}: an argument is a null pointer"
    assert instance.step(0.0, 0.01) == OK


def test_functions_of_no_instance_are_errors(instance):
    instance.library.fmi2FreeInstance(None)
    zeros = [ctypes.c_size_t(0)] * 6
    for function in FUNCTIONS:
        if function not in {"GetTypesPlatform", "GetVersion", "Instantiate", "FreeInstance"}:
            assert getattr(instance.library, f"fmi2{function}")(None, *zeros) == ERROR, function


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"guid": "{0}"}, "the token is {0}, but this binary has {"),
        ({"name": b""}, "the instance has no name"),
        ({"name": None}, "the instance has no name"),
    ],
)
def test_an_instance_needs_a_name_and_the_right_guid(robot, options, text):
    with Driver(robot.folder, **options) as one:
        assert not one.handle
        assert text in one.text
        assert one.call("DoStep", 0.0, 0.1, 1) == ERROR


def test_what_is_not_provided_says_so(instance):
    instance.initialize()
    assert instance.call("CancelStep") == ERROR
    assert "no step to cancel" in instance.text
    value = ctypes.c_double()
    for function, kind, text in (
        ("GetStatus", 1, "only fmi2DoStepStatus is a status"),
        ("GetRealStatus", 3, "only fmi2LastSuccessfulTime is a Real status"),
        ("GetIntegerStatus", 0, "there is no Integer status"),
        ("GetBooleanStatus", 2, "only fmi2Terminated is a Boolean status"),
        ("GetStringStatus", 0, "only fmi2PendingStatus is a String status"),
    ):
        assert instance.call(function, kind, ctypes.byref(value)) == DISCARD
        assert text in instance.text


def test_wrong_numbers_of_states_are_refused(exchange):
    exchange.initialize()
    exchange.enter_continuous_time()
    values = (ctypes.c_double * 9)()
    for function, what in {
        "SetContinuousStates": "7 continuous states were given or asked for, but there are 6",
        "GetContinuousStates": "7 continuous states",
        "GetDerivatives": "7 derivatives",
        "GetEventIndicators": "7 event indicators were given or asked for, but there are 2",
    }.items():
        assert exchange.call(function, values, ctypes.c_size_t(7)) == ERROR
        assert what in exchange.text


def _serialized(instance):
    state, size = ctypes.c_void_p(), ctypes.c_size_t()
    instance.done("GetFMUstate", ctypes.byref(state))
    instance.done("SerializedFMUstateSize", state, ctypes.byref(size))
    data = ctypes.create_string_buffer(size.value)
    instance.done("SerializeFMUstate", state, data, size)
    assert instance.call("SerializeFMUstate", state, data, ctypes.c_size_t(size.value - 1)) == ERROR
    instance.done("FreeFMUstate", ctypes.byref(state))
    return data.raw


@pytest.mark.parametrize(
    ("position", "text"),
    [
        (0, "the state is not one of this FMU ("),  # magic
        (20, "the state is not one of this FMU ("),  # token
        (96, "the state is not one of this FMU ("),  # version
        (64, "the state is damaged: its check sum does not match"),  # check sum
        (72, "the state is damaged: it has "),  # length
        (80, "the state is damaged: its check sum does not match"),
        (200, "the state is damaged: its check sum does not match"),
        (-1, "the state is damaged: its check sum does not match"),
    ],
)
def test_a_damaged_state_is_refused(instance, position, text):
    instance.initialize()
    data = bytearray(_serialized(instance))
    data[position] ^= 1
    state = ctypes.c_void_p()
    assert instance.call("DeSerializeFMUstate", bytes(data), ctypes.c_size_t(len(data)), ctypes.byref(state)) == ERROR
    assert f"DeSerializeFMUstate: {text}" in instance.text
    assert state.value is None
    assert instance.step(0.0, 0.01) == OK


@pytest.mark.parametrize("length", [0, 10, -1])
def test_a_truncated_state_is_refused(instance, length):
    instance.initialize()
    data, state = _serialized(instance)[:length], ctypes.c_void_p()
    assert instance.call("DeSerializeFMUstate", data, ctypes.c_size_t(len(data)), ctypes.byref(state)) == ERROR
    assert "DeSerializeFMUstate: the state is " in instance.text
    assert state.value is None


def test_states_of_others_are_refused(instance, exchange, loop):
    instance.initialize()
    data, state = _serialized(instance), ctypes.c_void_p()
    size = ctypes.c_size_t(len(data))
    assert exchange.call("DeSerializeFMUstate", data, size, ctypes.byref(state)) == ERROR
    assert "the state is one of a co-simulation instance" in exchange.text
    assert instance.call("DeSerializeFMUstate", data, ctypes.c_size_t(10), ctypes.byref(state)) == ERROR
    with Driver(loop.folder) as other:
        assert other.call("DeSerializeFMUstate", data, size, ctypes.byref(state)) == ERROR
        assert "the state is not one of this FMU" in other.text


@pytest.mark.parametrize("export", [lambda block, path: export_fmu(block, path), lambda block, path: component(block)])
def test_a_block_with_clocks_is_no_fmu_2(export, tmp_path):
    for block in (library.sliding_mode_clocked(), library.closed_loop(library.sliding_mode_clocked())):
        message = rf"{block.name} has clocks \((controller\.)?sampling\), which FMI 2 .* fmi_version=3, .*_sampled"
        with pytest.raises(ModelError, match=message):
            export(block, tmp_path / "clocked.fmu")
    assert not list(tmp_path.iterdir())


def test_per_cent_signs_reach_the_logger_doubled(exported):
    y = symbols("y")[0]
    limit = Parameter("y", "1", "a parameter", 0.0)
    check = Check("percent", y > 0, "y must be above 0 %s %n")
    block = Block("percent", parameters=(limit,), outputs=(Output("z", "1", "y", y),), checks=(check,))
    with Driver(exported(block).folder) as one:
        one.done("EnterInitializationMode")
        assert one.call("ExitInitializationMode") == ERROR
        assert "above 0 %%s %%n" in one.text, "the message is a format for printf"
