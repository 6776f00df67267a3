"""Study files: what they mean, and what is said about those that cannot be used."""

import hashlib
import pickle
from pathlib import Path

import pytest
from pydantic import ValidationError

from brunovsky.comparison import load_study, run_study
from brunovsky.comparison.study.keys import input_keys, parameter_keys, unit_suffix
from brunovsky.errors import StudyError

START = "x_start_m = 1.0"


@pytest.mark.parametrize(
    ("unit", "suffix"),
    [
        ("m", "_m"),
        ("m/s2", "_m_per_s2"),
        ("1/s", "_per_s"),
        ("1", ""),
        ("rad/s", "_rad_per_s"),
        ("kg.m2/s", "_kg_m2_per_s"),
    ],
)
def test_unit_suffix(unit, suffix):
    assert unit_suffix(unit) == suffix


def test_keys_are_names_with_units_and_all_different():
    texts = [*parameter_keys(), *input_keys()]
    assert {"eta_start_1_m_per_s", "C_1_per_s2", "C_3", "eta_min_m_per_s", "d_2_rad_per_s2"} <= set(texts)
    assert len(set(texts)) == len(texts)
    assert all(text.isidentifier() for text in texts)


def test_a_study_resolves_to_runs_of_every_scenario_under_every_law(small):
    study = load_study(small)
    linear, relay = study.plan()
    assert (linear.name, relay.name) == ("circle/linear", "circle/relay")
    assert linear.parameters["P"] == 0.0
    assert (relay.parameters["P"], relay.parameters["phi"]) == (2.5, 0.0)
    different = {name for name, value in linear.parameters.items() if relay.parameters[name] != value}
    assert different == {"P", "phi"}
    assert linear.parameters["x_start"] == 1.0
    assert dict(linear.inputs) == {"d[1]": 0.0, "d[2]": 0.0}


def test_the_digest_is_that_of_the_study_as_it_is_resolved(small):
    study, text = load_study(small), small.read_text()
    assert study.digest() == hashlib.sha256(study.resolved().encode()).hexdigest()
    small.write_text(f"step_size_s = {study.step_size_s}  # the default\n{text}")
    assert load_study(small).digest() == study.digest()
    small.write_text(text.replace(START, "x_start_m = 1.01"))
    assert load_study(small).digest() != study.digest()
    assert study.run_by("fmpy").digest() != study.digest() == study.run_by("native").digest()


def test_an_engine_does_not_pass_by_the_file_of_a_study(small):
    small.write_text('fmu = "own.fmu"\n' + small.read_text().replace('engine = "native"', 'engine = "fmpy"'))
    with pytest.raises(StudyError, match=r"engine 'native' does not run the study's own file; leave engine 'fmpy', or"):
        run_study(load_study(small), engine="native")


