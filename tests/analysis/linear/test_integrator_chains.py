"""The chains as python-control systems: structure, labels, and the motion they make."""

import control
import numpy as np
import pytest

from brunovsky import analysis
from brunovsky.errors import ParameterError


def test_chain_is_an_integrator_chain_with_labels():
    system = analysis.chain(3)
    assert isinstance(system, control.StateSpace)
    np.testing.assert_array_equal(system.A, [[0, 1, 0], [0, 0, 1], [0, 0, 0]])
    np.testing.assert_array_equal(system.B, [[0], [0], [1]])
    np.testing.assert_array_equal(system.C, np.eye(3))
    assert system.input_labels == ["v"]
    assert system.state_labels == system.output_labels == ["Z[1]", "Z[2]", "Z[3]"]
    assert system.name == "chain"


@pytest.mark.parametrize("order", [1, 2, 3, 5])
def test_chain_answers_a_step_with_the_powers_of_time(order):
    t = np.linspace(0.0, 2.0, 21)
    response = control.forced_response(analysis.chain(order), t, np.ones((1, t.size)), squeeze=False)
    factorials = np.cumprod(np.arange(1, order + 1))
    for k in range(order):
        power = order - k
        np.testing.assert_allclose(response.outputs[k], t**power / factorials[power - 1], atol=1e-12)


def test_chains_are_decoupled_and_labelled_like_the_fmus():
    system = analysis.chains((3, 2), name="two_axes")
    assert system.name == "two_axes"
    assert system.input_labels == ["v[1]", "v[2]"]
    assert system.output_labels == ["Z1[1]", "Z1[2]", "Z1[3]", "Z2[1]", "Z2[2]"]
    np.testing.assert_array_equal(system.A[:3, :3], analysis.chain(3).A)
    np.testing.assert_array_equal(system.A[3:, 3:], analysis.chain(2).A)
    assert not system.A[:3, 3:].any() and not system.A[3:, :3].any()
    assert np.linalg.matrix_rank(control.ctrb(system.A, system.B)) == 5


def test_chains_can_be_interconnected_by_their_labels():
    K = analysis.place([-1, -2, -3])
    law = control.ss([], [], [], -K[None, :], inputs=[f"Z1[{k}]" for k in (1, 2, 3)], outputs=["v[1]"], name="law")
    closed = control.interconnect([analysis.chains((3,)), law], inputs=["v[1]"], outputs=["Z1[1]"])
    np.testing.assert_allclose(np.sort(closed.poles().real), [-3, -2, -1], atol=1e-9)


def test_error_dynamics_close_the_loop():
    system = analysis.error_dynamics([2500, 550, 15])
    np.testing.assert_array_equal(system.A, [[0, 1, 0], [0, 0, 1], [-2500, -550, -15]])
    assert system.input_labels == ["w"]
    assert system.output_labels == ["e[1]", "e[2]", "e[3]"]
    np.testing.assert_allclose(system.dcgain()[:, 0], [1 / 2500, 0, 0], atol=1e-15)


@pytest.mark.parametrize("order", [0, -1, 2.5, True, "3", None])
def test_bad_orders_are_refused(order):
    with pytest.raises(ParameterError, match="positive integer"):
        analysis.chain(order)


def test_no_chains_are_refused():
    with pytest.raises(ParameterError, match="empty"):
        analysis.chains(())
