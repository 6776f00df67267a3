"""The loop cut at the actuators: exact forms, the linearisation by hand, and the nonlinear robot at the margins."""

from collections import deque
from math import cos, hypot, pi, sin

import control
import numpy as np
import pytest
import sympy as sp
from hypothesis import given, settings
from hypothesis import strategies as st

import brunovsky as br
from brunovsky import analysis
from brunovsky.analysis import SteadyMotion
from brunovsky.blocks import TIME, Block, Diagram, Input, Output, Parameter, State, symbol
from brunovsky.errors import ParameterError

PAPER = np.array([2500.0, 550.0, 15.0])
LINE, CIRCLE = SteadyMotion(0.5, heading=0.4), SteadyMotion(2**0.5 * 0.5, 0.5)
k1, k2, k3 = sp.symbols("k1 k2 k3", real=True)
s = sp.Symbol("s")


def symbolic():
    loop = analysis.opened_loop()
    same = {}
    for matrix, gain in zip(loop.gains, (k1, k2, k3), strict=True):
        same |= dict(zip(matrix, sp.eye(2) * gain, strict=True))
    return (part.subs(same) for part in (loop.A, loop.B, loop.C)), loop.speed, loop.yaw_rate


def typed_slope(state, u1, u2):
    _, _, theta, eta1, eta2 = state
    return (-eta1 * sin(theta), eta1 * cos(theta), eta2, u1, u2)


def typed_law(state, u1, reference, gain=PAPER):
    """Commands u2 and w1 typed by hand from the corrected (12) to (16), with chains from the model."""
    x, y, theta, eta1, eta2 = state
    S, C = sin(theta), cos(theta)
    chains = (
        (x, -eta1 * S, -eta1 * eta2 * C - u1 * S),
        (y, eta1 * C, -eta1 * eta2 * S + u1 * C),
    )
    v = [
        wanted[3] - sum(k * (have - want) for k, have, want in zip(gain, chain, wanted[:3], strict=True))
        for chain, wanted in zip(chains, reference, strict=True)
    ]
    a = v[0] - (eta2**2 * eta1 * S - 2 * eta2 * u1 * C)
    b = v[1] - (-(eta2**2) * eta1 * C - 2 * eta2 * u1 * S)
    return -(a * C + b * S) / eta1, -a * S + b * C


def typed_reference(motion, t):
    """Position and three derivatives of each axis of a steady motion through the origin of time."""
    V, w, h = motion.speed, motion.yaw_rate, motion.heading
    if w == 0.0:
        return (-V * sin(h) * t, -V * sin(h), 0.0, 0.0), (V * cos(h) * t, V * cos(h), 0.0, 0.0)
    R, a = V / w, w * t + h
    return (R * cos(a), -V * sin(a), -V * w * cos(a), V * w**2 * sin(a)), (
        (R * sin(a), V * cos(a), -V * w * sin(a), -V * w**2 * cos(a))
    )


# ---- exact forms


def test_the_linearisation_is_the_same_at_every_heading():
    heading = sp.Symbol("theta_d", real=True)
    turned, straight = analysis.opened_loop(heading), analysis.opened_loop()
    for name in ("A", "B", "C"):
        difference = (getattr(turned, name) - getattr(straight, name)).applyfunc(sp.simplify)
        assert difference == sp.zeros(*difference.shape)
    assert not straight.A.has(heading) and not straight.C.has(heading)


def test_both_loops_closed_give_the_chains_seen_from_the_turning_frame():
    (A, B, C), speed, yaw_rate = symbolic()
    closed = (A + B * C).charpoly(s).as_expr(s)
    p = s**3 + k3 * s**2 + k2 * s + k1
    turned = sp.expand(p.subs(s, s + sp.I * yaw_rate) * p.subs(s, s - sp.I * yaw_rate))
    assert sp.expand(closed - turned) == 0
    assert not closed.has(speed)


def test_straight_line_in_closed_form():
    K = [3.0, 5.0, 4.0]
    for speed in (0.1, -2.0):
        motion = SteadyMotion(speed, heading=1.1)
        yaw, forward = (analysis.actuator_loop_transfer(K, motion, i) for i in (2, 1))
        expected = analysis.loop_transfer(K)
        np.testing.assert_allclose(yaw.num[0][0], expected.num[0][0], rtol=1e-14)
        np.testing.assert_allclose(yaw.den[0][0], expected.den[0][0], rtol=1e-14)
        np.testing.assert_allclose(forward.num[0][0], [5.0, 3.0], rtol=1e-14)
        np.testing.assert_allclose(forward.den[0][0], [1.0, 4.0, 0.0, 0.0], rtol=1e-14)