def test_a_study_is_frozen_and_pickles(small):
    study = load_study(small)
    with pytest.raises(ValidationError):
        study.name = "other"
    with pytest.raises(TypeError):
        study.scenarios[0].parameters["x_start_m"] = 2.0
    assert pickle.loads(pickle.dumps(study)) == study


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (START, "x_start_cm = 100.0", ["line 23", "scenarios[1].parameters.x_start_cm", "is in m", "write x_start_m"]),
        (START, "x_start = 1.0", ["x_start", "is in m", "write x_start_m"]),
        (START, "xstart_m = 1.0", ["xstart_m", "unknown parameter", "did you mean x_start_m"]),
        (START, "x_start_m = true", ["x_start_m", "number"]),
        (START, "x_start_m = inf", ["x_start_m", "finite"]),
        (START, "P_m_per_s3 = 1.0", ["P_m_per_s3", "belongs to a law", "[[laws]]"]),
        ("eta_min_m_per_s = 0.05", "eta_min_m_per_s = -1", ["eta_min_m_per_s = -1", "out of range", "0 or more"]),
        ("eta_min_m_per_s = 0.05", "C_3 = 0", ["scenario 'circle'", "C[3] = 0", "set C[3]"]),
        ("duration_s = 3.0", "duration_ms = 3000", ["line 21", "duration_ms", "is in s", "write duration_s"]),
        ("duration_s = 3.0", "duration_s = 0", ["duration_s", "greater than 0", "it is 0"]),
        ("duration_s = 3.0", "duration_s = 1e9", ["duration_s", "steps", "shorten"]),
        ("duration_s = 3.0", "", ["duration_s", "missing"]),
        ('kind = "sign"', 'kind = "signum"', ["laws[2].kind", "'sign'", "it is 'signum'"]),
        ('kind = "sign"', 'kind = "linear"', ["laws[2]", "linear law has no switching term"]),
        ("P_m_per_s3 = 2.5", "P_m_per_s3 = -2.5", ["laws[2].parameters", "P_m_per_s3 = -2.5", "out of range"]),
        ("P_m_per_s3 = 2.5", "phi_m_per_s2 = 1.0", ["laws[2]", "phi = 0", "saturation"]),
        ("P_m_per_s3 = 2.5", "Q_per_s = 1.0", ["Q_per_s", "shared by all laws", "[parameters]"]),
        (
            'kind = "sign"\nparameters = { P_m_per_s3 = 2.5 }',
            'kind = "saturation"\nparameters = { P_m_per_s3 = 2.5, phi_m_per_s2 = 1e-3 }',
            ["law 'relay'", "phi_m_per_s2 = 0.001", "step_size_s = 0.001", "phi_m_per_s2 of 0.001", "kind 'sign'"],
        ),
        ('name = "relay"', 'name = "linear"', ["two laws", "'linear'", "rename"]),
        (
            'title = "Circle"',
            'title = "Circle"\nlaws = ["relai"]',
            ["'circle'", "no law 'relai'", "did you mean relay"],
        ),
        ('title = "Circle"', 'title = "Circle"\nlaws = []', ["'circle'", "at least one law"]),
        ('engine = "native"', 'engine = "openmodelica"', ["engine", "'fmpy', 'native' or 'ssp'"]),
        ('engine = "native"', 'engines = "native"', ["line 4", "engines", "did you mean engine"]),
        (
            "[scenarios.parameters]",
            "disturbances = { d_1_m = 1.0 }\n[scenarios.parameters]",
            ["d_1_m", "is in m/s2", "d_1_m_per_s2"],
        ),
        ('title = "A small study"', "title = ", ["not valid TOML", "line 3"]),
    ],
)
def test_what_is_said_about_a_study_that_cannot_be_used(small, old, new, told):
    text = small.read_text()
    assert text.count(old) == 1 or old == 'kind = "sign"'
    small.write_text(text.replace(old, new, 1))
    with pytest.raises(StudyError) as failure:
        load_study(small)
    message = str(failure.value)
    assert message.startswith(str(small))
    assert "\n" not in message
    assert "more problem" not in message or "duration" in new or "lags_ms" in new
    assert "pydantic" not in message and "Value error" not in message
    for part in told:
        assert part in message, message


