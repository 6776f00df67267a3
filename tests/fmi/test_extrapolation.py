"""Time derivatives of inputs and outputs in co-simulation: polynomials over a step, exact derivatives at its end."""

import ctypes
import math
from functools import partial

import fmpy
import numpy as np
import pytest
import sympy as sp
from fmu_driver import ERROR, OK, Driver
from scipy.linalg import expm

import brunovsky as br
from brunovsky.blocks import TIME, Block, Input, Output, Parameter, Sample, State, library, symbols

SOLVERS = {"rk4": 1, "dormand_prince": 2}
ROBOT = {"eta_start[2]": 0.5, "u_start[1]": 0.3, "theta_start": 0.4}
CHAINS = [(f"Z{i}[{k}]", f"Z{i}[{k + 1}]") for i in (1, 2) for k in (1, 2)]


@pytest.fixture(scope="module")
def lag():
    """x' = u - x."""
    x, u = symbols("x", "u")
    return Block(
        "first_order_lag",
        inputs=(Input("u", "1", "input", 0.0),),
        states=(State("x", "1", "lagged", derivative=u - x),),
        outputs=(Output("x", "1", "lagged", x), Output("twice", "1", "twice the input", 2 * u)),
    )


@pytest.fixture(scope="module")
def watcher():
    """Counts time while u > 1/2, holds u every 0.1 s, has no real slope while u > 2."""
    count, held, u = symbols("count", "held", "u")
    return Block(
        "watcher",
        inputs=(Input("u", "1", "input", 0.0),),
        states=(
            State("count", "s", "time above 1/2", derivative=sp.Piecewise((1, u > sp.Rational(1, 2)), (0, True))),
            State("root", "s", "integral", derivative=sp.sqrt(2 - u)),
        ),
        samples=(Sample("held", "1", "held input", update=u, period=sp.Rational(1, 10)),),
        outputs=(
            Output("count", "s", "time above 1/2", count),
            Output("held", "1", "held input", held),
            Output("seen", "1", "input", u),
            Output("above", "1", "whether", u > sp.Rational(1, 2)),
        ),
    )


def _order(steps, errors):
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_each_derivative_of_the_input_adds_an_order_of_convergence(lag, exported, order, solver):
    """x' = sin t - x from 0 to 1 s in steps of H: the error falls with H^(order + 1)."""
    end, steps = 1.0, [0.1, 0.05, 0.025]
    exact = (math.sin(end) - math.cos(end) + math.exp(-end)) / 2
    errors = []
    for length in steps:
        with Driver(exported(lag).folder) as instance:
            assert instance.set({"solver": SOLVERS[solver]}) == OK
            instance.done("SetupExperiment", 1, 1e-13, 0.0, 0, 0.0)
            instance.done("EnterInitializationMode")
            instance.done("ExitInitializationMode")
            for index in range(round(end / length)):
                time = index * length
                assert instance.set({"u": math.sin(time)}) == OK
                given = {("u", k): math.sin(time + k * math.pi / 2) for k in range(1, order + 1)}
                assert instance.set_derivatives(given) == OK
                assert instance.step(time, length) == OK
            errors.append(abs(instance.get("x")[0] - exact))
    assert _order(steps, errors) == pytest.approx(order + 1, abs=0.08)


@pytest.mark.parametrize("solver", SOLVERS)
def test_the_input_stands_where_its_polynomial_ends_and_is_held_from_there(lag, exported, solver):
    with Driver(exported(lag).folder) as instance:
        instance.initialize({"solver": SOLVERS[solver]})
        assert instance.set({"u": 1.0}) == OK
        assert instance.set_derivatives({("u", 1): 2.0, ("u", 2): -3.0, ("u", 3): 6.0}) == OK
        assert instance.step(0.0, 0.5) == OK
        end = 1 + 2 * 0.5 - 3 * 0.5**2 / 2 + 6 * 0.5**3 / 6
        assert instance.get("u", "twice") == pytest.approx([end, 2 * end], abs=1e-15)
        slopes = [2 - 3 * 0.5 + 6 * 0.5**2 / 2, -3 + 6 * 0.5, 6.0]
        twice = [("twice", k) for k in (1, 2, 3)]
        assert instance.derivatives(*twice) == pytest.approx([2 * one for one in slopes], abs=1e-14)
        assert instance.step(0.5, 0.5) == OK
        assert instance.get("u") == pytest.approx([end], abs=0)
        assert instance.derivatives(*twice) == [0, 0, 0]
        assert instance.set_derivatives({("u", 2): 1.0}) == OK
        assert instance.derivatives(*twice) == [0, 2, 0]