def test_at_u2_on_a_straight_line_the_margins_are_those_at_v():
    assert analysis.loop_margins(analysis.actuator_loop_transfer(PAPER, LINE, 2)) == analysis.margins(PAPER)


def test_at_u1_on_a_straight_line_routh_gives_the_lag_margin_and_no_gain_margin():
    m = analysis.loop_margins(analysis.actuator_loop_transfer(PAPER, LINE, 1))
    assert (m.gain_lower, m.gain_upper) == (0.0, np.inf)  # k3 k2 > k1 whatever the factor
    tau = sp.Symbol("tau", positive=True)
    a4, a3, a2, a1, a0 = tau, 1 + 15 * tau, 15, 550, 2500
    routh = a3 * a2 * a1 - a4 * a1**2 - a3**2 * a0
    smallest = min(root for root in sp.Poly(routh, tau).nroots() if root.is_real and root > 0)
    assert m.lag == pytest.approx(float(smallest), rel=1e-9)


def test_unequal_gains_on_a_straight_line_depend_on_the_heading():
    slow = np.array([250.0, 150.0, 15.0])
    for heading, sideways in ((0.0, PAPER), (pi / 2, slow), (pi, PAPER)):  # at 0 the robot moves along y, yaw acts on x
        loop = analysis.actuator_loop_transfer([PAPER, slow], SteadyMotion(1.0, heading=heading), 2)
        np.testing.assert_allclose(loop.num[0][0], analysis.loop_transfer(sideways).num[0][0], rtol=1e-12)
    between = analysis.actuator_loop_transfer([PAPER, slow], SteadyMotion(1.0, heading=0.7), 2)
    assert len(between.den[0][0]) == 7  # all six states take part
    np.testing.assert_allclose(
        np.sort_complex(np.roots(np.polyadd(between.num[0][0], between.den[0][0]))),
        np.sort_complex(np.concatenate([analysis.closed_loop_poles(one) for one in (PAPER, slow)])),
        rtol=1e-6,
    )


@settings(max_examples=20)
@given(
    st.floats(-10.0, -0.5),
    st.floats(-10.0, -0.5),
    st.floats(0.5, 30.0),
    st.floats(-30.0, 30.0),
    st.sampled_from([1, 2]),
)
def test_margins_on_any_circle_are_the_first_loss_of_stability(real, sigma, omega, yaw_rate, actuator):
    gain = analysis.place([real, complex(sigma, omega), complex(sigma, -omega)])
    loop = analysis.actuator_loop_transfer(gain, SteadyMotion(0.7, yaw_rate), actuator)
    m = analysis.loop_margins(loop)
    top, bottom = loop.num[0][0], loop.den[0][0]

    def abscissa(factor=1.0, lag=0.0, lags=1):
        behind = np.poly1d([lag, 1.0]) ** lags if lag else np.poly1d([1.0])
        return np.max(np.roots(np.polyadd(factor * top, np.polymul(bottom, behind.coeffs))).real)

    poles = [one + turn for one in analysis.closed_loop_poles(gain) for turn in (1j * yaw_rate, -1j * yaw_rate)]
    found = np.roots(np.polyadd(top, bottom))  # those that do not cancel
    assert all(np.min(np.abs(np.array(poles) - one)) < 1e-3 * (1 + abs(one)) for one in found)
    highest = min(m.gain_upper, 100.0)
    for part in (0.001, 0.1, 0.5, 0.9, 0.999):
        assert abscissa(m.gain_lower + (1 - m.gain_lower) * part) < 1e-7
        assert abscissa(1 + (highest - 1) * part) < 1e-7
        assert abscissa(lag=min(m.lag, 10.0) * part) < 1e-7
        assert abscissa(lag=min(m.two_lags, 10.0) * part, lags=2) < 1e-7
    if m.gain_lower > 1e-3:
        assert abscissa(m.gain_lower * 0.999) > -1e-7
    if np.isfinite(m.gain_upper):
        assert abscissa(m.gain_upper * 1.001) > -1e-7
    if np.isfinite(m.lag):
        assert abscissa(lag=m.lag * 1.001) > -1e-7
    if np.isfinite(m.two_lags):
        assert abscissa(lag=m.two_lags * 1.001, lags=2) > -1e-7