CHATTER = """
[[chatter]]
title = "grid"
lags_s = [[0.005, 0.005], [0.01]]
parameters = { Q_per_s = [1.0, 2.0] }
"""
LAGS = "lags_s = [[0.005, 0.005], [0.01]]"
GIVEN = "Q_per_s = [1.0, 2.0]"


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (LAGS, "lags_ms = [[5.0]]", ["line 28", "chatter[1].lags_ms", "is in s", "write lags_s"]),
        (LAGS, "", ["lags_s", "missing"]),
        (LAGS, "lags_s = []", ["line 28", "lags_s", "list should have at least 1 item"]),
        (LAGS, "lags_s = [0.005, 0.005]", ["lags_s", "no list of lists", "[[0.005, 0.005]"]),
        ("[0.01]]", "[-0.01]]", ["line 28", "chatter[1].lags_s[2][1]", "-0.01 s is out of range", "1e-06 to 100"]),
        ("[0.01]]", "[1e-9]]", ["lags_s[2][1]", "1e-06 to 100"]),
        ("[0.01]]", "[nan]]", ["lags_s[2][1]", "finite"]),
        ("[0.01]]", "[0.1, 0.1, 0.1, 0.1, 0.1]]", ["lags_s[2]", "at most 4 items"]),
        ("[0.01]]", "[0.01]]\ndelay_s = -1.0", ["line 29", "delay_s[1]", "out of range"]),
        ("[0.01]]", "[0.01]]\nsampling_s = 0.0", ["line 29", "sampling_s", "greater than 0"]),
        ("[0.01]]", '[0.01]]\nlaw = "linear"', ["line 26", "'grid'", "no law 'linear' with a switching term", "relay"]),
        (GIVEN, "Q = 1.0", ["line 29", "chatter[1].parameters.Q", "is in 1/s: write Q_per_s"]),
        (GIVEN, "x_start_m = 1.0", ["x_start_m", "known are C_1_per_s2"]),
        (GIVEN, "P_m_per_s3 = -1.0", ["line 29", "P_m_per_s3 = -1", "out of range"]),
        (GIVEN, "P_m_per_s3 = 0.0", ["line 26", "P_m_per_s3 = 0 has no chatter"]),
        (GIVEN, "Q_per_s = -1.0", ["line 26", "'grid'", "Q = -1"]),
        (GIVEN, "Q_per_s = 1e300", ["Q_per_s = 1e+300", "beyond all scales"]),
        (GIVEN, "C_2_per_s = -1.0", ["line 26", "'grid'", "not stable"]),
        (GIVEN, f"Q_per_s = {list(range(1, 2000))}", ["'grid'", "points; give at most 2000"]),
        ("[[chatter]]", "[chatter]", ["line 26", "write [[chatter]]"]),
    ],
)
def test_what_is_said_about_a_chatter_table_that_cannot_be_used(small, old, new, told):
    test_what_is_said_about_a_study_that_cannot_be_used(_with_chatter(small), old, new, told)


def _with_chatter(path):
    path.write_text(path.read_text() + CHATTER)
    return path


def test_all_chatter_tables_together_are_limited(small):
    many = CHATTER.replace(GIVEN, f"Q_per_s = {list(range(1, 900))}")
    small.write_text(small.read_text() + many + many)
    with pytest.raises(StudyError, match="3596 points together"):
        load_study(small)


def test_a_law_with_a_switching_term_is_needed_where_p_is_not_given(small):
    text = _with_chatter(small).read_text()
    small.write_text(text.replace('kind = "sign"\nparameters = { P_m_per_s3 = 2.5 }', 'kind = "linear"'))
    with pytest.raises(StudyError, match="no law has a switching term; give P_m_per_s3 and phi_m_per_s2"):
        load_study(small)
    small.write_text(small.read_text().replace(GIVEN, "P_m_per_s3 = 1.0, phi_m_per_s2 = 0.0"))
    assert load_study(small).chatter_grids()[0].loops[0].switching_gain == 1.0


def test_a_line_inside_an_inline_table_is_found(small):
    small.write_text(small.read_text().replace("P_m_per_s3", "P_m_per_s2"))
    with pytest.raises(
        StudyError, match=r"line 16: laws\[2\].parameters.P_m_per_s2: .*'P' is in m/s3: write P_m_per_s3"
    ):
        load_study(small)


def test_a_missing_study_file(tmp_path):
    with pytest.raises(StudyError, match=r"nowhere.toml: there is no such study file"):
        load_study(tmp_path / "nowhere.toml")


def test_a_study_that_is_no_text(tmp_path: Path):
    path = tmp_path / "binary.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(StudyError, match="UTF-8"):
        load_study(path)
    with pytest.raises(StudyError, match="cannot be read"):
        load_study(tmp_path)
