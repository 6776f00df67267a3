"""The robot behind sensors and actuators: each effect by itself, all together, and where the loop loses stability."""

import math

import numpy as np
import pytest

import brunovsky as br
from brunovsky import analysis
from brunovsky.errors import ModelError, ParameterError

B = br.blocks
U = (B.Variable("u[1]", "m/s2", "forward"), B.Variable("u[2]", "rad/s2", "yaw"))
LINE = {"heading": 0.3, "theta_start": 0.3, "speed": 0.5, "eta_start[1]": 0.5, "x_start": 0.05, "P": 0.0}
EVERYTHING = {"lags": 0.002, "number": 2, "delays": [0.004, 0.006], "limits": [2.0, 40.0], "period": 0.002,
              "noisy": True, "matched": True}  # fmt: skip


def on_a_line(plant, t_end=1.0, parameters=None, controller=None, **options):
    loop = B.closed_loop(controller, plant=plant, reference=B.line())
    known = {one.name for one in loop.parameters}
    values = {name: value for name, value in LINE.items() if name in known} | (parameters or {})
    return br.simulate(loop, t_end, parameters=values, **options)


def wave(time):
    return np.array([math.sin(7 * one + 1) for one in np.atleast_1d(time)])


def test_without_effects_it_is_the_linearized_robot():
    found, usual = on_a_line(B.robot_with_hardware()), on_a_line(B.linearized_robot())
    for name in usual:
        np.testing.assert_array_equal(found[name], usual[name])
    block, plain = B.robot_with_hardware(), B.linearized_robot()
    assert [one.name for one in block.inputs] == [one.name for one in plain.inputs]
    assert [one.name for one in block.parameters] == [one.name for one in plain.parameters]
    assert (len(block.states), block.samples, len(block.relations)) == (len(plain.states), (), len(plain.relations))


def test_lags_alone_are_the_robot_with_lags():
    found = on_a_line(B.robot_with_hardware(lags=[0.01, 0.02], number=2))
    usual = on_a_line(B.robot_with_lags([0.01, 0.02], number=2))
    assert set(found) == set(usual)
    for name in usual:
        np.testing.assert_array_equal(found[name], usual[name])


def test_names_and_units_of_everything():
    block = B.robot_with_hardware(**EVERYTHING)
    assert [(one.name, one.unit) for one in block.inputs] == [
        ("v[1]", "m/s3"), ("v[2]", "m/s3"), ("dv[1]", "m/s3"), ("dv[2]", "m/s3"), ("d[1]", "m/s2"), ("d[2]", "rad/s2"),
        ("n[1]", "m"), ("n[2]", "m"), ("n[3]", "rad"), ("n[4]", "m/s"), ("n[5]", "rad/s"),
    ]  # fmt: skip
    usual = B.linearized_robot()
    names = [one.name for one in block.outputs]
    assert names[: len(usual.outputs)] == [one.name for one in usual.outputs]
    assert names[len(usual.outputs) :] == [
        "u_command[1]", "u_command[2]", "x_measured", "y_measured", "theta_measured", "eta_measured[1]",
        "eta_measured[2]", "v_acting[1]", "v_acting[2]",
    ]  # fmt: skip
    own = {one.name: (one.value, one.unit) for one in block.parameters}
    for one in usual.parameters:
        assert own.pop(one.name) == (one.value, one.unit)
    assert own == {
        "u_start[2]": (0.0, "rad/s2"), "sampling_period": (0.002, "s"), "delay[1]": (0.004, "s"),
        "delay[2]": (0.006, "s"), "lag[1]": (0.002, "s"), "lag[2]": (0.002, "s"), "u1_max": (2.0, "m/s2"),
        "u2_max": (40.0, "rad/s2"),
    }  # fmt: skip


# ---- delay


