"""A kind of dependency is what it says, at random points: factors that must not change don't, and the others do."""

import sys
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from fmpy import read_model_description
from fmu_driver import OK, Driver

from brunovsky.blocks import Block, Input, Mode, Output, Parameter, Sample, State, symbols
from brunovsky.fmi import model_structure, scalar_variables

sys.path.append(str(Path(__file__).parents[1] / "blocks"))
from gallery_blocks import gallery_block

POINTS = 6
U, Z, X, H, P, K, M = symbols("u", "z", "x", "h", "p", "k", "m")


def kinds_of(block, version, *groups):
    """Kinds of the known names by unknown name."""
    table = scalar_variables(block)
    structure = model_structure(block, table, version)
    return {
        table[one.index - 1].name: {
            table[known - 1].name: kind for known, kind in zip(one.dependencies, one.kinds, strict=True)
        }
        for group in groups or ("outputs", "derivatives")
        for one in getattr(structure, group)
    }


def switching(name, expression):
    """Output y of inputs u and z, parameters p (fixed) and k (tunable), the state x, the sample h and the mode m."""
    return Block(
        name,
        inputs=(Input("u"), Input("z")),
        parameters=(Parameter("p", value=2.0), Parameter("k", value=3.0, tunable=True)),
        states=(State("x", derivative=U, start=P),),
        samples=(Sample("h", update=X),),
        modes=(Mode("m", start=1),),
        outputs=(Output("y", expression=expression),),
    )


EXPRESSIONS = {
    "gain": (3 * U, {"u": "constant"}),
    "fixed_gain": (P**2 * U + X, {"u": "fixed", "x": "constant", "p": "dependent"}),
    "tunable_gain": (P * K * U, {"u": "tunable", "p": "dependent", "k": "dependent"}),
    "held_gain": (H * U, {"u": "discrete"}),
    "gain_of_a_mode": (M * U + 1, {"u": "discrete"}),
    "product": (X * U, {"u": "dependent", "x": "dependent"}),
    "two_slopes": (sp.Piecewise((2 * U, U > 0), (3 * U, True)), {"u": "discrete"}),
    "two_slopes_and_more": (
        sp.Piecewise((2 * U, U > 0), (3 * U, True)) + X * P,
        {"u": "discrete", "x": "fixed", "p": "dependent"},
    ),
    "two_values": (sp.Piecewise((2, U > 0), (3, True)), {"u": "dependent"}),
    "jump": (2 * U + sp.sign(U), {"u": "dependent"}),
    "other_decides": (sp.Piecewise((2 * U, Z > 0), (3 * U, True)), {"u": "discrete", "z": "dependent"}),
    "saturation": (sp.Max(-1, sp.Min(1, U)), {"u": "dependent"}),
    "absolute": (sp.Abs(U), {"u": "discrete"}),
    "curved_branch": (sp.Piecewise((U**2, U > 0), (U, True)), {"u": "dependent"}),
    "parameter": (K + P, {"k": "constant", "p": "constant"}),
    "nothing": (sp.Integer(4), {}),
}  # fmt: skip


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_kinds_are_as_strict_as_the_standard_allows(name):
    expression, expected = EXPRESSIONS[name]
    block = switching(name, expression)
    assert kinds_of(block, 3)["y"] == expected
    assert kinds_of(block, 2)["y"] == {one: kind for one, kind in expected.items() if one not in ("p", "k")}


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        (X, {"p": "constant"}),
        (H, {"p": "constant"}),
        (M * X + U, {"p": "constant", "u": "constant"}),
        (P * U, {"p": "dependent", "u": "dependent"}),
        (sp.Abs(U), {"u": "dependent"}),
        (sp.Piecewise((U, sp.Eq(M, 1)), (2 * U, True)), {"u": "constant"}),
        (sp.sin(X) + H, {"p": "dependent"}),
        (U > 0, {"u": "dependent"}),
    ],
)
def test_initial_kinds_go_through_the_first_instant(expression, expected):
    found = kinds_of(switching("starting", expression), 3, "initial_unknowns")
    assert found["y"] == expected
    assert found["der(x)"] == {"u": "constant"}


def test_event_indicators_depend_on_what_they_are_made_of(robot):
    table = scalar_variables(robot.block, 3)
    found = model_structure(robot.block, table, 3).event_indicators
    assert len(found) == 2
    for one in found:
        assert "indicator" in table[one.index - 1].name
        assert [table[k - 1].name for k in one.dependencies] == ["eta_min", "eta[1]"]
        assert one.kinds == ("constant", "constant")
    assert model_structure(robot.block, scalar_variables(robot.block)).event_indicators == ()


def factors(instance, rng, unknowns, knowns, parameters):
    """Jacobian at a random point after a new initialisation; of what does not change between events, and what does."""
    instance.done("Reset")
    values = {
        one: abs(float(instance.variables[one].start)) * float(rng.uniform(0.6, 1.5)) + 0.01 for one in parameters
    }
    instance.initialize(values)
    found = []
    for _ in range(2):
        instance.enter_continuous_time()
        states, inputs = instance.states(), instance.named("input")
        for _ in range(2):
            instance.done("SetTime", float(rng.uniform(0, 1)))
            instance.vector(
                "SetContinuousStates", len(states), list(rng.choice([0.04, 1]) * rng.uniform(0.2, 1.2, len(states)))
            )
            assert not inputs or instance.set({one: float(rng.normal()) for one in inputs}) == OK
            found.append(instance.jacobian(unknowns, knowns))
        instance.done("EnterEventMode")
    return np.array(found)


GALLERY = ("ball_and_beam", "pvtol_flat_untouched", "quadrotor")
CHOSEN = ["robot", "loop", "zoo", *GALLERY[:2], pytest.param("quadrotor", marks=pytest.mark.slow)]


