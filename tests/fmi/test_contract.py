"""Names, causalities, types, units and defaults of the FMUs that ship, to the letter."""

import pytest
from fmpy import read_model_description
from fmpy.validation import validate_fmu

from brunovsky.blocks import library
from brunovsky.fmi import shipped_block, shipped_fmus

CHAINS = {f"Z{i}[{k}]": unit for i in (1, 2) for k, unit in enumerate(("m", "m/s", "m/s2"), 1)}
STATES = {"x": "m", "y": "m", "theta": "rad", "eta[1]": "m/s", "eta[2]": "rad/s", "u[1]": "m/s2"}
STARTS = {
    "x_start": "m",
    "y_start": "m",
    "theta_start": "rad",
    "eta_start[1]": "m/s",
    "eta_start[2]": "rad/s",
    "u_start[1]": "m/s2",
}
TUNABLE = {"rho[1]": ("1", 1.0), "rho[2]": ("1", 1.0), "eta_min": ("m/s", 0.05)}
ROBOT_OUTPUTS = {**STATES, "u[2]": "rad/s2", **CHAINS}
LOOP_OUTPUTS = (
    ROBOT_OUTPUTS
    | {f"e{i}[{k}]": unit for i in (1, 2) for k, unit in enumerate(("m", "m/s", "m/s2"), 1)}
    | {"S[1]": "m/s2", "S[2]": "m/s2", "v[1]": "m/s3", "v[2]": "m/s3"}
)
LOOP_PARAMETERS = {
    "center[1]": "m",
    "center[2]": "m",
    "radius": "m",
    "rate": "rad/s",
    "phase": "rad",
    "C[1]": "1/s2",
    "C[2]": "1/s",
    "C[3]": "1",
    "Q": "1/s",
    "P": "m/s3",
    "phi": "m/s2",
}
TABLES = {
    "linearized_robot": (
        {"v[1]": "m/s3", "v[2]": "m/s3", "d[1]": "m/s2", "d[2]": "rad/s2"},
        ROBOT_OUTPUTS,
        STARTS | {key: unit for key, (unit, _) in TUNABLE.items()},
    ),
    "closed_loop": (
        {"d[1]": "m/s2", "d[2]": "rad/s2"},
        LOOP_OUTPUTS,
        STARTS | {key: unit for key, (unit, _) in TUNABLE.items()} | LOOP_PARAMETERS,
    ),
}

CONTROLLER_INPUTS = (
    CHAINS
    | {f"Z{i}d[{k}]": unit for i in (1, 2) for k, unit in enumerate(("m", "m/s", "m/s2"), 1)}
    | {"zd3[1]": "m/s3", "zd3[2]": "m/s3"}
)
REFERENCE = {name: unit for name, unit in CONTROLLER_INPUTS.items() if name not in CHAINS}
V, S = {"v[1]": "m/s3", "v[2]": "m/s3"}, {"S[1]": "m/s2", "S[2]": "m/s2"}
SURFACE = {"C[1]": "1/s2", "C[2]": "1/s", "C[3]": "1"}
PARTS = {
    "robot": (
        {"u[1]": "m/s2", "u[2]": "rad/s2", "d[1]": "m/s2", "d[2]": "rad/s2"},
        {name: unit for name, unit in STATES.items() if name != "u[1]"},
        {name: unit for name, unit in STARTS.items() if name != "u_start[1]"} | {"rho[1]": "1", "rho[2]": "1"},
    ),
    "circle": (
        {},
        REFERENCE,
        {k: unit for k, unit in LOOP_PARAMETERS.items() if k in ("center[1]", "center[2]", "radius", "rate", "phase")},
    ),
    "sliding_mode": (CONTROLLER_INPUTS, V | S, SURFACE | {"Q": "1/s", "P": "m/s3", "phi": "m/s2"}),
    "sliding_mode_relay": (
        CONTROLLER_INPUTS,
        V | S,
        SURFACE | {"Q": "1/s", "P": "m/s3", "hysteresis": "m/s2", "dwell": "s"},
    ),
    "sliding_mode_sampled": (CONTROLLER_INPUTS, V | S, {"sampling_period": "s"} | SURFACE | {"Q": "1/s", "P": "m/s3"}),
    "pole_placement": (CONTROLLER_INPUTS, V, {"K[1]": "1/s3", "K[2]": "1/s2", "K[3]": "1/s"}),
    "super_twisting": (CONTROLLER_INPUTS, V | S, SURFACE | {"k[1]": "1", "k[2]": "1", "L": "m/s4"}),
}


