"""Derivatives where events, refusals or infinite values are in the way; the adjoint; dependencies at run time."""

import ctypes
import math
import shutil
from pathlib import Path

import numpy as np
import pytest
import sympy as sp
from fmpy import extract, platform, sharedLibraryExtension
from fmu_driver import DISCARD, ERROR, OK, Driver

from brunovsky.blocks import TIME, Block, Input, Mode, Output, Parameter, Sample, State, Transition, library, symbols
from brunovsky.fmi import model_structure, scalar_variables
from brunovsky.fmi.contents import headers_folder, source_files
from brunovsky.native import compile_library


@pytest.fixture(scope="module")
def opened(exported, tmp_path_factory):
    """FMU of a block whose binary lets the tests reach what only FMI 3 passes on."""
    folder, known = tmp_path_factory.mktemp("opened"), {}

    def build(block):
        if block.name not in known:
            target = Path(extract(str(exported(block).fmu), str(folder / block.name)))
            shutil.rmtree(target / "binaries")
            binary = target / "binaries" / platform / f"{block.name}{sharedLibraryExtension}"
            binary.parent.mkdir(parents=True)
            sources = [*(target / "sources" / one for one in source_files(2)), Path(__file__).parent / "internal.c"]
            compile_library(sources, binary, include=[target / "sources", headers_folder()])
            known[block.name] = target
        return known[block.name]

    return build


@pytest.fixture(scope="module")
def two_ranks():
    """Samples of two ranks, the second one seeing the first; a start that is no parameter itself; relations in both."""
    x, first, second, u, a, b = symbols("x", "first", "second", "u", "a", "b")
    return Block(
        "two_ranks",
        inputs=(Input("u", "1", "input", 0.4),),
        parameters=(
            Parameter("a", "1", "", 0.7, tunable=True),
            Parameter("b", "1", "", 1.3),
            Parameter("T", "s", "", 0.1),
        ),
        states=(State("x", "1", "", derivative=second * x + a * u, start=a * sp.sin(b)),),
        samples=(
            Sample("first", "1", "", update=first**2 * u + x + sp.Max(first, 0), start=a - b, period=symbols("T")[0]),
            Sample("second", "1", "", update=first * second + TIME * u, start=b**2, period=symbols("T")[0], rank=1),
        ),
        outputs=(
            Output("second", "1", "", second),
            Output("mixed", "1", "", second * x + sp.sqrt(first**2 + 1) * a + TIME**2),
        ),
    )  # fmt: skip


@pytest.mark.parametrize(("a", "b"), [(0.7, 1.3), (1.6, 0.4)])
def test_samples_of_the_first_instant_are_differentiated_rank_by_rank(two_ranks, exported, a, b):
    t, u, p, q = 0.3, 0.4, sp.Symbol("p"), sp.Symbol("q")
    x, first = p * sp.sin(q), p - q
    updated = first**2 * u + x + (first if a > b else 0)
    second = updated * q**2 + t * u
    mixed = second * x + sp.sqrt(updated**2 + 1) * p + t**2
    expected = [
        [sp.diff(one, by).subs({p: a, q: b}) for by in (p, q)] for one in (second, mixed, second * x + p * u, x)
    ]
    with Driver(exported(two_ranks).folder) as instance:
        instance.done("SetupExperiment", 0, 0.0, t, 0, 0.0)
        instance.done("EnterInitializationMode")
        assert instance.set({"a": a, "b": b, "u": u}) == OK
        found = instance.jacobian(["second", "mixed", "der(x)", "x"], ["a", "b"])
        np.testing.assert_allclose(found, np.array(expected, dtype=float), rtol=1e-13)
        np.testing.assert_allclose(instance.jacobian(["second"], ["time", "u"])[0], [u, (a - b) ** 2 * b**2 + t])
        instance.done("ExitInitializationMode")
        assert not instance.jacobian(["second"], ["a", "b", "u", "time", "x"]).any(), "held until the next sample"


def test_a_state_that_the_first_instant_resets_has_no_initial_derivatives(zoo, exported):
    with Driver(exported(zoo).folder) as instance:
        instance.done("EnterInitializationMode")
        assert instance.set({"x_start": 0.2}) == OK
        np.testing.assert_allclose(instance.jacobian(["mixed", "der(y)"], ["x_start"]), [[0.5], [1.0]])
        assert instance.set({"x_start": 0.4}) == OK
        assert instance.directional(["mixed"], ["x_start"], [1.0])[0] == ERROR
        assert "a transition of the first instant assigned y; ask for them afterwards" in instance.text
        instance.done("ExitInitializationMode")
        assert instance.directional(["mixed"], ["x"], [1.0]) == (OK, [0.5])


