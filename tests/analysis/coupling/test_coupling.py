"""Coupled components: orders of convergence, the limit of the communication step, the bound of the error."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

import brunovsky as br
from brunovsky import analysis as an
from brunovsky.analysis.coupling.master import stepping_order
from brunovsky.analysis.coupling.scheme import shifted
from brunovsky.errors import ModelError, ParameterError, SimulationError

GAIN = an.sliding_gain([500.0, 10.0, 1.0], 5.0)
FIGURE_6 = {"x_start": 2.5, "eta_start[1]": 0.5}
ON_CIRCLE = {"x_start": 2**0.5, "eta_start[1]": 2**-0.5, "eta_start[2]": 0.5, "P": 0.0}


@pytest.fixture(scope="module")
def system() -> br.Diagram:
    return br.fmi.robot_system()


def test_the_paper_s_gains_admit_12_ms_at_once_and_40_ms_in_sequence() -> None:
    assert an.largest_communication_step(GAIN) == pytest.approx(0.0124, abs=1e-4)
    assert an.largest_communication_step(GAIN, "gauss_seidel") == pytest.approx(0.0405, abs=1e-4)


@pytest.mark.parametrize("step", [1e-3, 0.01, 0.05])
def test_held_inputs_are_the_textbook_discrete_loop(step: float) -> None:
    """Sampled state feedback behind a hold, and with one sample of delay."""
    A, B = np.eye(3, k=1), np.eye(3)[:, -1:]
    both = expm(step * np.block([[A, B], [np.zeros((1, 4))]]))
    transition, hold = both[:3, :3], both[:3, 3:]
    expected = np.block([[transition, hold], [-GAIN[np.newaxis], np.zeros((1, 1))]])
    np.testing.assert_allclose(an.coupled_step_matrix(GAIN, step), expected, rtol=1e-12, atol=1e-15)
    sampled = np.append(np.linalg.eigvals(transition - hold * GAIN), 0.0)
    eigenvalues = np.linalg.eigvals(an.coupled_step_matrix(GAIN, step, "gauss_seidel"))
    np.testing.assert_allclose(np.poly(eigenvalues), np.poly(sampled), atol=1e-9)


@pytest.mark.parametrize("scheme", ["jacobi", "gauss_seidel"])
@pytest.mark.parametrize("order", [0, 1, 2, 3])
def test_the_dominant_eigenvalues_tend_to_the_closed_loop_s(scheme: str, order: int) -> None:
    step = 1e-3
    poles = np.roots([1.0, *GAIN[::-1]])
    found = np.linalg.eigvals(an.coupled_step_matrix(GAIN, step, scheme, order))
    for pole in poles:
        error = np.min(np.abs(found - np.exp(step * pole)))
        assert error < (step * np.max(np.abs(poles))) ** (order + 2)


@pytest.mark.parametrize("scheme", ["jacobi", "gauss_seidel"])
@pytest.mark.parametrize("order", [0, 1])
@pytest.mark.parametrize("factor", [0.98, 1.02])
def test_simulated_errors_grow_as_the_eigenvalues_say(
    system: br.Diagram, scheme: str, order: int, factor: float
) -> None:
    step = factor * an.largest_communication_step(GAIN, scheme, order)
    runs = [
        an.coupled_simulation(system, 200 * step, step, scheme=scheme, order=order, parameters=ON_CIRCLE | start)
        for start in ({}, {"x_start": 2**0.5 + 1e-9})
    ]
    apart = np.abs((runs[1]["x"] - runs[0]["x"]).values)
    growth = (apart[150:].max() / apart[60:111].max()) ** (1 / 90)
    assert (growth > 1) == (factor > 1)
    assert growth == pytest.approx(an.spectral_radius(GAIN, step, scheme, order), abs=0.011)


@pytest.mark.parametrize("scheme", ["jacobi", "gauss_seidel"])
@pytest.mark.parametrize("order", [0, 1, 2])
def test_derivatives_raise_the_order(system: br.Diagram, scheme: str, order: int) -> None:
    steps = (4e-3, 2e-3, 1e-3)
    errors = an.coupling_errors(
        system, 0.16, steps, schemes=[scheme], orders=[order], step_size=2e-4, parameters=FIGURE_6 | {"P": 0.0}
    )
    assert [one.communication_step for one in errors] == list(steps)
    assert an.measured_order(errors, 4e-3) == pytest.approx(order + 1, abs=0.2)


def test_in_sequence_is_three_times_as_accurate(system: br.Diagram) -> None:
    """Mean ages of v: 3h/2 at once, h/2 in sequence."""
    at_once, in_sequence = an.coupling_errors(
        system, 0.2, [5e-4], orders=[0], watched=["x"], parameters=FIGURE_6, step_size=1e-3
    )
    alone = br.simulate(system, 0.2, step_size=1e-3, parameters=FIGURE_6)["x"].values[-51:]
    for one in (at_once, in_sequence):
        assert one.monolithic_band == pytest.approx(np.abs(alone).max(), rel=1e-6)
        assert 0.0 < abs(one.band - one.monolithic_band) <= one.error
    assert at_once.error / in_sequence.error == pytest.approx(3.0, abs=0.15)


def test_the_bound_holds_and_is_no_luxury(system: br.Diagram) -> None:
    step = 1e-3
    whole = br.simulate(system, 0.4, parameters=FIGURE_6)
    parts = an.coupled_simulation(system, 0.4, step, parameters=FIGURE_6)
    for z, v in (("x", "v[1]"), ("y", "v[2]")):
        bound = an.coupling_error_bound(whole["time"], whole[v], GAIN, step)
        error = np.abs(parts[z].values - whole[z].values)
        assert 0.3 * bound.max() < error.max() < bound.max()


def test_before_the_first_step_inputs_agree_with_outputs(system: br.Diagram) -> None:
    first = an.coupled_simulation(system, 1e-3, 1e-3, parameters=FIGURE_6).isel(time=0)
    whole = br.simulate(system, 1e-3, parameters=FIGURE_6).isel(time=0)
    for name in ("x", "v[1]", "v[2]", "S[1]"):
        assert float(first[name]) == pytest.approx(float(whole[name]), rel=1e-12)


def test_booleans_and_units_are_kept(system: br.Diagram) -> None:
    run = an.coupled_simulation(system, 0.01, 5e-3)
    assert run["singular"].dtype == bool and run["v[1]"].attrs["units"] == "m/s3" and run.sizes["time"] == 3


def test_a_failed_step_tells_when_and_keeps_the_trajectory(system: br.Diagram) -> None:
    with pytest.raises(SimulationError, match=r"coupled_simulation: .*not finite") as caught:
        an.coupled_simulation(system, 100.0, 0.1, parameters=FIGURE_6)
    done = caught.value.trajectory
    assert 1 < done.sizes["time"] < 1000 and float(done["time"][-1]) == pytest.approx(caught.value.time)


def test_a_start_that_fails_is_told_as_well(system: br.Diagram) -> None:
    with pytest.raises(SimulationError, match="eta_min > 0") as caught:
        an.coupled_simulation(system, 1.0, 0.01, parameters={"eta_min": 0.0, "eta_start[1]": 0.0})
    assert caught.value.trajectory is None and caught.value.time == 0.0


def test_shifting_back_and_forth_changes_nothing() -> None:
    signals = np.array([[1.0, 2.0], [3.0, 4.0], [5.0, 6.0], [7.0, 8.0]])
    np.testing.assert_allclose(shifted(shifted(signals, 0.3), -0.3), signals, rtol=1e-12)
    assert shifted(signals, 2.0)[0, 0] == pytest.approx(1 + 3 * 2 + 5 * 4 / 2 + 7 * 8 / 6)


def test_the_figure_has_a_line_for_each_scheme_and_order() -> None:
    errors = [
        an.CouplingError(scheme, order, step, step ** (order + 1) if step < 0.03 else math.inf)
        for scheme in ("jacobi", "gauss_seidel")
        for order in (0, 1)
        for step in (0.01, 0.02, 0.04)
    ]
    plot = an.coupling_error_plot(errors, limits={"limit": 0.0124})
    lines = plot.lines[0, 0]
    assert len(lines) == 4 and all(len(one.get_xdata()) == 2 for one in lines)
    assert len({(one.get_linestyle(), one.get_marker()) for one in lines}) == 4
    assert an.measured_order(errors[3:6], 1.0) == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda d: an.coupled_simulation(d, 1.0, 0.0), ParameterError, "communication_step > 0"),
        (
            lambda d: an.coupled_simulation(d, 1.0, 0.1, scheme="seidel"),
            ParameterError,
            "use 'jacobi' or 'gauss_seidel'",
        ),
        (lambda d: an.coupled_simulation(d, 1.0, 0.1, order=4), ParameterError, "0 to 3"),
        (lambda d: an.coupled_simulation(d, 1.0, 0.1, parameters={"PP": 1}), ParameterError, "'PP'"),
        (lambda _: an.coupled_simulation(br.blocks.circle(), 1.0, 0.1), ModelError, "two components or more"),
        (lambda d: an.coupling_errors(d, 1.0, [0.1], outputs=["z"]), ParameterError, "not all outputs"),
        (lambda _: an.largest_communication_step([-1.0, 1.0, 1.0]), ParameterError, "stable"),
        (lambda _: an.measured_order([an.CouplingError("jacobi", 0, 0.1, 1.0)], 1.0), ParameterError, "fewer than two"),
        (lambda _: an.coupling_error_bound([0, 1, 3], [1, 2, 3], GAIN, 0.1), ParameterError, "equidistant"),
    ],
)
def test_what_cannot_be_coupled_is_refused(system: br.Diagram, call, error, message) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(error, match=message):
        call(system)


@pytest.mark.parametrize(
    ("given", "direct", "order"),
    [
        ("abc", [], "abc"),
        ("cba", [("a", "b"), ("b", "c")], "abc"),
        ("cba", [("a", "b")], "cab"),
        ("bac", [("a", "b"), ("b", "a")], "cba"),  # an algebraic loop: as given, last
        ("ab", [("a", "a"), ("b", "a")], "ba"),
    ],
)
def test_components_step_after_those_that_drive_them_directly(
    given: str, direct: list[tuple[str, str]], order: str
) -> None:
    assert "".join(stepping_order(given, direct)) == order
