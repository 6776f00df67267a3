"""In-process components: fmpy drives them as it drives the FMU, to the same numbers and messages."""

import ctypes
import gc
import math
import os

import fmpy
import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3Slave

from brunovsky.blocks import library
from brunovsky.errors import BrunovskyError, ParameterError
from brunovsky.fmi import ComponentError, component

KINDS = ("CoSimulation", "ModelExchange")
CLASSES = {
    (2, "CoSimulation"): FMU2Slave,
    (2, "ModelExchange"): FMU2Model,
    (3, "CoSimulation"): FMU3Slave,
    (3, "ModelExchange"): FMU3Model,
}


def _equal(first, second):
    assert first.dtype == second.dtype
    for name in first.dtype.names:
        np.testing.assert_allclose(
            first[name].astype(float), second[name].astype(float), rtol=0, atol=1e-12, err_msg=name
        )


@pytest.mark.parametrize(("version", "kind"), CLASSES)
def test_fmpy_runs_it_to_the_results_of_the_fmu(version, kind, exported):
    loop = exported(library.closed_loop(), version)
    signal = np.array([(0.0, 0.0, 0.1), (1.0, 0.2, 0.1)], dtype=[("time", float), ("d[1]", float), ("d[2]", float)])
    options = {"fmi_type": kind, "stop_time": 1.0, "start_values": {"P": 1.5}, "input": signal}
    with component(library.closed_loop(), version, kind) as one:
        assert isinstance(one, CLASSES[version, kind])
        found = fmpy.simulate_fmu(one.directory, fmu_instance=one, **options)
    _equal(found, fmpy.simulate_fmu(str(loop.fmu), **options))


@pytest.mark.parametrize("name", ["zoo", "relay", "sampled_integrator", "ball"])
@pytest.mark.parametrize(("version", "kind"), CLASSES)
def test_events_are_those_of_the_fmu(name, version, kind, exported, request):
    block = request.getfixturevalue(name)
    options = {"fmi_type": kind, "stop_time": 1.0, "output_interval": 0.02}
    with component(block, version, kind) as one:
        found = fmpy.simulate_fmu(one.directory, fmu_instance=one, **options)
    _equal(found, fmpy.simulate_fmu(str(exported(block, version).fmu), **options))


@pytest.mark.parametrize("version", [2, 3])
def test_it_runs_again_after_a_reset(version):
    with component(library.linearized_robot(), version) as one:
        options = {"fmu_instance": one, "fmi_type": "CoSimulation", "stop_time": 0.5}
        first = fmpy.simulate_fmu(one.directory, **options, start_values={"eta_start[2]": 1.0})
        one.reset()
        again = fmpy.simulate_fmu(one.directory, **options, start_values={"eta_start[2]": 1.0})
        one.reset()
        other = fmpy.simulate_fmu(one.directory, **options)
    _equal(first, again)
    assert first["x"][-1] != other["x"][-1]


def test_many_in_one_process_do_not_disturb_each_other(sampled_integrator):
    many = [component(sampled_integrator, instance_name=f"number {index}") for index in range(20)]
    for index, one in enumerate(many):
        one.setupExperiment(startTime=0.0)
        one.enterInitializationMode()
        one.setReal([one.references["u"]], [float(index)])
        one.exitInitializationMode()
    for one in many:
        one.doStep(0.0, 0.1)
    totals = [one.getReal([one.references["total"]])[0] for one in many]
    assert totals == pytest.approx([0.03 * 4 * index for index in range(20)])
    for one in many:
        one.freeInstance()
    assert not any(os.path.exists(one.directory) for one in many)


def test_a_refusal_carries_the_message_of_the_fmu():
    with component(library.linearized_robot()) as one:
        with pytest.raises(
            ComponentError, match=r"fmi2SetReal: rho\[1\] = -1 is out of its range from 0 to inf"
        ) as caught:
            one.setReal([one.references["rho[1]"]], [-1.0])
        assert isinstance(caught.value, FMICallException) and isinstance(caught.value, BrunovskyError)
        assert (caught.value.function, caught.value.status) == ("fmi2SetReal", 3)
        with pytest.raises(
            ComponentError, match="fmi2DoStep is not allowed while a co-simulation instance is instantiated"
        ):
            one.doStep(0.0, 0.1)
        with pytest.raises(ComponentError, match=r"x_start cannot be set to -?nan"):
            one.setReal([one.references["x_start"]], [math.nan])
        with pytest.raises(ComponentError, match=r"singular at eta\[1\] = 0; start away from it or set eta_min > 0"):
            fmpy.simulate_fmu(
                one.directory, fmu_instance=one, fmi_type="CoSimulation", start_values={"eta_start[1]": 0, "eta_min": 0}
            )


def test_warnings_are_kept_beside_the_result():
    with component(library.linearized_robot()) as one:
        one.setupExperiment(startTime=0.0)
        one.enterInitializationMode()
        one.exitInitializationMode()
        one.doStep(0.0, 0.0)
        assert [category for category, _ in one.messages] == ["logStatusWarning"]
        one.doStep(0.0, 0.1)
        assert not one.messages


def test_events_are_reported_where_asked_for(ball):
    for logging, expected in ((True, [("logEvents", "event at t = 0.5 s changed continuous states")]), (False, [])):
        with component(ball, interface="ModelExchange", logging=logging) as one:
            one.setupExperiment(startTime=0.0)
            one.enterInitializationMode()
            one.exitInitializationMode()
            one.newDiscreteStates()
            one.enterContinuousTimeMode()
            one.setTime(0.5)
            one.setContinuousStates((ctypes.c_double * 2)(-1e-9, -4.0), 2)
            one.enterEventMode()
            one.newDiscreteStates()
            assert list(one.messages) == expected


def test_its_folder_lives_as_long_as_it_does(sampled_integrator):
    one = component(sampled_integrator)
    folder = one.directory
    assert os.path.isfile(os.path.join(folder, "modelDescription.xml"))
    del one
    gc.collect()
    assert not os.path.exists(folder)
    with component(sampled_integrator) as two:
        folder = two.directory
    assert not os.path.exists(folder)
    two.freeInstance()
    with pytest.raises(ComponentError, match="fmi2DoStep: the component has ended"):
        two.doStep(0.0, 0.1)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"fmi_version": 1}, "FMI 1 is not available; use fmi_version=2"),
        ({"interface": "ScheduledExecution"}, "'ScheduledExecution' of .*; use CoSimulation or ModelExchange"),
        (
            {"interface": "ScheduledExecution", "fmi_version": 3},
            "in FMI 3: .* for blocks with clocks, .*; use CoSimulation or ModelExchange",
        ),
        ({"event_mode_used": True}, "options of co-simulation in FMI 3"),
        ({"early_return_allowed": True, "fmi_version": 3, "interface": "ModelExchange"}, "options of co-simulation"),
    ],
)
def test_what_is_not_available_is_refused(options, message, sampled_integrator):
    with pytest.raises(ParameterError, match=message):
        component(sampled_integrator, **options)
