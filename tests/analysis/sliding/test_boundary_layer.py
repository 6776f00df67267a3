"""Boundary layer: what it leaves under a matched disturbance, against native simulation of the robot."""

import control
import matplotlib.pyplot as plt
import numpy as np
import pytest
import sympy as sp
import xarray as xr

import brunovsky as br
from brunovsky import analysis
from brunovsky.blocks import TIME, Block, Output
from brunovsky.errors import ParameterError

C, Q, P, SPEED = (500.0, 10.0, 1.0), 5.0, 2.5, 0.5


def straight_line():
    """Along y at constant speed, heading 0: d2 then acts on axis 1 as -speed d2."""
    values = {"Z1d": (0, 0, 0), "Z2d": (SPEED * TIME, SPEED, 0)}
    units = ("m", "m/s", "m/s2")
    outputs = [
        Output(f"{name}[{k + 1}]", units[k], "", sp.sympify(one))
        for name, chain in values.items()
        for k, one in enumerate(chain)
    ]
    return Block("line", outputs=(*outputs, *(Output(f"zd3[{i}]", "m/s3", "", sp.S.Zero) for i in (1, 2))))


def simulated(disturbance, phi):
    """S and e of axis 1 that the disturbance leaves."""
    loop = br.blocks.closed_loop(reference=straight_line())
    start = {"x_start": 0.0, "y_start": 0.0, "eta_start[1]": SPEED, "phi": phi, "P": P, "Q": Q}
    inputs = {"d[2]": -disturbance / SPEED}
    run = br.simulate(loop, 4.0, step_size=2e-4, parameters=start, inputs=inputs, record=["S[1]", "e1[1]"])
    return float(run["S[1]"][-1]), float(run["e1[1]"][-1])


@pytest.mark.parametrize(
    ("disturbance", "phi", "inside"), [(1.0, 0.05, True), (-1.0, 0.5, True), (2.6, 0.1, True), (2.6, 0.01, False)]
)
def test_accuracy_against_simulation(disturbance, phi, inside):
    found = analysis.boundary_layer_trade_off(C, Q, P, disturbance, [phi]).isel(phi=0)
    S, error = simulated(disturbance, phi)
    assert bool(found["inside"]) == inside == (abs(S) <= phi)
    assert pytest.approx(float(found["sliding_variable"]), rel=1e-5) == S
    assert error == pytest.approx(float(found["position_error"]), rel=1e-5)


def test_margins_are_those_within_the_layer_and_trade_against_accuracy():
    phi = np.logspace(-2, 0, 12)
    data = analysis.boundary_layer_trade_off(C, Q, P, 1.0, phi)
    for one in phi:
        m = analysis.margins(analysis.boundary_layer_gain(C, Q, P, one))
        row = data.sel(phi=one)
        assert (row["lag_margin"], row["delay_margin"]) == (m.lag, m.delay)
        assert (row["gain_lower"], row["max_sensitivity"]) == (m.gain_lower, m.max_sensitivity)
        assert row["bandwidth"] == pytest.approx(Q + P / one)
        poles = analysis.closed_loop_poles(analysis.boundary_layer_gain(C, Q, P, one))
        assert np.min(np.abs(poles + float(row["bandwidth"]))) < 1e-5 * float(row["bandwidth"])
    assert np.all(np.diff(data["position_error"]) > 0)
    assert np.all(np.diff(data["lag_margin"]) < 0)  # a thinner layer is more accurate, and takes a longer lag ...
    assert data["delay_margin"][0] < data["delay_margin"][6]  # ... but a shorter delay


def test_both_branches_meet_where_the_layer_is_just_filled():
    phi = 0.02
    D = P + Q * phi
    around = [
        float(analysis.boundary_layer_trade_off(C, Q, P, d, [phi])["sliding_variable"][0]) for d in (D - 1e-9, D + 1e-9)
    ]
    assert around == pytest.approx([phi, phi], rel=1e-6)


def test_a_surface_of_either_sign_leaves_the_same_position_error():
    minus = analysis.boundary_layer_trade_off(np.negative(C), Q, P, 1.0, [0.1])
    plus = analysis.boundary_layer_trade_off(C, Q, P, 1.0, [0.1])
    assert float(minus["position_error"][0]) == pytest.approx(float(plus["position_error"][0]))
    assert float(minus["sliding_variable"][0]) == pytest.approx(-float(plus["sliding_variable"][0]))


def test_units_and_figure():
    data = analysis.boundary_layer_trade_off(C, Q, P, 2.6, np.logspace(-3, 0, 20))
    assert data["phi"].attrs["units"] == data["sliding_variable"].attrs["units"] == "m/s2"
    assert all({"units", "long_name"} <= set(one.attrs) for one in data.values())
    plot = analysis.boundary_layer_plot(data)
    assert isinstance(plot, control.ControlPlot) and plot.axes.shape == (2, 1)
    assert plot.axes[0, 0].get_ylabel() == "steady error (m)" and "m/s2" in plot.axes[1, 0].get_xlabel()
    assert len(plot.lines[0, 0]) == 2 and len(plot.lines[1, 0]) == 2  # widths that the disturbance leaves are marked
    plt.close("all")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: analysis.boundary_layer_trade_off(C, Q, P, 1.0, [0.1, 0.0]), "phi > 0"),
        (lambda: analysis.boundary_layer_trade_off(C, 0.0, P, 1.0, [0.1]), "Q > 0"),
        (lambda: analysis.boundary_layer_trade_off(C, Q, -P, 1.0, [0.1]), "P >= 0"),
        (lambda: analysis.boundary_layer_trade_off(C, Q, P, np.inf, [0.1]), "disturbance"),
        (lambda: analysis.boundary_layer_trade_off((-1.0, 10.0, 1.0), Q, P, 1.0, [0.1]), "stable"),
        (lambda: analysis.boundary_layer_trade_off((1.0,), Q, P, 1.0, [0.1]), "at least 2"),
        (lambda: analysis.boundary_layer_plot(xr.Dataset()), "boundary_layer_trade_off"),
    ],
)
def test_bad_input_is_refused_with_a_remedy(call, message):
    with pytest.raises(ParameterError, match=message):
        call()