@pytest.mark.parametrize(("delay", "cells"), [(0.01, 10), (0.013, 5), (0.002, 1)])
def test_a_delay_shifts_what_is_commanded(delay, cells):
    """Exactly at the instants of the register, to second order between, and u_start before the delay has passed."""
    block = B.actuator_delays(U, [delay, 0.0], cells=cells)
    step = delay / cells / 4
    times = np.arange(401) * step
    data = br.simulate(
        block, times[-1], step_size=step, parameters={"u_start[1]": wave(0.0)[0]},
        inputs={"u_command[1]": wave(times), "u_command[2]": 3.0},
    )  # fmt: skip
    expected = np.where(times > delay - step / 2, wave(times - delay), wave(0.0))
    np.testing.assert_allclose(data["u[1]"].values[::4], expected[::4], atol=1e-12)
    np.testing.assert_allclose(data["u[1]"], expected, atol=1.01 * (7 * delay / cells) ** 2 / 8)
    np.testing.assert_array_equal(data["u[2]"], 3.0)


@pytest.mark.parametrize("ratio", [1, 3, 0.5, 1.25])
def test_held_commands_are_delayed_exactly(ratio):
    h, step = 0.02, 0.005
    block = B.actuator_series(B.actuator_holds(U, h), B.actuator_delays(U, [ratio * h, 0.0], period=h))
    times = np.arange(200) * step
    data = br.simulate(block, times[-1], step_size=step, inputs={f"u_command[{i}]": wave(times) for i in (1, 2)})
    late = round(ratio * h / step)
    np.testing.assert_array_equal(data["u[1]"].values[late:], data["u[2]"].values[:-late])
    np.testing.assert_array_equal(data["u[1]"].values[:late], 0.0)
    np.testing.assert_array_equal(data["u[2]"].values, wave(times)[np.arange(200) // 4 * 4])


def test_the_delay_is_a_parameter():
    at_two = on_a_line(B.robot_with_hardware(delays=0.002))
    same = on_a_line(B.robot_with_hardware(delays=0.005), parameters={"delay[1]": 0.002, "delay[2]": 0.002})
    np.testing.assert_allclose(same["x"], at_two["x"], rtol=1e-12)
    assert abs(same["x"] - on_a_line(B.robot_with_hardware(delays=0.005))["x"]).max() > 1e-4


# ---- saturation


def test_saturation_keeps_the_limits_and_lets_small_signals_pass():
    block = B.actuator_limits(U, [2.0, np.inf])
    times = np.linspace(0, 3, 301)
    data = br.simulate(block, 3.0, step_size=0.01, inputs={f"u_command[{i}]": 3 * wave(times) for i in (1, 2)})
    np.testing.assert_array_equal(data["u[1]"], np.clip(3 * wave(times), -2.0, 2.0))
    np.testing.assert_array_equal(data["u[2]"], 3 * wave(times))
    free = on_a_line(B.robot_with_hardware(limits=[1e3, 1e3]))
    usual = on_a_line(B.linearized_robot())
    np.testing.assert_allclose(free["x"], usual["x"], rtol=1e-12)
    tight = on_a_line(B.robot_with_hardware(limits=[0.2, 10.0]), t_end=2.0)
    for name, limit in (("u[1]", 0.2), ("u[2]", 10.0)):
        assert float(abs(tight[name]).max()) == limit < float(abs(tight[name.replace("u", "u_command")]).max())
        np.testing.assert_array_equal(tight[name], np.clip(tight[name.replace("u", "u_command")], -limit, limit))


# ---- sampling


def test_sampled_commands_are_constant_between_samples_and_follow_at_once():
    run = on_a_line(B.robot_with_hardware(period=0.004))
    for name in ("u[1]", "u[2]", "v_acting[1]", "x_measured", "eta_measured[2]", "Z1[1]", "Z2[2]"):
        rows = run[name].values[:-1].reshape(-1, 4)
        assert (rows == rows[:, :1]).all() and len(np.unique(rows)) > 100
    at = slice(0, None, 4)
    for held, source in (("x_measured", "x"), ("eta_measured[2]", "eta[2]"), ("v_acting[1]", "v[1]"),
                         ("u[1]", "u_command[1]"), ("u[2]", "u_command[2]")):  # fmt: skip
        np.testing.assert_array_equal(run[held].values[at], run[source].values[at])


def test_the_sampled_loop_is_the_computer_s_program():
    """Measure, law, command, Euler's step of the compensator, written out, against the block."""
    h, V = 0.004, 0.5
    law = {"K[1]": 2500.0, "K[2]": 550.0, "K[3]": 15.0}
    run = on_a_line(B.robot_with_hardware(period=h), controller=B.pole_placement(), parameters=law, step_size=h / 4)
    u1 = 0.0
    for k in range(100):
        now = {name: float(run[name][4 * k]) for name in ("x", "y", "theta", "eta[1]", "eta[2]", "u[1]", "u[2]")}
        s, c, e1, e2 = math.sin(now["theta"]), math.cos(now["theta"]), now["eta[1]"], now["eta[2]"]
        velocity = (-e1 * s, e1 * c)
        acceleration = (-u1 * s - e1 * e2 * c, u1 * c - e1 * e2 * s)
        v = [
            -2500 * (now[name] - reference * V * k * h) - 550 * (velocity[i] - reference * V) - 15 * acceleration[i]
            for i, (name, reference) in enumerate((("x", -math.sin(0.3)), ("y", math.cos(0.3))))
        ]
        assert now["u[1]"] == pytest.approx(u1, rel=1e-9, abs=1e-9)
        assert now["u[2]"] == pytest.approx((-v[0] * c - v[1] * s - 2 * u1 * e2) / e1, rel=1e-9, abs=1e-6)
        u1 += h * (-v[0] * s + v[1] * c + e1 * e2**2)


def test_a_short_period_tends_to_the_continuous_loop_at_first_order():
    usual = on_a_line(B.linearized_robot(), step_size=2.5e-4)
    differences = []
    for period in (0.002, 0.001, 0.0005):
        run = on_a_line(B.robot_with_hardware(period=0.001), parameters={"sampling_period": period}, step_size=2.5e-4)
        differences.append(float(abs(run["x"] - usual["x"]).max()))
    assert np.log2(differences[0] / differences[1]) == pytest.approx(1.0, abs=0.15)
    assert np.log2(differences[1] / differences[2]) == pytest.approx(1.0, abs=0.08)


def test_a_sampled_law_of_the_same_period_sees_what_is_measured_at_the_same_instant():
    law = B.sliding_mode_sampled(period=0.004)
    run = on_a_line(B.robot_with_hardware(period=0.004), controller=law)
    np.testing.assert_array_equal(run["v[1]"], run["v_acting[1]"])
    errors = [run[f"e1[{k}]"].values[0] for k in (1, 2, 3)]
    s = np.dot([500, 10, 1], errors)
    assert run["S[1]"].values[0] == pytest.approx(s)
    # implicit law with P = 0 at this instant, not a sample later: S' = -Q S
    expected = -5 * s - 500 * errors[1] - 10 * errors[2]
    assert run["v[1]"].values[0] == pytest.approx(expected)


# ---- noise and matched disturbance


NOISE = {"n[1]": 0.01, "n[2]": -0.02, "n[3]": 0.03, "n[4]": -0.04, "n[5]": 0.05}


@pytest.mark.parametrize("period", [None, 0.004])
def test_the_law_sees_the_noise(period):
    gains = {"K[1]": 2500.0, "K[2]": 550.0, "K[3]": 15.0}
    run = on_a_line(
        B.robot_with_hardware(noisy=True, period=period), controller=B.pole_placement(), inputs=NOISE,
        parameters=gains | {"eta_start[2]": 0.1, "u_start[1]": 0.2}, t_end=0.01,
    )  # fmt: skip
    first = run.isel(time=0)
    theta, e1, e2, u1 = 0.33, 0.46, 0.15, 0.2
    chains = {
        1: (0.06, -e1 * math.sin(theta), -u1 * math.sin(theta) - e1 * e2 * math.cos(theta)),
        2: (-0.02, e1 * math.cos(theta), u1 * math.cos(theta) - e1 * e2 * math.sin(theta)),
    }
    v = {}
    for i, slope in ((1, -0.5 * math.sin(0.3)), (2, 0.5 * math.cos(0.3))):
        assert [float(first[f"Z{i}[{k}]"]) for k in (1, 2, 3)] == pytest.approx(chains[i])
        z, dz, ddz = chains[i]
        v[i] = -2500 * z - 550 * (dz - slope) - 15 * ddz
    u2 = -(v[1] * math.cos(theta) + v[2] * math.sin(theta) + 2 * u1 * e2) / e1
    assert float(first["u[2]"]) == pytest.approx(u2)
    assert [float(first[name]) for name in ("x", "theta", "eta[2]")] == pytest.approx([0.05, 0.3, 0.1])
    assert float(first["position_error[1]"]) == pytest.approx(0.05)
    assert float(first["position_error[2]"]) == pytest.approx(0.0)
    assert float(first["e1[1]"]) == pytest.approx(0.06)
    np.testing.assert_allclose(run["position_error[2]"], run["y"] - 0.5 * math.cos(0.3) * run["time"], atol=1e-12)


def test_a_law_on_the_robot_s_posture_gets_what_is_measured():
    loop = B.closed_loop(B.polar_sliding_mode(), plant=B.robot_with_hardware(noisy=True))
    read = {one.name for one in B.polar_sliding_mode().inputs} & {"x", "y", "theta", "eta[1]", "eta[2]"}
    assert read
    for name in read:
        stem, bracket, index = name.partition("[")
        assert loop.connections[f"controller.{name}"] == f"plant.{stem}_measured{bracket}{index}"


@pytest.mark.parametrize("size", [0.0, 4.0])
def test_a_matched_disturbance_adds_to_v(size):
    plant = B.robot_with_hardware(matched=True)
    apart = br.simulate(plant, 0.5, inputs={"v[1]": 1.0, "dv[1]": size, "v[2]": 0.5, "dv[2]": -size})
    together = br.simulate(B.linearized_robot(), 0.5, inputs={"v[1]": 1.0 + size, "v[2]": 0.5 - size})
    for name in together:
        np.testing.assert_array_equal(apart[name], together[name])
    np.testing.assert_array_equal(apart["v_acting[2]"], 0.5 - size)


# ---- all together


def test_engines_agree_with_everything_on():
    loop = B.closed_loop(plant=B.robot_with_hardware(**EVERYTHING), reference=B.line())
    rng = np.random.default_rng(1)
    inputs = {f"n[{i}]": 1e-3 * rng.standard_normal(301) for i in range(1, 6)} | {"dv[1]": 1.0, "d[2]": 0.3}
    values = LINE | {"P": 2.5}
    native, plain = (
        br.simulate(loop, 0.3, parameters=values, inputs=inputs, engine=one) for one in ("native", "numpy")
    )
    assert float(native["u[2]"].max()) == 40.0
    for name in native:
        one, other = native[name].values.astype(float), plain[name].values.astype(float)
        np.testing.assert_allclose(one, other, atol=1e-11 * abs(other).max() + 1e-15)


# ---- margins


def grows(loop, name, start, seconds=12.0, window=1.0, **options):
    error = abs(br.simulate(loop, seconds, parameters=start, record=[name], **options)[name])
    early, late = (float(error.sel(time=slice(t - window, t)).max()) for t in (seconds / 2, seconds))
    return late > early


@pytest.mark.parametrize("effect", ["lag", "delay"])
@pytest.mark.parametrize("actuator", [1, 2])
def test_stability_on_the_circle_is_lost_at_the_margin(actuator, effect):
    """Figure 6's linear loop; the margins come from the loop that `actuator_loop_transfer` derives by linearisation."""
    gain, motion = analysis.sliding_gain([500, 10, 1], 5), analysis.steady_motion(B.circle())
    margin = getattr(analysis.loop_margins(analysis.actuator_loop_transfer(gain, motion, actuator)), effect)
    options = {"lags": [0.0, 0.0], "delays": [0.0, 0.0]}
    options[f"{effect}s"][actuator - 1] = margin
    loop = B.closed_loop(plant=B.robot_with_hardware(**options), reference=B.circle())
    circle = br.simulate(B.circle(), 1e-3).isel(time=0)
    start = {"P": 0.0, "x_start": float(circle["Z1d[1]"]) + 1e-6, "y_start": float(circle["Z2d[1]"]),
             "eta_start[1]": motion.speed, "eta_start[2]": motion.yaw_rate, "theta_start": motion.heading}  # fmt: skip
    for factor, unstable in ((0.9, False), (1.1, True)):
        assert grows(loop, "e1[1]", start | {f"{effect}[{actuator}]": factor * margin}) == unstable


# ---- refusals


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (lambda: B.robot_with_hardware(delays=-0.1), ParameterError, "delays in s"),
        (lambda: B.robot_with_hardware(delays=np.inf), ParameterError, "delays in s"),
        (lambda: B.robot_with_hardware(delays=1e-9), ParameterError, "1e-09 s; give delays"),
        (lambda: B.robot_with_hardware(delays="long"), ParameterError, "delays in s"),
        (lambda: B.robot_with_hardware(delays=[0.1, 0.1, 0.1]), ModelError, "one for each"),
        (lambda: B.robot_with_hardware(delays=0.0031415, period=0.002), ParameterError, "does not fit"),
        (lambda: B.robot_with_hardware(delays=30.0, period=0.002), ParameterError, "1000 parts"),
        (lambda: B.robot_with_hardware(lags=-0.1), ParameterError, "time constants in s"),
        (lambda: B.robot_with_hardware(number=0), ModelError, "at least one"),
        (lambda: B.robot_with_hardware(limits=-1.0), ParameterError, "limits from 0 on"),
        (lambda: B.robot_with_hardware(limits=[1.0, np.nan]), ParameterError, "limits from 0 on"),
        (lambda: B.robot_with_hardware(limits=[1.0, 1.0, 1.0]), ModelError, "one for each"),
        (lambda: B.robot_with_hardware(period=0.0), ParameterError, "sampling period"),
        (lambda: B.robot_with_hardware(period="fast"), ParameterError, "sampling period"),
        (lambda: B.actuator_delays(U, cells=0), ModelError, "whole number"),
        (lambda: B.actuator_delays(()), ModelError, "at least one"),
        (lambda: B.actuator_holds(()), ModelError, "at least one"),
        (lambda: B.actuator_limits((), 1.0), ModelError, "at least one"),
        (lambda: B.actuator_series(), ModelError, "at least one"),
        (lambda: B.actuator_series(B.actuator_lags(U), B.actuator_lags(U)), ModelError, "names that differ"),
        (lambda: B.sensors(()), ModelError, "at least one"),
        (lambda: B.errors(positions=("x",)), ModelError, "one for each"),
        (lambda: br.linearized_block(B.robot_linearization(), sensors=5), ModelError, "no block"),
        (lambda: br.linearized_block(B.robot_linearization(), sensors=B.sensors(U)), ModelError, "no input"),
        (lambda: br.linearized_block(B.robot_linearization(), inputs=B.circle()), ModelError, r"v\[1\]"),
        (
            lambda: br.simulate(B.robot_with_hardware(period=0.002, delays=0.002), 0.1, parameters={"delay[1]": 0.003}),
            ParameterError,
            r"delay\[1\] is not 1 of sampling_period",
        ),
    ],
)  # fmt: skip
def test_bad_input_is_refused_with_a_remedy(call, kind, message):
    with pytest.raises(kind, match=message):
        call()