def test_modes_that_the_first_instant_changes_are_no_obstacle(exported):
    x, u, gear, gain = symbols("x", "u", "gear", "gain")
    block = Block(
        "shifting",
        inputs=(Input("u"),),
        parameters=(Parameter("gain", "1", "", 2.0),),
        states=(State("x", derivative=gear * u * gain, start=gain),),
        modes=(Mode("gear", "1", "", 1),),
        outputs=(Output("y", expression=gear * x),),
        transitions=(Transition("up", sp.And(sp.Eq(gear, 1), u > 1), {gear: sp.Integer(3)}),),
    )
    with Driver(exported(block).folder) as instance:
        instance.done("EnterInitializationMode")
        for u_value, factor in ((0.5, 1.0), (2.0, 3.0)):
            assert instance.set({"u": u_value}) == OK
            found = instance.jacobian(["y", "der(x)"], ["gain", "u"])
            np.testing.assert_allclose(found, [[factor, 0.0], [factor * u_value, factor * 2.0]])


def test_what_is_no_unknown_or_known_is_named(zoo, exported):
    with Driver(exported(zoo).folder) as instance:
        instance.initialize()
        for unknown in ("gear", "fast", "u", "gain", "y", "time", "held"):
            assert instance.directional([unknown], ["u"], [1.0])[0] == ERROR
            assert f"{unknown} is no unknown: derivatives are of Real outputs and state derivatives" in instance.text
        for known in ("mixed", "copy", "solver", "der(x)", "held"):
            assert instance.directional(["mixed"], [known], [1.0])[0] == ERROR
            assert f"{known} is no known: derivatives are with respect to time, inputs, parameters" in instance.text
        for value in (math.nan, math.inf):
            assert instance.directional(["mixed"], ["u"], [value])[0] == ERROR
            assert "seed 0 cannot be" in instance.text
        assert instance.directional(["mixed"], ["u"], [1.0])[0] == OK


def test_states_are_unknowns_of_initialisation_and_knowns_afterwards(robot):
    with Driver(robot.folder) as instance:
        instance.done("EnterInitializationMode")
        assert instance.directional(["x"], ["x_start"], [2.0]) == (OK, [2.0])
        assert instance.directional(["x"], ["x"], [1.0])[0] == ERROR
        assert "x is no known: derivatives are with respect to time, inputs and parameters" in instance.text
        instance.done("ExitInitializationMode")
        assert instance.directional(["x"], ["x", "x_start"], [2.0, 3.0]) == (OK, [2.0])


@pytest.mark.parametrize("which", ["unknowns", "knowns"])
def test_value_references_that_do_not_exist_and_null_pointers_are_refused(robot, which):
    with Driver(robot.folder) as instance:
        instance.initialize()
        instance.variables["u[2]" if which == "unknowns" else "v[1]"].valueReference = 4711
        assert instance.directional(["u[2]"], ["v[1]"], [1.0])[0] == ERROR
        assert "there is no variable with value reference 4711" in instance.text
        one, value, reference = ctypes.c_size_t(1), (ctypes.c_double * 1)(), (ctypes.c_uint * 1)()
        for gap in (0, 2, 4, 5):
            arguments = [reference, one, reference, one, value, value]
            arguments[gap] = None
            assert instance.call("GetDirectionalDerivative", *arguments) == ERROR
            assert "null pointer" in instance.text


def test_a_derivative_that_is_not_finite_is_an_error_and_in_continuous_time_discarded(exported):
    level, u = symbols("level", "u")
    block = Block(
        "tank",
        inputs=(Input("u"),),
        states=(State("level", derivative=u, start=sp.Integer(0)),),
        outputs=(Output("speed", expression=sp.sqrt(level) + u),),
    )
    with Driver(exported(block).folder, "ModelExchange") as instance:
        instance.initialize()
        for status in (ERROR, DISCARD):
            assert instance.directional(["speed"], ["level"], [1.0])[0] == status
            assert instance.text.endswith("tank: the derivative of speed is not finite at t = 0 s")
            assert instance.directional(["speed"], ["u"], [1.0]) == (OK, [1.0]), "the level does not move"
            if status == ERROR:
                instance.enter_continuous_time()


def adjoint(instance, unknowns, knowns, seed):
    found = (ctypes.c_double * len(knowns))()
    result = instance.library.test_adjoint(
        instance.handle, instance.references(unknowns), ctypes.c_size_t(len(unknowns)),
        instance.references(knowns), ctypes.c_size_t(len(knowns)), (ctypes.c_double * len(seed))(*seed), found,
    )  # fmt: skip
    instance.library.test_message.restype = ctypes.c_char_p
    instance.library.test_message.argtypes = [ctypes.c_void_p]
    return result, list(found)


