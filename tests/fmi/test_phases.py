"""Every function of FMI 2.0 in every phase of both kinds: allowed and refused as the standard's tables have it."""

import ctypes

import pytest
from fmpy.fmi2 import fmi2EventInfo
from fmu_driver import DISCARD, ERROR, FUNCTIONS, OK, Driver

PHASES = {
    "I": ("instantiated", lambda one: None),
    "N": ("in initialization mode", lambda one: one.done("EnterInitializationMode")),
    "S": ("between communication steps", lambda one: one.initialize()),
    "E": ("in event mode", lambda one: one.initialize()),
    "C": ("in continuous-time mode", lambda one: (one.initialize(), one.enter_continuous_time())),
    "T": ("terminated", lambda one: (one.initialize(), one.done("Terminate"))),
}
KINDS = {"CoSimulation": "INST", "ModelExchange": "INECT"}
"""The phases of each kind."""

ALLOWED = {
    "SetDebugLogging": ("INST", "INECT"),
    "SetupExperiment": ("I", "I"),
    "EnterInitializationMode": ("I", "I"),
    "ExitInitializationMode": ("N", "N"),
    "Terminate": ("S", "EC"),
    "Reset": ("INST", "INECT"),
    "GetReal": ("NST", "NECT"),
    "GetInteger": ("NST", "NECT"),
    "GetBoolean": ("NST", "NECT"),
    "GetString": ("NST", "NECT"),
    "SetReal": ("INS", "INEC"),
    "SetInteger": ("INS", "INE"),
    "SetBoolean": ("INS", "INE"),
    "SetString": ("INS", "INE"),
    "GetFMUstate": ("INST", "INECT"),
    "SetFMUstate": ("INST", "INECT"),
    "FreeFMUstate": ("INST", "INECT"),
    "SerializedFMUstateSize": ("INST", "INECT"),
    "SerializeFMUstate": ("INST", "INECT"),
    "DeSerializeFMUstate": ("INST", "INECT"),
    "GetDirectionalDerivative": ("NST", "NECT"),
    "SetRealInputDerivatives": ("INS", ""),
    "GetRealOutputDerivatives": ("ST", ""),
    "DoStep": ("S", ""),
    "CancelStep": ("S", ""),
    "GetStatus": ("ST", ""),
    "GetRealStatus": ("ST", ""),
    "GetIntegerStatus": ("ST", ""),
    "GetBooleanStatus": ("ST", ""),
    "GetStringStatus": ("ST", ""),
    "EnterEventMode": ("", "EC"),
    "NewDiscreteStates": ("", "E"),
    "EnterContinuousTimeMode": ("", "E"),
    "CompletedIntegratorStep": ("", "C"),
    "SetTime": ("", "EC"),
    "SetContinuousStates": ("", "C"),
    "GetContinuousStates": ("", "NECT"),
    "GetDerivatives": ("", "NECT"),
    "GetEventIndicators": ("", "NECT"),
    "GetNominalsOfContinuousStates": ("", "INECT"),
}
"""Phases in co-simulation and in model exchange: FMI 2.0, sections 3.2.3 and 4.2.4."""

STATELESS = {"GetTypesPlatform", "GetVersion", "Instantiate", "FreeInstance"}
REFUSED_ALWAYS = {
    "CancelStep": (ERROR, "no step to cancel"),
    "GetIntegerStatus": (DISCARD, "there is no Integer status"),
}
CASES = [(kind, phase) for kind, phases in KINDS.items() for phase in phases]
ZEROS = (ctypes.c_size_t(0),) * 6


def _legal(one: Driver, function: str) -> tuple[object, ...]:
    """Arguments that the function accepts where it may be called."""
    number, boolean, text = ctypes.c_double(), ctypes.c_int(), ctypes.c_char_p()
    states = (ctypes.c_double * 6)(0, 0, 0, 1, 0, 0)
    arguments = {
        "SetupExperiment": (0, 0.0, 0.0, 0, 0.0),
        "DoStep": (0.0, 0.01, 1),
        "GetStatus": (0, ctypes.byref(boolean)),
        "GetRealStatus": (2, ctypes.byref(number)),
        "GetBooleanStatus": (3, ctypes.byref(boolean)),
        "GetStringStatus": (1, ctypes.byref(text)),
        "NewDiscreteStates": (ctypes.byref(fmi2EventInfo()),),
        "CompletedIntegratorStep": (1, ctypes.byref(boolean), ctypes.byref(ctypes.c_int())),
        "SetTime": (0.0,),
        "GetEventIndicators": ((ctypes.c_double * 2)(), ctypes.c_size_t(2)),
    }
    if function in arguments:
        return arguments[function]
    if function.endswith(("ContinuousStates", "Derivatives")) and "Real" not in function:
        return states, ctypes.c_size_t(6)
    return _of_state(one, function) if "FMUstate" in function else ZEROS


def _of_state(one: Driver, function: str) -> tuple[object, ...]:
    state, size = ctypes.c_void_p(), ctypes.c_size_t()
    if function == "GetFMUstate":
        return (ctypes.byref(state),)
    one.done("GetFMUstate", ctypes.byref(state))
    one.done("SerializedFMUstateSize", state, ctypes.byref(size))
    data = ctypes.create_string_buffer(size.value)
    one.done("SerializeFMUstate", state, data, size)
    return {
        "SetFMUstate": (state,),
        "FreeFMUstate": (ctypes.byref(state),),
        "SerializedFMUstateSize": (state, ctypes.byref(size)),
        "SerializeFMUstate": (state, data, size),
        "DeSerializeFMUstate": (data, size, ctypes.byref(ctypes.c_void_p())),
    }[function]


def test_the_table_has_every_function():
    assert set(ALLOWED) | STATELESS == set(FUNCTIONS)


@pytest.mark.parametrize(("kind", "phase"), CASES)
def test_each_function_is_allowed_where_the_standard_allows_it(robot, kind, phase):
    for function, phases in ALLOWED.items():
        if phase not in phases[kind == "ModelExchange"]:
            continue
        with Driver(robot.folder, kind) as one:
            PHASES[phase][1](one)
            status = one.call(function, *_legal(one, function))
            expected, text = REFUSED_ALWAYS.get(function, (OK, ""))
            assert status == expected, f"{function}: {one.text}"
            assert text in one.text


@pytest.mark.parametrize(("kind", "phase"), CASES)
def test_each_function_is_refused_where_the_standard_does_not_allow_it(robot, kind, phase):
    name, enter = PHASES[phase]
    written = {"CoSimulation": "co-simulation", "ModelExchange": "model-exchange"}[kind]
    for function, phases in ALLOWED.items():
        if phase in phases[kind == "ModelExchange"]:
            continue
        with Driver(robot.folder, kind) as one:
            enter(one)
            assert one.call(function, *_legal(one, function)) == ERROR, function
            assert one.text == f"logStatusError fmi2{function} is not allowed while a {written} instance is {name}"
            _goes_on(one, phase)


def _goes_on(one: Driver, phase: str) -> None:
    if phase == "S":
        assert one.step(0.0, 0.01) == OK
    if phase == "I":
        one.initialize()
    if phase == "E":
        one.enter_continuous_time()
    one.done("Reset")
