"""What a component can beside stepping, in both versions and interfaces: states, derivatives, dependencies, options."""

import ctypes
import math
import os

import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

from brunovsky.blocks import TIME, Block, Output, library
from brunovsky.fmi import ComponentError, component

CLASSES = [(version, kind) for version in (2, 3) for kind in ("CoSimulation", "ModelExchange")]


def _values(one, *names):
    read = one.getReal if one.fmi_version == 2 else one.getFloat64
    return read([one.references[name] for name in names])


def _start(one):
    """Start the robot turning, in either version and interface."""
    write = one.setReal if one.fmi_version == 2 else one.setFloat64
    if one.fmi_version == 2:
        one.setupExperiment(startTime=0.0)
    write([one.references["eta_start[2]"]], [1.0])
    one.enterInitializationMode()
    write([one.references["v[1]"]], [0.3])
    one.exitInitializationMode()


def _advance(one, time, length):
    """A step: of the component itself, or one of Euler in its derivatives."""
    if isinstance(one, FMU2Slave | FMU3Slave):
        one.doStep(time, length)
        return
    count = len(one.model_description.derivatives)
    x, dx = (ctypes.c_double * count)(), (ctypes.c_double * count)()
    one.getContinuousStates(x, count)
    derivatives = one.getDerivatives if one.fmi_version == 2 else one.getContinuousStateDerivatives
    derivatives(dx, count)
    one.setContinuousStates((ctypes.c_double * count)(*(a + length * b for a, b in zip(x, dx, strict=True))), count)
    one.setTime(time + length)


@pytest.mark.parametrize(("version", "kind"), CLASSES)
def test_it_steps_saves_and_restores(version, kind):
    with (
        component(library.linearized_robot(), version, kind) as one,
        component(library.linearized_robot(), version, kind) as other,
    ):
        get, put, free, pack, unpack = (
            getattr(other, name)
            for name in (
                ("getFMUstate", "setFMUstate", "freeFMUstate", "serializeFMUstate", "deSerializeFMUstate")
                if version == 2
                else ("getFMUState", "setFMUState", "freeFMUState", "serializeFMUState", "deserializeFMUState")
            )
        )
        for instance in (one, other):
            _start(instance)
            if kind == "ModelExchange":
                (instance.newDiscreteStates if version == 2 else instance.updateDiscreteStates)()
                instance.enterContinuousTimeMode()
            _advance(instance, 0.0, 0.1)
        state = get()
        packed = pack(state)
        for instance in (one, other):
            _advance(instance, 0.1, 0.1)
        names = ("x", "y", "theta", "eta[1]", "u[2]")
        ahead = _values(other, *names)
        assert ahead == _values(one, *names) and ahead[0] != 0
        for restored in (state, unpack(packed)):
            put(restored)
            assert _values(other, *names) != ahead
            _advance(other, 0.1, 0.1)
            assert _values(other, *names) == ahead
            free(restored)


@pytest.mark.parametrize(("version", "kind"), CLASSES)
def test_it_gives_derivatives(version, kind):
    """Directional derivatives by columns, adjoint ones by rows, and those of an output in time along the chain."""
    with component(library.linearized_robot(), version, kind) as one:
        _start(one)
        outputs, inputs = ["u[2]", "der(eta[1])", "der(eta[2])"], ["v[1]", "v[2]", "d[2]"]
        unknowns, knowns = ([one.references[name] for name in names] for names in (outputs, inputs))
        columns = [one.getDirectionalDerivative(unknowns, knowns, list(seed)) for seed in np.eye(3)]
        before = _values(one, *outputs)
        write = one.setReal if version == 2 else one.setFloat64
        step = 1e-3
        start = _values(one, *inputs)
        if kind == "CoSimulation":
            write(knowns[:1], [start[0] + step])
            moved = np.subtract(_values(one, *outputs), before) / step
            write(knowns[:1], start[:1])
            np.testing.assert_allclose(columns[0], moved, atol=1e-9)
        assert columns[2] == pytest.approx([0, 0, 1]) and abs(columns[0][0]) > 0.1
        if version == 3:
            rows = [one.getAdjointDerivative(unknowns, knowns, list(seed)) for seed in np.eye(3)]
            np.testing.assert_allclose(rows, np.transpose(columns), atol=1e-15)
            assert len(one.getAdjointDerivative(unknowns, knowns[:2], [1.0, 0.0, 0.0])) == 2
        if kind == "CoSimulation":
            ask = one.getRealOutputDerivatives if version == 2 else one.getOutputDerivatives
            found = list(ask([one.references["Z1[1]"]] * 2, [1, 2]))
            assert found == pytest.approx(_values(one, "Z1[2]", "Z1[3]"))