@pytest.mark.parametrize("solver", SOLVERS)
def test_an_input_that_rises_switches_relations_and_is_sampled_on_its_way(watcher, exported, solver):
    with Driver(exported(watcher).folder) as instance:
        instance.initialize({"solver": SOLVERS[solver]})
        assert instance.set_derivatives({("u", 1): 1.0}) == OK
        assert instance.step(0.0, 0.97) == OK
        assert instance.get("count")[0] == pytest.approx(0.47, abs={"rk4": 1e-3, "dormand_prince": 1e-8}[solver])
        assert instance.get("held", "seen", "above") == pytest.approx([0.9, 0.97, 1], abs=1e-15)
        assert instance.derivatives(("held", 1), ("seen", 1), ("count", 1), ("count", 2)) == [0, 1, 1, 0]


def _steps(instance, time, length):
    assert instance.step(time, length) == OK, instance.text
    return [*instance.outputs(), *instance.derivatives(("seen", 1), ("count", 1))]


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_failed_step_leaves_inputs_and_their_derivatives(watcher, exported, solver):
    with Driver(exported(watcher).folder) as failing, Driver(exported(watcher).folder) as other:
        for one in (failing, other):
            one.initialize({"solver": SOLVERS[solver]})
            assert one.set({"u": 0.25}) == OK
            assert one.set_derivatives({("u", 1): 1.0, ("u", 2): 0.5}) == OK
        assert failing.step(0.0, 3.0) == ERROR
        assert "is not finite" in failing.text or "finds no step" in failing.text
        assert failing.get("u", "seen") == [0.25, 0.25]
        assert failing.derivatives(("seen", 1), ("seen", 2)) == [1.0, 0.5]
        assert _steps(failing, 0.0, 0.5) == _steps(other, 0.0, 0.5)
        assert failing.set_derivatives({("u", 3): 1e300}) == OK
        assert failing.step(0.5, 1e5) == ERROR
        assert "u leaves all bounds within the step that begins at t = 0.5 s" in failing.text
        assert failing.set_derivatives({("u", 3): 0.0}) == OK
        assert _steps(failing, 0.5, 0.5) == _steps(other, 0.5, 0.5)


def test_derivatives_are_part_of_the_state_and_end_with_a_reset(watcher, exported):
    folder = exported(watcher).folder
    with Driver(folder) as first, Driver(folder, name=b"two") as second:
        first.initialize()
        assert first.set_derivatives({("u", 1): 1.0}) == OK
        state, size, copy = ctypes.c_void_p(), ctypes.c_size_t(), ctypes.c_void_p()
        first.done("GetFMUstate", ctypes.byref(state))
        run = _steps(first, 0.0, 0.7)
        after = ctypes.c_void_p()
        first.done("GetFMUstate", ctypes.byref(after))
        assert run[-2:] == [1, 1]
        held = _steps(first, 0.7, 0.1)
        assert held[-2:] == [0, 1]
        first.done("SetFMUstate", after)
        assert first.derivatives(("seen", 1)) == [1]
        assert _steps(first, 0.7, 0.1) == held
        first.done("SetFMUstate", state)
        assert _steps(first, 0.0, 0.7) == run
        first.done("SerializedFMUstateSize", state, ctypes.byref(size))
        data = ctypes.create_string_buffer(size.value)
        first.done("SerializeFMUstate", state, data, size)
        second.done("DeSerializeFMUstate", data, size, ctypes.byref(copy))
        second.done("SetFMUstate", copy)
        assert _steps(second, 0.0, 0.7) == run
        assert second.set_derivatives({("u", 1): 5.0}) == OK
        second.done("Reset")
        second.initialize()
        assert second.step(0.0, 0.7) == OK
        assert second.get("seen") == [0.0]
        for owner, one in ((first, state), (first, after), (second, copy)):
            owner.done("FreeFMUstate", ctypes.byref(one))