def test_a_narrow_resonance_hides_no_lag_margin():
    """Two poles of the opened loop 0.04 1/s from the axis, where the phase turns within a percent of the frequency."""
    loop = analysis.actuator_loop_transfer(analysis.place([-0.6875, -10 + 1j, -10 - 1j]), SteadyMotion(0.7, 30.0), 1)
    margin = analysis.loop_margins(loop).lag
    for lag, stable in ((0.999 * margin, True), (1.001 * margin, False)):
        poles = np.roots(np.polyadd(loop.num[0][0], np.polymul(loop.den[0][0], [lag, 1.0])))
        assert (np.max(poles.real) < 0) == stable


# ---- against the equations typed by hand


@pytest.mark.parametrize("heading", [0.0, 0.7, 2.5, -1.9])
@pytest.mark.parametrize("motion", [LINE, CIRCLE, SteadyMotion(-1.2, 3.0)], ids=["line", "circle", "backward"])
def test_matrices_are_the_differences_of_the_typed_equations(motion, heading):
    V, w = motion.speed, motion.yaw_rate
    along = SteadyMotion(V, w, heading)
    reference = typed_reference(along, 0.0)
    nominal = np.array([reference[0][0], reference[1][0], heading, V, w, 0.0, 0.0, 0.0])  # ..., u1, actuators

    def everything(z):
        state, u1, applied = z[:5], z[5], z[6:]
        u2, w1 = typed_law(state, u1, reference)
        return np.array([*typed_slope(state, *applied), w1, u1, u2])

    columns = []
    for k in range(8):
        step = np.zeros(8)
        step[k] = 1e-5
        columns.append((everything(nominal + step) - everything(nominal - step)) / 2e-5)
    jacobian = np.array(columns).T
    frame = np.eye(6)
    frame[:2, :2] = [[-sin(heading), cos(heading)], [-cos(heading), -sin(heading)]]
    turning = np.zeros((6, 6))
    turning[0, 1], turning[1, 0] = w, -w
    loop = analysis.actuator_loop(PAPER, along)
    np.testing.assert_allclose(loop.A, frame @ jacobian[:6, :6] @ frame.T + turning, atol=1e-5)
    np.testing.assert_allclose(loop.B, frame @ jacobian[:6, 6:], atol=1e-9)
    np.testing.assert_allclose(-loop.C, jacobian[6:, :6] @ frame.T, atol=1e-4)


@pytest.mark.parametrize("motion", [LINE, CIRCLE], ids=["line", "circle"])
@pytest.mark.parametrize("actuator", [1, 2])
def test_one_loop_is_the_matrix_with_the_other_one_closed(motion, actuator):
    both = analysis.actuator_loop(PAPER, motion)
    points = 1j * np.logspace(-1, 3, 40)
    L = both(points)
    i, j = actuator - 1, 2 - actuator
    expected = L[i, i] - L[i, j] * L[j, i] / (1 + L[j, j])
    np.testing.assert_allclose(analysis.actuator_loop_transfer(PAPER, motion, actuator)(points), expected, rtol=1e-8)


def test_return_difference_is_one_plus_the_loop():
    loop = analysis.actuator_loop(PAPER, CIRCLE)
    difference = analysis.return_difference(loop)
    np.testing.assert_allclose(difference(7j), np.eye(2) + loop(7j), rtol=1e-12)
    response = control.singular_values_response(difference, np.logspace(0, 2, 200))
    smallest = np.min(response.magnitude)
    single = min(analysis.loop_margins(analysis.actuator_loop_transfer(PAPER, CIRCLE, i)).modulus for i in (1, 2))
    assert 0.0 < smallest < 1.0
    assert analysis.disk_margin(loop).radius < single * 2  # both at once never tolerate more than one alone
    for i in (1, 2):
        alone = analysis.disk_margin(analysis.actuator_loop_transfer(PAPER, CIRCLE, i))
        assert analysis.disk_margin(loop).radius <= alone.radius * (1 + 1e-9)


# ---- the nonlinear robot with an imperfect actuator