@pytest.mark.parametrize("name", PARTS)
def test_parts_have_the_variables_of_the_contract(name, exported):
    path = exported(shipped_block(name)).fmu
    description = read_model_description(str(path))
    inputs, outputs, parameters = PARTS[name]
    assert _units(description, "input") == inputs
    assert _units(description, "output") == outputs
    assert _units(description, "parameter") == parameters
    assert validate_fmu(str(path)) == []


def test_the_relays_are_integers_of_the_block(exported):
    description = read_model_description(str(exported(shipped_block("sliding_mode_relay")).fmu))
    assert _units(description, "output", "Integer").keys() == {"relay[1]", "relay[2]"}


@pytest.fixture(params=list(TABLES))
def described(request, robot, loop):
    fmu = {"linearized_robot": robot, "closed_loop": loop}[request.param]
    description = read_model_description(str(fmu.fmu))
    assert description.modelName == request.param
    return description, *TABLES[request.param]


def _units(description, causality, kind="Real"):
    return {
        one.name: one.unit
        for one in description.modelVariables
        if one.causality == causality and one.type == kind and one.name not in ("step_size", "solver")
    }


def test_variables_are_those_of_the_contract(described):
    description, inputs, outputs, parameters = described
    assert _units(description, "input") == inputs
    assert _units(description, "output") == outputs
    assert _units(description, "parameter") == parameters
    assert _units(description, "output", "Boolean").keys() == {"singular"}


def test_there_is_nothing_else(described):
    description, *tables = described
    names = {one.name for one in description.modelVariables}
    derivatives = {f"der({one})" for one in STATES}
    assert names == {"time", "step_size", "solver", "singular"} | derivatives | {
        key for table in tables for key in table
    }


def test_variability_and_defaults_of_parameters(described):
    description, *_ = described
    found = {one.name: one for one in description.modelVariables}
    for name in STARTS:
        assert (found[name].variability, found[name].initial) == ("fixed", "exact")
    for name, (_, value) in TUNABLE.items():
        assert (found[name].variability, float(found[name].start), float(found[name].min)) == ("tunable", value, 0.0)
    assert found["singular"].variability == "discrete"
    assert (found["step_size"].unit, float(found["step_size"].start), found["step_size"].variability) == (
        "s",
        1e-3,
        "fixed",
    )
    assert [item.name for item in found["solver"].declaredType.items] == ["RK4", "DormandPrince"]
    assert found["time"].causality == "independent"


def test_defaults_of_the_closed_loop_are_figure_6_from_outside(loop):
    found = {one.name: one.start for one in read_model_description(str(loop.fmu)).modelVariables}
    expected = {
        "x_start": 2.5, "eta_start[1]": 0.5, "radius": 2**0.5, "rate": 0.5,
        "C[1]": 500, "C[2]": 10, "C[3]": 1, "Q": 5, "P": 2.5, "phi": 0.05,
    }  # fmt: skip
    assert {key: float(found[key]) for key in expected} == expected


def test_every_variable_is_described_and_every_real_has_a_unit(described):
    for one in described[0].modelVariables:
        assert one.description
        assert one.unit or one.type != "Real"


def test_units_are_defined_by_their_exponents(described):
    units = {one.name: one.baseUnit for one in described[0].unitDefinitions}
    jerk, rate = units["m/s3"], units["rad/s"]
    assert (jerk.m, jerk.s, jerk.rad) == (1, -3, 0)
    assert (rate.rad, rate.s, rate.m) == (1, -1, 0)
    assert (units["1"].m, units["1"].s, units["1"].rad) == (0, 0, 0)


def test_each_derivative_belongs_to_the_state_that_is_an_output(described):
    found = {one.derivative.name: one for one in described[0].modelVariables if one.derivative is not None}
    assert {key: one.name for key, one in found.items()} == {key: f"der({key})" for key in STATES}
    assert [one.variable.name for one in described[0].derivatives] == [f"der({key})" for key in STATES]
    assert found["theta"].unit == "rad/s"


def test_event_indicators_of_the_singularity(robot):
    assert read_model_description(str(robot.fmu)).numberOfEventIndicators == 2


def test_fmpy_finds_nothing(robot, loop):
    assert validate_fmu(str(robot.fmu)) == []
    assert validate_fmu(str(loop.fmu)) == []


def test_the_manifest_lists_the_fmus_that_ship():
    everything = ["linearized_robot", "closed_loop", *PARTS]
    assert list(shipped_fmus(2)) == everything
    everything.insert(everything.index("sliding_mode_sampled") + 1, "sliding_mode_clocked")
    assert list(shipped_fmus()) == list(shipped_fmus(3)) == everything
    assert all(shipped_fmus().values())
    assert shipped_block("closed_loop") == library.closed_loop()