def test_derivatives_may_be_set_before_the_first_step(lag, exported):
    with Driver(exported(lag).folder) as instance:
        assert instance.set_derivatives({("u", 1): 1.0}) == OK
        instance.initialize()
        assert instance.derivatives(("twice", 1), ("x", 2)) == [2, 1]
        assert instance.step(0.0, 1.0) == OK
        assert instance.get("u") == [1.0]
        assert instance.get("x")[0] == pytest.approx(math.exp(-1), abs=1e-12), "x = t - 1 + exp(-t)"


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ({("v[1]", 0): 1.0}, "v[1] has no derivative of order 0; those of an input are 1 to 3"),
        ({("v[1]", 4): 1.0}, "v[1] has no derivative of order 4; those of an input are 1 to 3"),
        ({("v[2]", 2): math.nan}, "the derivative of order 2 of v[2] cannot be set to nan: it is not finite"),
        ({("v[2]", 1): math.inf}, "the derivative of order 1 of v[2] cannot be set to inf: it is not finite"),
        ({("x", 1): 1.0}, "x (value reference 16) is no input"),
        ({("time", 1): 1.0}, "time (value reference 0) is no input"),
        ({("eta_min", 1): 1.0}, "eta_min (value reference 11) is no input"),
    ],
)
def test_derivatives_of_inputs_that_cannot_be_are_refused(robot, values, text):
    with Driver(robot.folder) as instance:
        instance.initialize()
        assert instance.set_derivatives({("v[1]", 1): 3.0} | values) == ERROR
        assert instance.text.replace("-nan", "nan") == f"logStatusError fmi2SetRealInputDerivatives: {text}"
        assert instance.step(0.0, 0.1) == OK
        assert instance.get("v[1]") == [0.0], "nothing was set, the good one neither"


def _refused(instance, reference, order):
    one, number = ctypes.c_size_t(1), (ctypes.c_double * 1)()
    arguments = ((ctypes.c_uint * 1)(reference), one, (ctypes.c_int * 1)(order), number)
    assert instance.call("GetRealOutputDerivatives", *arguments) == ERROR
    return instance.text


def test_derivatives_of_outputs_that_are_not_there_are_refused(robot, zoo, exported):
    with Driver(robot.folder) as instance:
        instance.initialize()
        reference = {name: one.valueReference for name, one in instance.variables.items()}
        refused = partial(_refused, instance)
        for order in (-1, 0, 4):
            text = f"x has no derivative of order {order}; those of an output are 1 to 3"
            assert text in refused(reference["x"], order)
        assert "singular (value reference 29) is of type Boolean, not Real" in refused(reference["singular"], 1)
        assert "v[1] (value reference 12) is no output" in refused(reference["v[1]"], 1)
        assert "time (value reference 0) is no output" in refused(0, 1)
        assert "there is no variable with value reference 999" in refused(999, 1)
        null = (ctypes.c_uint * 1)(16), ctypes.c_size_t(1), None, (ctypes.c_double * 1)()
        for function in ("GetRealOutputDerivatives", "SetRealInputDerivatives"):
            assert instance.call(function, *null) == ERROR
            assert instance.text == f"logStatusError fmi2{function}: an argument is a null pointer"
    with Driver(exported(zoo).folder) as instance:
        instance.initialize()
        assert "gear" in _refused(instance, instance.variables["gear"].valueReference, 1)
        assert "of type Integer, not Real" in instance.text
    with Driver(robot.folder, "ModelExchange") as instance:
        assert instance.set_derivatives({("v[1]", 1): 1.0}) == ERROR
        assert "is not allowed while a model-exchange instance is instantiated" in instance.text


def test_the_chains_are_the_derivatives_of_their_states(robot):
    """Z1' = Z2, Z2' = Z3, Z3' = v of each chain, and on with the derivatives of v."""
    inputs = {("v[1]", 1): 0.7, ("v[1]", 2): -2.0, ("v[2]", 1): -0.4, ("v[2]", 3): 5.0}
    length = 0.3
    with Driver(robot.folder) as instance:
        instance.initialize(ROBOT)
        assert instance.set({"v[1]": 0.5, "v[2]": -1.0}) == OK
        for reach in (0.0, length):
            if reach:
                assert instance.set_derivatives(inputs) == OK
                assert instance.step(0.0, length) == OK
            for low, high in CHAINS:
                assert instance.derivatives((low, 1))[0] == pytest.approx(instance.get(high)[0], rel=1e-13, abs=1e-13)
            for chain in (1, 2):
                v = instance.get(f"v[{chain}]")[0]
                found = instance.derivatives((f"Z{chain}[3]", 1), (f"Z{chain}[2]", 2), (f"Z{chain}[1]", 3))
                assert found == pytest.approx([v] * 3, rel=1e-12, abs=1e-12)
        found = instance.derivatives(("Z1[3]", 2), ("Z1[3]", 3), ("Z2[3]", 2), ("Z2[3]", 3), ("Z2[2]", 3))
        slope = -0.4 + 5 * length**2 / 2
        assert found == pytest.approx([0.7 - 2 * length, -2.0, slope, 5 * length, slope], rel=1e-11, abs=1e-11)