def line_reference(motion):
    V, h = motion.speed, motion.heading
    values = {
        f"Z{i}d[{k}]": sp.sympify(z).diff(TIME, k - 1)
        for i, z in ((1, -V * sin(h) * TIME), (2, V * cos(h) * TIME))
        for k in (1, 2, 3)
    }
    units = {1: "m", 2: "m/s", 3: "m/s2"}
    outputs = [Output(name, units[int(name[-2])], "reference", value) for name, value in values.items()]
    return Block("line", outputs=(*outputs, *(Output(f"zd3[{i}]", "m/s3", "reference", sp.S.Zero) for i in (1, 2))))


def imperfect(unit, kind):
    """Actuator with a wrong gain ``factor``, or behind a first-order lag of time constant ``lag``."""
    command, q = symbol("command"), symbol("q")
    value = Parameter(kind, "1" if kind == "factor" else "s", "", 1.0, 0.0)
    states = (State("q", unit, "", derivative=(command - q) / value.symbol),) if kind == "lag" else ()
    output = Output("u", unit, "", q if states else value.symbol * command)
    return Block("actuator", inputs=(Input("command", unit),), parameters=(value,), states=states, outputs=(output,))


def robot_with(actuator, block):
    """The shipped robot and inner loop with a block between the command and the plant's input."""
    robot = br.blocks.linearized_robot()
    plant, inner = robot.components["plant"], robot.components["inner_loop"]
    name = f"u[{actuator}]"
    return Diagram(
        "imperfect_robot",
        "robot with an imperfect actuator",
        components={**robot.components, "actuator": block},
        connections={**robot.connections, f"plant.{name}": "actuator.u", "actuator.command": f"inner_loop.{name}"},
        inputs={one: f"inner_loop.{one}" for one in ("v[1]", "v[2]")}
        | {one: f"plant.{one}" for one in ("d[1]", "d[2]")},
        outputs={one.name: f"plant.{one.name}" for one in plant.outputs}
        | {one.name: f"inner_loop.{one.name}" for one in inner.outputs},
        parameters={one.name: f"plant.{one.name}" for one in plant.parameters if "_start" in one.name}
        | {one.name: f"actuator.{one.name}" for one in block.parameters},
    )


def simulated_growth(motion, actuator, kind, value):
    """Rate at which the position error of a small start grows in the nonlinear robot, in 1/s."""
    seconds = 8.0
    block = imperfect(("m/s2", "rad/s2")[actuator - 1], kind)
    reference = br.blocks.circle() if motion.yaw_rate else line_reference(motion)
    start = typed_reference(motion, 0.0)
    parameters = {
        "x_start": start[0][0] + 1e-7,
        "y_start": start[1][0] - 2e-7,
        "theta_start": motion.heading,
        "eta_start[1]": motion.speed,
        "eta_start[2]": motion.yaw_rate,
        kind: value,
    }
    loop = br.blocks.closed_loop(br.blocks.pole_placement(), plant=robot_with(actuator, block), reference=reference)
    run = br.simulate(loop, seconds, step_size=5e-4, parameters=parameters, record=["e1[1]", "e2[1]"])
    return growth(np.hypot(run["e1[1]"], run["e2[1]"]).values, seconds)


def growth(error, seconds):
    quarter = len(error) // 4
    first, last = np.max(error[quarter : 2 * quarter]), np.max(error[-quarter:])
    return np.log(last / first) / (seconds / 2)


def predicted_growth(motion, actuator, *, factor=1.0, lag=0.0):
    loop = analysis.actuator_loop_transfer(PAPER, motion, actuator)
    return np.max(control.feedback(loop * control.tf([factor], [lag, 1] if lag else [1]), 1).poles().real)


@pytest.mark.parametrize("motion", [LINE, CIRCLE], ids=["line", "circle"])
def test_the_gain_margin_at_u2_is_where_the_nonlinear_robot_loses_stability(motion):
    margin = analysis.loop_margins(analysis.actuator_loop_transfer(PAPER, motion, 2)).gain_lower
    for factor, stable in ((0.93 * margin, False), (1.07 * margin, True)):
        found = simulated_growth(motion, 2, "factor", factor)
        assert (found < 0) == stable
        assert found == pytest.approx(predicted_growth(motion, 2, factor=factor), rel=0.1)


@pytest.mark.parametrize("motion", [LINE, CIRCLE], ids=["line", "circle"])
@pytest.mark.parametrize("actuator", [1, 2])
def test_the_lag_margin_at_u_is_where_the_nonlinear_robot_loses_stability(motion, actuator):
    margin = analysis.loop_margins(analysis.actuator_loop_transfer(PAPER, motion, actuator)).lag
    for lag, stable in ((0.9 * margin, True), (1.1 * margin, False)):
        found = simulated_growth(motion, actuator, "lag", lag)
        assert (found < 0) == stable
        assert found == pytest.approx(predicted_growth(motion, actuator, lag=lag), rel=0.1)