def stacked(instance, unknowns, knowns):
    """Adjoint derivatives of each unknown, as rows."""
    rows = [adjoint(instance, [one], knowns, [1.0]) for one in unknowns]
    assert {result for result, _ in rows} == {OK}
    return np.array([row for _, row in rows])


def check_adjoint(instance, unknowns, knowns, tolerance):
    jacobian = instance.jacobian(unknowns, knowns)
    np.testing.assert_allclose(stacked(instance, unknowns, knowns), jacobian, rtol=tolerance, atol=tolerance)
    seed = np.linspace(-1, 2, len(unknowns))
    result, found = adjoint(instance, unknowns, knowns, seed)
    assert result == OK
    scale = np.abs(jacobian).max()
    np.testing.assert_allclose(found, seed @ jacobian, rtol=1e-12, atol=1e-12 * scale)


@pytest.mark.parametrize("name", ["closed_loop", "two_ranks"])
def test_the_adjoint_is_the_transpose(name, two_ranks, opened):
    block = library.closed_loop() if name == "closed_loop" else two_ranks
    with Driver(opened(block)) as instance:
        instance.done("EnterInitializationMode")
        inputs = instance.named("input")
        assert instance.set({one: 0.3 + 0.1 * index for index, one in enumerate(inputs)}) == OK
        knowns = ["time", *inputs, *instance.named("parameter")]
        check_adjoint(instance, [*instance.real_unknowns(), *instance.states()], knowns, 1e-12)
        instance.done("ExitInitializationMode")
        check_adjoint(instance, instance.real_unknowns(), [*knowns, *instance.states()], 0.0)


def test_the_adjoint_refuses_what_the_directional_derivative_refuses(two_ranks, opened):
    with Driver(opened(two_ranks)) as instance:
        instance.initialize()
        for unknown, known, seed in (("first", "u", 1.0), ("mixed", "mixed", 1.0), ("mixed", "u", math.nan)):
            assert adjoint(instance, [unknown], [known], [seed])[0] != OK
            assert instance.directional([unknown], [known], [seed])[0] == ERROR
            message = instance.library.test_message(instance.handle).decode()
            assert instance.text.endswith(message)


@pytest.mark.parametrize("name", ["closed_loop", "two_ranks"])
def test_dependencies_at_run_time_are_those_of_the_model_structure(name, two_ranks, opened):
    block = library.closed_loop() if name == "closed_loop" else two_ranks
    table = scalar_variables(block)
    structure = model_structure(block, table, 3)
    kinds = ("independent", "constant", "fixed", "tunable", "discrete", "dependent")
    with Driver(opened(block)) as instance:
        for unknowns in (structure.initial_unknowns, (*structure.outputs, *structure.derivatives)):
            for one in unknowns:
                expected = [
                    (table[known - 1].reference, kind) for known, kind in zip(one.dependencies, one.kinds, strict=True)
                ]
                count = ctypes.c_size_t()
                reference = table[one.index - 1].reference
                assert instance.library.test_count_dependencies(instance.handle, reference, ctypes.byref(count)) == OK
                assert count.value == len(expected)
                found, how = (ctypes.c_uint * len(expected))(), (ctypes.c_int * len(expected))()
                arguments = instance.handle, reference, found, how
                assert instance.library.test_get_dependencies(*arguments, count) == OK
                assert [(k, kinds[kind]) for k, kind in zip(found, how, strict=True)] == expected
                assert instance.library.test_get_dependencies(*arguments, ctypes.c_size_t(count.value + 1)) != OK
            instance.done("Reset")
            instance.initialize()
        assert instance.library.test_count_dependencies(instance.handle, 10**6, ctypes.byref(count)) != OK
        assert instance.library.test_count_dependencies(instance.handle, 1, ctypes.byref(count)) != OK


def test_what_c_has_no_derivative_of_is_refused_where_it_acts_alone(exported):
    x, u = symbols("x", "u")
    block = Block(
        "factorial",
        inputs=(Input("u", start=2.0),),
        states=(State("x", derivative=u, start=sp.Integer(4)),),
        outputs=(Output("y", expression=u * sp.gamma(x)), Output("z", expression=u + x)),
    )
    with Driver(exported(block).folder) as instance:
        instance.initialize()
        assert instance.directional(["y", "z"], ["u"], [1.0]) == (OK, [6.0, 1.0])
        assert instance.directional(["z"], ["x"], [1.0]) == (OK, [1.0])
        assert instance.directional(["y"], ["x"], [1.0])[0] == ERROR
        assert "the derivative of y is not finite" in instance.text