@pytest.mark.parametrize("name", CHOSEN)
def test_factors_change_only_when_their_kind_may(name, request, exported):
    fmu = gallery_block(name)[0] if name in GALLERY else request.getfixturevalue(name)
    fmu = fmu if hasattr(fmu, "folder") else exported(fmu)
    rng = np.random.default_rng(8)
    with Driver(fmu.folder, "ModelExchange") as instance:
        parameters = [one for one in instance.named("parameter") if one != "step_size"]
        unknowns = instance.real_unknowns()
        knowns = ["time", *instance.states(), *instance.named("input"), *parameters]
        found = np.array([factors(instance, rng, unknowns, knowns, parameters) for _ in range(POINTS)])
    # axes: parameters, point (0 and 1 of one event, 2 and 3 of the next), unknown, known
    same = {
        "constant": lambda one: np.ptp(one),
        "fixed": lambda one: np.ptp(one, axis=1),
        "tunable": lambda one: np.ptp(one, axis=1),
        "discrete": lambda one: np.abs(one[:, [1, 3]] - one[:, [0, 2]]),
    }
    declared = kinds_of(fmu.block, 3)
    for i, unknown in enumerate(unknowns):
        for j, known in enumerate(knowns):
            kind = declared[unknown].get(known)
            entry = found[:, :, i, j]
            if kind is None:
                assert not entry.any(), (unknown, known)
            elif kind in same:
                assert np.max(same[kind](entry)) <= 1e-12 * (1 + np.abs(entry).max()), (unknown, known, kind)
                assert entry.any(), (unknown, known, kind)
            if name == "robot" and kind == "dependent":
                assert np.ptp(entry, axis=1).any(), (unknown, known)


@pytest.mark.parametrize("name", ["robot", "loop", "zoo", "sampled_integrator", "ball_and_beam"])
def test_factors_of_initialisation_are_the_same_from_every_start_where_they_are_constant(name, request, exported):
    fmu = gallery_block(name)[0] if name in GALLERY else request.getfixturevalue(name)
    fmu = fmu if hasattr(fmu, "folder") else exported(fmu)
    rng, found = np.random.default_rng(10), []
    with Driver(fmu.folder) as instance:
        rows = (one.variable for one in instance.description.initialUnknowns)
        unknowns = [one.name for one in rows if one.type == "Real"]
        knowns = [one for one in (*instance.named("parameter"), *instance.named("input")) if one != "step_size"]
        for _ in range(POINTS):
            instance.done("Reset")
            instance.done("SetupExperiment", 0, 0.0, float(rng.uniform(0, 2)), 0, 0.0)
            instance.done("EnterInitializationMode")
            starts = {one: float(instance.variables[one].start) for one in knowns}
            point = {one: value * rng.uniform(0.5, 1.4) + rng.uniform(0, 0.01) for one, value in starts.items()}
            assert instance.set(point) == OK
            found.append(instance.jacobian(unknowns, ["time", *knowns]))
    entries = np.array(found)
    declared = kinds_of(fmu.block, 2, "initial_unknowns")
    for i, unknown in enumerate(unknowns):
        for j, known in enumerate(("time", *knowns)):
            kind, entry = declared[unknown].get(known), entries[:, i, j]
            assert kind in (None, "constant", "dependent")
            assert entry.any() or kind != "constant", (unknown, known)
            assert not entry.any() or kind, (unknown, known)
            if kind == "constant":
                assert np.ptp(entry) <= 1e-13 * np.abs(entry).max(), (unknown, known)
            if kind == "dependent" and name == "robot" and known != "eta_min":
                assert np.ptp(entry) > 0, (unknown, known)


@pytest.mark.parametrize("name", ["robot", "loop", "zoo"])
def test_what_is_linear_is_so_over_any_distance(name, request, exported):
    fmu = request.getfixturevalue(name)
    fmu = fmu if hasattr(fmu, "folder") else exported(fmu)
    rng = np.random.default_rng(9)
    declared = kinds_of(fmu.block, 2)
    linear = {"constant", "fixed", "tunable"}
    with Driver(fmu.folder, "ModelExchange") as instance:
        states, inputs = instance.states(), instance.named("input")
        instance.initialize()
        instance.enter_continuous_time()

        def go(point):
            instance.done("SetTime", point["time"])
            instance.vector("SetContinuousStates", len(states), [point[one] for one in states])
            assert not inputs or instance.set({one: point[one] for one in inputs}) == OK
            instance.done("EnterEventMode")  # relations of the new point
            values = dict(zip(unknowns, instance.get(*unknowns), strict=True))
            instance.done("EnterContinuousTimeMode")
            return values

        unknowns = instance.real_unknowns()
        for _ in range(3):
            point = {one: float(rng.normal()) for one in (*states, *inputs)} | {"time": float(rng.uniform(0, 1))}
            before = go(point)
            factor = instance.jacobian(unknowns, list(point))
            for j, known in enumerate(point):
                after = go(point | {known: point[known] + 2.5})
                for i, unknown in enumerate(unknowns):
                    if declared[unknown].get(known) in linear:
                        expected = before[unknown] + 2.5 * factor[i, j]
                        assert after[unknown] == pytest.approx(expected, rel=1e-9, abs=1e-7), (unknown, known)


def test_the_description_says_what_the_model_structure_says(loop):
    description = read_model_description(str(loop.fmu))
    found = {
        one.variable.name: {k.name: kind for k, kind in zip(one.dependencies, one.dependenciesKind, strict=True)}
        for one in (*description.outputs, *description.derivatives)
    }
    assert found == kinds_of(loop.block, 2)