@pytest.mark.parametrize("actuator", [1, 2])
@pytest.mark.parametrize("motion", [LINE, CIRCLE], ids=["line", "circle"])
def test_the_delay_margin_at_u_is_where_the_typed_robot_loses_stability(motion, actuator):
    margin = analysis.loop_margins(analysis.actuator_loop_transfer(PAPER, motion, actuator)).delay
    assert delayed_growth(motion, actuator, 0.95 * margin) < -0.05
    assert delayed_growth(motion, actuator, 1.05 * margin) > 0.05


def delayed_growth(motion, actuator, delay, step=2.5e-4, seconds=6.0):
    """Semi-implicit steps of the typed equations, the command held for a step (half a step of delay more)."""
    start = typed_reference(motion, 0.0)
    state, u1 = [start[0][0] + 1e-7, start[1][0] - 2e-7, motion.heading, motion.speed, motion.yaw_rate], 0.0
    waiting = deque([0.0] * round(delay / step - 0.5))
    errors = []
    for k in range(round(seconds / step)):
        reference = typed_reference(motion, k * step)
        errors.append(hypot(state[0] - reference[0][0], state[1] - reference[1][0]))
        u2, w1 = typed_law(state, u1, reference)
        applied = [u1, u2]
        waiting.append(applied[actuator - 1])
        applied[actuator - 1] = waiting.popleft()
        first = typed_slope(state, *applied)
        middle = [x + step / 2 * slope for x, slope in zip(state, first, strict=True)]
        state = [x + step * slope for x, slope in zip(state, typed_slope(middle, *applied), strict=True)]
        u1 += step * w1
    return growth(np.array(errors), seconds)


# ---- references and refusals


def test_steady_motion_of_the_shipped_circle_and_of_a_line():
    found = analysis.steady_motion(br.blocks.circle())
    assert (found.speed, found.yaw_rate, found.heading) == pytest.approx((2**0.5 * 0.5, 0.5, 0.0))
    faster = analysis.steady_motion(br.blocks.circle(), {"rate": -2.0, "radius": 3.0, "phase": 0.3})
    assert (faster.speed, faster.yaw_rate) == pytest.approx((6.0, -2.0))
    straight = analysis.steady_motion(line_reference(LINE))
    assert (straight.speed, straight.yaw_rate, straight.heading) == pytest.approx((0.5, 0.0, 0.4))


def moving(x, y):
    return Block("reference", outputs=(Output("Z1d[1]", "m", "", x), Output("Z2d[1]", "m", "", y)))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: SteadyMotion(0.0), "singular"),
        (lambda: SteadyMotion(np.nan), "not finite"),
        (lambda: analysis.steady_motion(br.blocks.circle(), {"radius": 0.0}), "stands still"),
        (lambda: analysis.steady_motion(moving(TIME**2, TIME)), "speed that changes.*no transfer function"),
        (lambda: analysis.steady_motion(moving(sp.sin(TIME), sp.sin(2 * TIME))), "changes with time"),
        (lambda: analysis.steady_motion(moving(sp.Piecewise((TIME, TIME > 3), (0, True)), TIME)), "besides time"),
        (lambda: analysis.steady_motion(br.blocks.robot()), "functions of time alone"),
        (lambda: analysis.steady_motion("circle"), "functions of time alone"),
        (lambda: analysis.actuator_loop(PAPER, (0.5, 0.0)), "SteadyMotion"),
        (lambda: analysis.actuator_loop([PAPER, 2 * PAPER], CIRCLE), "periodic in time"),
        (lambda: analysis.actuator_loop([1, 2], LINE), "shape"),
        (lambda: analysis.actuator_loop([1, 2, np.inf], LINE), "finite"),
        (lambda: analysis.actuator_loop("fast", LINE), "real numbers"),
        (lambda: analysis.actuator_loop_transfer(PAPER, LINE, 3), "pass 1 for u1"),
        (lambda: analysis.return_difference("L"), "square"),
    ],
)
def test_bad_input_is_refused_with_a_remedy(call, message):
    with pytest.raises(ParameterError, match=message):
        call()