@pytest.mark.parametrize("name", ["linearized_robot", "closed_loop", "sliding_mode", "circle", "zoo"])
def test_derivatives_of_all_outputs_agree_with_differences_of_fine_simulations(name, exported, request):
    block = request.getfixturevalue("zoo") if name == "zoo" else getattr(library, name)()
    values = ROBOT if name == "linearized_robot" else {}
    middle, width = 0.43, 0.0005 if name == "closed_loop" else 0.004
    outputs = [one.name for one in block.outputs if not one.is_boolean and one.name != "gear"]
    rows = []
    for offset in (-2, -1, 0, 1, 2):
        with Driver(exported(block).folder) as instance:
            assert instance.set({"step_size": 1e-4} | values) == OK
            instance.initialize()
            slopes = {(one.name, k): 0.3 / k - 0.1 * i for i, one in enumerate(block.inputs) for k in (1, 2, 3)}
            assert instance.set_derivatives(slopes) == OK
            assert instance.step(0.0, middle + offset * width) == OK
            rows.append(instance.get(*outputs))
            if not offset:
                exact = [instance.derivatives(*((one, k) for one in outputs)) for k in (1, 2, 3)]
    weights = np.array([[1, -8, 0, 8, -1], [-1, 16, -30, 16, -1], [-6, 12, 0, -12, 6]]) / 12
    for order, (weight, found) in enumerate(zip(weights, exact, strict=True), 1):
        expected = weight @ np.array(rows) / width**order
        tolerance = [1e-6, 1e-5, 2e-2][order - 1] * np.max(np.abs(expected))
        np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance, err_msg=f"order {order}")


def test_what_has_no_finite_derivative_says_where(exported):
    u = symbols("u")[0]
    block = Block("rooted", inputs=(Input("u", start=0.0),), outputs=(Output("root", expression=sp.sqrt(u)),))
    with Driver(exported(block).folder) as instance:
        instance.initialize()
        assert instance.set_derivatives({("u", 1): 1.0}) == OK
        text = _refused(instance, instance.variables["root"].valueReference, 1)
        assert text.endswith("rooted: the derivative of order 1 of root is not finite at t = 0 s")
        assert instance.step(0.0, 4.0) == OK
        assert instance.derivatives(("root", 1), ("root", 2)) == [0.25, -1 / 32]


def test_derivatives_follow_tunable_parameters_and_time(exported):
    x, gain = symbols("x", "gain")
    block = Block(
        "tuned",
        parameters=(Parameter("gain", "1/s", "gain", 2.0, tunable=True),),
        states=(State("x", derivative=gain * x, start=sp.S.One),),
        outputs=(Output("y", expression=x * sp.cos(TIME)),),
    )
    with Driver(exported(block).folder) as instance:
        instance.initialize()
        for value in (2.0, 3.0):
            assert instance.set({"gain": value}) == OK
            assert instance.derivatives(*(("y", k) for k in (1, 2, 3))) == [value, value**2 - 1, value**3 - 3 * value]


def test_fmpy_sets_input_derivatives(exported):
    """fmpy has room for exactly nine continuous inputs, so the block has nine; each is a ramp, followed exactly."""
    names = [f"u[{index}]" for index in range(1, 10)]
    inputs, states = symbols(*names), symbols(*(f"x[{index}]" for index in range(1, 10)))
    block = Block(
        "nine",
        inputs=tuple(Input(one, start=0.0) for one in names),
        states=tuple(State(f"x[{k}]", derivative=one) for k, one in enumerate(inputs, 1)),
        outputs=tuple(Output(f"x[{k}]", expression=one) for k, one in enumerate(states, 1)),
    )
    signal = np.array(
        [(time, *(k * time for k in range(1, 10))) for time in (-1.0, 2.0)],
        dtype=[(one, float) for one in ("time", *names)],
    )
    run = partial(
        fmpy.simulate_fmu,
        str(exported(block).fmu),
        fmi_type="CoSimulation",
        start_time=0.0,
        stop_time=1.0,
        output_interval=0.1,
        input=signal,
    )
    exact = np.arange(1, 10) / 2
    followed, held = (run(set_input_derivatives=one)[-1] for one in (True, False))
    np.testing.assert_allclose([followed[f"x[{k}]"] for k in range(1, 10)], exact, atol=1e-13)
    np.testing.assert_allclose([held[f"x[{k}]"] for k in range(1, 10)], 0.9 * exact, atol=1e-13)


