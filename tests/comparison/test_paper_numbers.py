"""The paper's study against numbers of an independent implementation.

Provenance: RK4 with 1 ms in plain floating-point loops, switching relations frozen over each step, eta_min = 0.05,
phi = 0.05; written apart from this package and given with the model. Numbers are compared within their printed digits.
"""

from decimal import Decimal

import pytest

from brunovsky.comparison import run_study

LAWS = ("linear", "saturation", "sign")
TABLE = [
    ("fig4", "settling_time", ["1.395"]),
    ("fig5", "settling_time", ["1.395", "1.379", "1.379"]),
    ("fig5", "peak_speed", ["30.7", "30.7", "30.7"]),
    ("fig5", "peak_yaw_acceleration", ["1.43e4", "1.43e4", "1.43e4"]),
    ("fig6-inside", "settling_time", ["0.815", "0.795", "0.795"]),
    ("fig6-inside", "peak_yaw_acceleration", ["356e1", "3565", "3565"]),
    ("fig6-outside", "settling_time", ["0.979", "0.966", "0.966"]),
    ("fig6-outside", "peak_yaw_acceleration", ["544e1", "5445", "5445"]),
    ("fig6-on", "peak_yaw_acceleration", [None, None, "5.0"]),
    ("outside-turned", "peak_yaw_acceleration", [None, "3.39e5", None]),
    ("outside-turned", "min_speed", [None, "0.067", None]),
    ("outside-d2", "rms_tail_error", ["5.63e-5", "5.1e-6", "7.6e-7"]),
    ("outside-d1", "rms_tail_error", ["1.20e-3", "4.7e-4", "4.0e-4"]),
    ("outside-rho1", "rms_tail_error", [None, None, "1e-10"]),
]
# Rounding alone: the order of operations decides, so that only the order of magnitude can be compared.
ROUNDING = [
    ("fig6-on", "linear", "peak_yaw_acceleration", 9e-9, 10.0),
    ("fig6-on", "saturation", "peak_yaw_acceleration", 5e-7, 10.0),
    ("outside-rho1", "linear", "rms_tail_error", 6e-15, 10.0),
    ("outside-rho1", "saturation", "rms_tail_error", 5e-14, 10.0),
]
CASES = [
    (scenario, law, metric, value)
    for scenario, metric, values in TABLE
    for law, value in zip(LAWS, values, strict=False)
    if value is not None
]


def metric_of(comparison, scenario, law, metric):
    run = next(one for one in comparison.runs if one.planned.name == f"{scenario}/{law}")
    assert run.status.state == "ok"
    return run.metrics.as_dict()[metric]


def within_printed_digits(measured: float, printed: str) -> bool:
    number = Decimal(printed)
    half = Decimal((0, (5,), int(number.as_tuple().exponent) - 1))
    return abs(Decimal(measured) - number) <= half


def test_the_comparison_of_digits_itself():
    assert within_printed_digits(1.3954, "1.395") and not within_printed_digits(1.3956, "1.395")
    assert within_printed_digits(14349.0, "1.43e4") and not within_printed_digits(14351.0, "1.43e4")


@pytest.mark.parametrize(("scenario", "law", "metric", "printed"), CASES)
def test_native_simulation(paper_runs, scenario, law, metric, printed):
    assert within_printed_digits(metric_of(paper_runs, scenario, law, metric), printed)


@pytest.mark.parametrize(("scenario", "law", "metric", "value", "factor"), ROUNDING)
def test_what_is_rounding_stays_rounding(paper_runs, scenario, law, metric, value, factor):
    assert metric_of(paper_runs, scenario, law, metric) < factor * value


@pytest.fixture(scope="module")
def through_the_fmu(paper, tmp_path_factory):
    names = ("fig5", "fig6-on", "outside-d2")
    chosen = tuple(one for one in paper.scenarios if one.name in names)
    return run_study(
        paper.model_copy(update={"scenarios": chosen}), engine="fmpy", folder=tmp_path_factory.mktemp("fmu")
    )


@pytest.mark.parametrize(
    ("scenario", "law", "metric", "printed"), [one for one in CASES if one[0] in ("fig5", "fig6-on", "outside-d2")]
)
def test_fmu(through_the_fmu, scenario, law, metric, printed):
    assert within_printed_digits(metric_of(through_the_fmu, scenario, law, metric), printed)


def test_fmu_and_native_simulation_agree(through_the_fmu):
    assert len(through_the_fmu.runs) == 9
    for run in through_the_fmu.runs:
        assert run.agreement.agrees or run.agreement.explanation, run.agreement
        if run.planned.scenario != "fig6-on":
            assert run.agreement.position < 1e-10
            assert set(run.agreement.differences) == set(run.trajectory.data_vars)


def test_predicted_residuals_are_those_of_the_runs(paper, paper_runs):
    from brunovsky.comparison.residuals import predicted_residual

    for scenario, tolerance in (("outside-d1", 0.02), ("outside-d2", 1e-3)):
        for law in paper.laws:
            run = next(one for one in paper_runs.runs if one.planned.name == f"{scenario}/{law.name}")
            expected = predicted_residual(run.planned, law)
            if scenario == "outside-d2" and law.kind == "sign":
                assert expected == 0.0
            else:
                assert run.metrics.rms_tail_error == pytest.approx(expected, rel=tolerance)