@pytest.mark.parametrize("name", ["Directional", "Adjoint"])
@pytest.mark.parametrize("unknowns", [0, 1])
def test_derivatives_of_nothing_need_their_arrays_too(name, unknowns):
    """An unknown without a known, or the other way round: one of seed and result has a value, but is a null pointer."""
    with component(library.linearized_robot(), 3) as one:
        _start(one)
        counts = (unknowns, 1 - unknowns)
        seeds, results = counts if name == "Adjoint" else counts[::-1]
        references = [(ctypes.c_uint * 1)(one.references[each]) for each in ("eta[1]", "d[1]")]
        lists = [each for pair in zip(references, map(ctypes.c_size_t, counts), strict=True) for each in pair]
        derivative = getattr(one.dll, f"fmi3Get{name}Derivative")
        empty = None, ctypes.c_size_t(seeds), None, ctypes.c_size_t(results)
        assert derivative(ctypes.c_void_p(one.component), *lists, *empty) == 3
        assert "null pointer" in str(one.messages)


def test_dependencies_of_fmi_3_are_those_of_the_description():
    kinds = ["independent", "constant", "fixed", "tunable", "discrete", "dependent"]
    with component(library.closed_loop(), 3) as one:
        one.enterInitializationMode()
        one.exitInitializationMode()
        names = {number: name for name, number in one.references.items()}
        for unknown in (*one.model_description.outputs, *one.model_description.derivatives):
            _, knowns, elements, found = one.getVariableDependencies(unknown.variable.valueReference)
            expected = {
                known.name: kind for known, kind in zip(unknown.dependencies, unknown.dependenciesKind, strict=True)
            }
            assert {names[known]: kinds[kind] for known, kind in zip(knowns, found, strict=True)} == expected
            assert set(elements) <= {1}


def test_a_discarded_step_of_fmi_3_has_its_message_without_logging():
    with component(library.linearized_robot(), 3) as one:
        one.enterInitializationMode()
        one.setFloat64([one.references["v[1]"]], [1e308])
        one.exitInitializationMode()
        with pytest.raises(ComponentError, match=r"fmi3DoStep: .*t = ") as caught:
            one.doStep(0.0, 1.0)
        assert (caught.value.function, caught.value.status) == ("fmi3DoStep", 2)
        assert _values(one, "time", "x") == [0.0, 0.0]


def test_a_refusal_of_fmi_3_is_the_same():
    with component(library.linearized_robot(), 3) as one:
        with pytest.raises(ComponentError, match=r"rho\[1\] = -1 is out of its range") as caught:
            one.setFloat64([one.references["rho[1]"]], [-1.0])
        assert (caught.value.function, caught.value.status) == ("fmi3SetFloat64", 3)
    with pytest.raises(ComponentError, match="fmi3DoStep: the component has ended"):
        one.doStep(0.0, 0.1)
    assert not os.path.exists(one.directory)


def test_options_of_co_simulation_reach_the_fmu(ball):
    seen = []

    def update(_environment, time, _set, _get, _finished, can_return_early, early, early_time):
        seen.append((time, bool(can_return_early)))

    with component(ball, 3, event_mode_used=True, early_return_allowed=True, intermediate_update=update) as one:
        one.enterInitializationMode()
        one.exitInitializationMode()
        one.updateDiscreteStates()
        one.enterStepMode()
        time = 0.0
        while _values(one, "velocity")[0] <= 0:  # the first event is that it begins to fall
            event, _, early, time = one.doStep(time, 1.0)
            assert event and early
            one.enterEventMode()
            one.updateDiscreteStates()
            one.enterStepMode()
    assert time == pytest.approx(math.sqrt(2 / 9.81), abs=2e-3)
    assert seen and all(can for _, can in seen) and max(at for at, _ in seen) <= time


def test_outputs_in_event_mode_are_those_of_the_time_set_there():
    block = Block("alarm", outputs=(Output("late", expression=TIME > 1),))
    with component(block, 2, "ModelExchange") as one:
        one.setupExperiment()
        one.enterInitializationMode()
        one.exitInitializationMode()
        late = [one.references["late"]]
        assert one.getBoolean(late) == [0]
        one.setTime(1.5)
        assert one.getBoolean(late) == [1]
