"""Declared dependencies against what changes when each known is perturbed, at many points."""

import sys
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description
from fmu_driver import Driver

from brunovsky.blocks import library
from brunovsky.fmi import model_structure, scalar_variables

sys.path.append(str(Path(__file__).parents[1] / "blocks"))
from gallery_blocks import gallery_block

POINTS = 12
REPEATS = 6


def _declared(unknowns):
    return {one.variable.name: {known.name for known in one.dependencies} for one in unknowns}


def _value_sets(instance, names):
    return dict(zip(names, instance.get(*names), strict=True))


def _changed(before, after):
    return {key for key in before if before[key] != after[key]}


def _states(description):
    return [one.variable.derivative.name for one in description.derivatives]


def _inputs(description):
    return [one.name for one in description.modelVariables if one.causality == "input"]


def _running_dependencies(folder, seed=1):
    """What outputs and derivatives depend on in event mode: union over random points of what a change of a known moves.

    Samples and modes keep their values, since no new discrete states are asked for; relations are evaluated.
    """
    rng = np.random.default_rng(seed)
    with Driver(folder, "ModelExchange") as instance:
        states, inputs = _states(instance.description), _inputs(instance.description)
        unknowns = [one.variable.name for one in (*instance.description.outputs, *instance.description.derivatives)]
        found = {name: set() for name in unknowns}
        instance.initialize()

        def values(point):
            instance.done("EnterContinuousTimeMode")
            instance.done("SetTime", point["time"])
            instance.vector("SetContinuousStates", len(states), [point[one] for one in states])
            instance.done("EnterEventMode")
            if inputs:
                assert instance.set({one: point[one] for one in inputs}) == 0
            return _value_sets(instance, unknowns)

        for _ in range(POINTS):
            base = {one: float(rng.normal()) for one in (*states, *inputs)} | {"time": float(rng.uniform(0, 0.01))}
            before = values(base)
            for known in base:
                for scale in np.geomspace(1e-3, 3, REPEATS):
                    moved = base | {known: base[known] + float(scale * rng.choice([-1, 1]))}
                    moved["time"] = abs(moved["time"])
                    for name in _changed(before, values(moved)):
                        found[name].add(known)
    return found


def _initial_dependencies(folder, seed=2):
    """The same in initialisation mode, where parameters are knowns."""
    rng = np.random.default_rng(seed)
    with Driver(folder) as instance:
        variables = instance.description.modelVariables
        parameters = [one.name for one in variables if one.causality == "parameter" and one.type == "Real"]
        knowns = [one for one in (*parameters, *_inputs(instance.description)) if one != "step_size"]
        unknowns = [one.variable.name for one in instance.description.initialUnknowns]
        found = {name: set() for name in unknowns}
        lowest = {one.name: float(one.min) if one.min is not None else -np.inf for one in variables}
        lowest |= {f"C[{k}]": 1e-3 for k in (1, 2, 3)}  # an unstable surface is refused; of order two it has a sign < 0

        def values(point):
            instance.done("Reset")
            instance.done("SetupExperiment", 0, 0.0, point["time"], 0, 0.0)
            instance.done("EnterInitializationMode")
            assert instance.set({one: point[one] for one in knowns}) == 0, instance.text
            return _value_sets(instance, unknowns)

        for _ in range(POINTS):
            base = {one: max(float(rng.normal()), lowest[one]) + 0.01 for one in knowns} | {
                "time": float(rng.uniform(0, 9))
            }
            before = values(base)
            for known in base:
                for scale in np.geomspace(1e-3, 3, REPEATS):
                    moved = base | {
                        known: max(base[known] + float(scale * rng.choice([-1, 1])), lowest.get(known, 0.0))
                    }
                    for name in _changed(before, values(moved)):
                        found[name].add(known)
    return found


def test_running_dependencies_of_the_robot_are_exact(robot):
    description = read_model_description(str(robot.fmu))
    declared = _declared((*description.outputs, *description.derivatives))
    assert declared == _running_dependencies(robot.folder)


def test_initial_dependencies_of_the_robot_are_exact(robot):
    assert _declared(read_model_description(str(robot.fmu)).initialUnknowns) == _initial_dependencies(robot.folder)


@pytest.mark.parametrize("name", ["loop", "sampled_integrator", "relay", "zoo", "circle", "ball_and_beam"])
def test_dependencies_are_declared_for_everything_that_changes(name, request, exported):
    others = {"circle": library.circle, "ball_and_beam": lambda: gallery_block("ball_and_beam")[0]}
    fmu = others[name]() if name in others else request.getfixturevalue(name)
    fmu = fmu if hasattr(fmu, "folder") else exported(fmu)
    description = read_model_description(str(fmu.fmu))
    running = _declared((*description.outputs, *description.derivatives))
    initial = _declared(description.initialUnknowns)
    for unknown, knowns in _running_dependencies(fmu.folder).items():
        assert knowns <= running[unknown], unknown
    for unknown, knowns in _initial_dependencies(fmu.folder).items():
        assert knowns <= initial[unknown], unknown


def test_what_is_sampled_at_the_start_depends_on_the_inputs_of_then(sampled_integrator, exported):
    description = read_model_description(str(exported(sampled_integrator).fmu))
    assert _declared(description.initialUnknowns)["total"] == {"u", "T"}
    assert _declared(description.outputs)["total"] == set()


def test_a_transition_at_the_start_brings_in_what_its_guard_depends_on(zoo, exported):
    initial = _declared(read_model_description(str(exported(zoo).fmu)).initialUnknowns)
    assert initial["x"] == {"x_start"}
    assert initial["gear"] == initial["y"] == {"x_start"}
    assert initial["copy"] == {"x_start"}
    assert initial["fast"] == {"u"}
    assert initial["mixed"] == {"x_start", "u", "time"}
    assert initial["der(x)"] == {"x_start", "u", "gain"}


def test_kinds_of_dependencies(zoo):
    table = scalar_variables(zoo)
    names = {index: one.name for index, one in enumerate(table, 1)}
    structure = model_structure(zoo, table)
    kinds = {
        names[one.index]: dict(zip((names[k] for k in one.dependencies), one.kinds, strict=True))
        for one in (*structure.outputs, *structure.derivatives)
    }
    assert kinds["x"] == {"x": "constant"}
    assert kinds["der(x)"] == {"u": "constant", "x": "discrete"}
    assert kinds["der(y)"] == {"time": "dependent", "x": "constant"}
    assert kinds["fast"] == {"u": "dependent"}
    initial = {names[one.index]: one.kinds for one in structure.initial_unknowns}
    assert initial["x"] == ("constant",)


def test_initial_unknowns_are_in_order_and_complete(zoo):
    table = scalar_variables(zoo)
    indices = [one.index for one in model_structure(zoo, table).initial_unknowns]
    assert indices == sorted(indices)
    assert [table[index - 1].name for index in indices] == [
        "x", "gear", "fast", "copy", "mixed", "y", "der(x)", "der(y)",
    ]  # fmt: skip