def _get(component, names, order=0):
    count = len(names)
    references = (ctypes.c_uint32 * count)(*(component.references[one] for one in names))
    if not order:
        return component.getReal(list(references))
    values = (ctypes.c_double * count)()
    component.fmi2GetRealOutputDerivatives(
        component.component, references, count, (ctypes.c_int * count)(*[order] * count), values
    )
    return list(values)


def _set(component, names, values, order=0):
    references = [component.references[one] for one in names]
    if order:
        component.setRealInputDerivatives(references, [order] * len(names), values)
    else:
        component.setReal(references, values)


def _coupled(parts, length, end, order):
    """Error of both chains at the end: robot, controller and reference meet at communication points only."""
    robot, controller, reference = parts
    chains = [f"Z{i}[{k}]" for i in (1, 2) for k in (1, 2, 3)]
    desired = [f"Z{i}d[{k}]" for i in (1, 2) for k in (1, 2, 3)]
    ahead, laws = ["zd3[1]", "zd3[2]"], ["v[1]", "v[2]"]
    for one in parts:
        one.reset()
        if one is robot:
            _set(one, ["x_start", "y_start", "theta_start", "eta_start[1]"], [1.5, 0.1, 1.4, 0.8])
        if one is controller:
            _set(one, ["K[1]", "K[2]", "K[3]"], [1.0, 3.0, 3.0])
        one.setupExperiment()
        one.enterInitializationMode()
        one.exitInitializationMode()
    start = np.subtract(_get(robot, chains), _get(reference, desired))
    for index in range(round(end / length)):
        for k in range(order + 1):  # the robot's derivatives of order k need those of v of order k - 1
            _set(controller, chains, _get(robot, chains, k), k)
            _set(controller, desired + ahead, _get(reference, desired + ahead, k), k)
            _set(robot, laws, _get(controller, laws, k), k)
        for one in parts:
            one.doStep(index * length, length)
    error = np.subtract(_get(robot, chains), _get(reference, desired))
    matrix = np.array([[0, 1, 0], [0, 0, 1], [-1, -3, -3]])
    exact = (expm(matrix * end) @ start.reshape(2, 3).T).T.ravel()
    return np.max(np.abs(error - exact))


def test_passing_derivatives_on_raises_the_order_of_a_coupling():
    """Three FMUs in parallel, e''' = -e - 3 e' - 3 e'' exactly: the error of the coupling falls with H^(order + 1)."""
    steps, end = [0.1, 0.05, 0.025], 1.0
    blocks = (library.linearized_robot(), library.pole_placement(), library.circle())
    parts = [br.component(one) for one in blocks]
    found = [_order(steps, [_coupled(parts, one, end, order) for one in steps]) for order in range(4)]
    for one in parts:
        one.freeInstance()
    assert found == pytest.approx([1, 2, 3, 4], abs=0.2)


def test_fmi_3_gives_the_same_derivatives_of_outputs():
    """Inputs are held over a step of FMI 3, so derivatives of v are 0."""
    with br.component(library.linearized_robot(), 3) as robot:
        robot.enterInitializationMode()
        robot.setFloat64([robot.references[one] for one in ROBOT], list(ROBOT.values()))
        robot.exitInitializationMode()
        robot.setFloat64([robot.references["v[1]"], robot.references["v[2]"]], [0.5, -1.0])
        robot.doStep(0.0, 0.3)
        names = [low for low, _ in CHAINS] + ["Z1[3]", "Z2[3]"]
        first = robot.getOutputDerivatives([robot.references[one] for one in names], [1] * 6)
        chains = robot.getFloat64([robot.references[high] for _, high in CHAINS])
        assert first == pytest.approx([*chains, 0.5, -1.0], rel=1e-13, abs=1e-13)
        second = robot.getOutputDerivatives([robot.references[one] for one in names[-2:]], [2, 2])
        assert second == pytest.approx([0, 0], abs=1e-13)
        with pytest.raises(br.BrunovskyError, match=r"x has no derivative of order 4; those of an output are 1 to 3"):
            robot.getOutputDerivatives([robot.references["x"]], [4])
