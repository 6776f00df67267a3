"""The paper's relatives: their theory at random points, and the laws on the robot."""

import math
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import fmpy
import numpy as np
import pytest
import sympy as sp
import xarray as xr
from scipy.linalg import solve_continuous_are

import brunovsky as br
from brunovsky.blocks import TIME, Block, Diagram, Input, Output, State, symbol, symbols
from brunovsky.errors import ParameterError, SimulationError

OUTER = ("flat_sliding_mode", "second_order_sliding_mode", "sliding_sector")
POSTURE = ("polar_sliding_mode", "backstepping")
LAWS = (*OUTER, *POSTURE)
SMALL = {"x_start": 1.5, "y_start": 0.05, "theta_start": 0.1, "eta_start[1]": 0.6}
FIGURE_5 = {
    **{"x_start": 8.5, "y_start": 7.5, "theta_start": -3 * math.pi / 4, "eta_start[1]": 1.0},
    **{"radius": 0.0, "center[1]": 5.0, "center[2]": 3.0},
}


@cache
def loop_of(name: str) -> Diagram:
    law = getattr(br.blocks, name)()
    return br.blocks.closed_loop(law, name=name) if name in OUTER else br.blocks.posture_loop(law, name=name)


def distance(data: xr.Dataset) -> np.ndarray:
    return np.hypot(data["e1[1]"].values, data["e2[1]"].values)


def evaluator(block: Block, *names: str) -> Callable[[Mapping[str, float]], np.ndarray]:
    """Outputs of a block as a function of a point, by variable; relations follow the point, parameters are defaults."""
    outputs = {one.name: one.expression for one in block.outputs}
    expressions = [outputs[name] for name in names]
    for one in reversed(block.relations):
        expressions = [expression.xreplace({one.symbol: one.expression > 0}) for expression in expressions]
    variables = (*block.inputs, *block.modes, *block.parameters)
    function = sp.lambdify([TIME, *(one.symbol for one in variables)], expressions, "numpy", cse=True)
    defaults = {"time": 0.0} | {one.name: getattr(one, "value", 0.0) for one in variables}

    def evaluate(point: Mapping[str, float]) -> np.ndarray:
        assert set(point) <= set(defaults)
        with np.errstate(all="ignore"):  # in branches that are not taken
            return np.array([float(one) for one in function(*map(np.float64, (defaults | dict(point)).values()))])

    return evaluate


def chain_points(count: int, scale: float = 1.0) -> list[dict[str, float]]:
    random = np.random.default_rng(7)
    names = [f"Z{i}{end}[{k}]" for i in (1, 2) for end in ("", "d") for k in (1, 2, 3)] + ["zd3[1]", "zd3[2]"]
    return [dict(zip(names, row, strict=True)) for row in scale * random.normal(size=(count, len(names)))]


def chain_errors(point: Mapping[str, float]) -> np.ndarray:
    """Shape (2, 3)."""
    return np.array([[point[f"Z{i}[{k}]"] - point[f"Z{i}d[{k}]"] for k in (1, 2, 3)] for i in (1, 2)])


def integrators(law: Block) -> Diagram:
    """The law on two bare chains of integrators with a disturbance p of the jerk, about the origin."""
    plant = Block(
        "plant",
        inputs=tuple(Input(f"{name}[{i}]", "m/s3") for name in "vp" for i in (1, 2)),
        states=tuple(
            State(
                f"Z{i}[{k}]",
                "m" if k == 1 else "m/s" if k == 2 else "m/s2",
                derivative=symbol(f"Z{i}[{k + 1}]") if k < 3 else symbol(f"v[{i}]") + symbol(f"p[{i}]"),
                start=sp.Float((1.0, 0.3, -0.2, -0.6, 0.4, 0.5)[3 * i + k - 4]),
            )
            for i in (1, 2)
            for k in (1, 2, 3)
        ),
        outputs=tuple(
            Output(f"Z{i}[{k}]", ("m", "m/s", "m/s2")[k - 1], expression=symbol(f"Z{i}[{k}]"))
            for i in (1, 2)
            for k in (1, 2, 3)
        ),
    )
    references = [one.name for one in law.inputs if one.name[2] == "d" or one.name.startswith("zd3")]
    return Diagram(
        f"{law.name}_on_integrators",
        components={"plant": plant, "law": law},
        connections={"plant.v": "law.v", "law.Z1": "plant.Z1", "law.Z2": "plant.Z2"},
        inputs={f"p[{i}]": f"plant.p[{i}]" for i in (1, 2)} | {name: f"law.{name}" for name in references},
        outputs={one.name: f"plant.{one.name}" for one in plant.outputs}
        | {one.name: f"law.{one.name}" for one in law.outputs},
        parameters={one.name: f"law.{one.name}" for one in law.parameters},
    )


# ---- on the robot


@pytest.mark.parametrize("start", [SMALL, {}, {"x_start": 0.7}], ids=["near", "outside", "inside"])
@pytest.mark.parametrize("name", LAWS)
def test_tracks_the_paper_s_circle(name: str, start: dict[str, float]) -> None:
    error = distance(br.simulate(loop_of(name), 20.0, parameters=start))
    assert np.sqrt((error[-5000:] ** 2).mean()) < 1e-4
    assert error[0] > 0.08


@pytest.mark.parametrize("name", OUTER)
def test_outer_loops_regulate_from_the_start_of_figure_5(name: str) -> None:
    error = distance(br.simulate(loop_of(name), 10.0, parameters=FIGURE_5))
    assert error[0] > 5 and error[-2000:].max() < 1e-3


@pytest.mark.parametrize("name", POSTURE)
def test_laws_on_the_accelerations_regulate_by_turning(name: str) -> None:
    """The set point of figure 5, from rest as well."""
    values = FIGURE_5 | {"rest_heading": -3 * math.pi / 4}
    for start in ({}, {"eta_start[1]": 0.0}):
        data = br.simulate(loop_of(name), 30.0, parameters=values | start)
        assert distance(data)[-5000:].max() < 1e-3
        assert abs(data["theta"].values[-5000:] - values["rest_heading"]).max() < 1.3


def test_backstepping_without_swing_leaves_a_set_point_at_its_side_alone() -> None:
    values = FIGURE_5 | {"rest_heading": -3 * math.pi / 4, "swing": 0.0, "eta_start[1]": 0.0}
    error = distance(br.simulate(loop_of("backstepping"), 5.0, parameters=values | {"x_start": 5.5, "y_start": 3.5}))
    assert error == pytest.approx(math.hypot(0.5, 0.5), rel=1e-9)


@pytest.mark.parametrize("name", POSTURE)
def test_laws_on_the_accelerations_start_from_rest_with_any_heading(name: str) -> None:
    for heading in (-2.0, 0.5, 2.5, 9.0):
        start = {"eta_start[1]": 0.0, "theta_start": heading}
        data = br.simulate(loop_of(name), 40.0, parameters=start, record=["e1[1]", "e2[1]"])
        assert distance(data)[-1] < 1e-3


def test_posture_loop_records_what_closed_loop_does() -> None:
    closed, posture = br.blocks.closed_loop(), br.blocks.posture_loop()
    elsewhere = {"singular", "S[1]", "S[2]", "v[1]", "v[2]"}
    assert {one.name for one in closed.outputs} - elsewhere <= {one.name for one in posture.outputs}
    assert {one.name for one in posture.inputs} == {"d[1]", "d[2]"}
    data = br.simulate(posture, 2.0, step_size=1e-3)
    for low, high in (("e1[1]", "e1[2]"), ("e1[2]", "e1[3]"), ("e2[1]", "e2[2]"), ("e2[2]", "e2[3]")):
        slope = (data[low].values[2:] - data[low].values[:-2]) / 2e-3
        assert slope == pytest.approx(data[high].values[1:-1], abs=2e-3)


# ---- flatness-based multivariable sliding mode


def test_unit_vector_makes_the_norm_of_the_surface_decay_in_every_direction() -> None:
    law = evaluator(br.blocks.flat_sliding_mode(), "v[1]", "v[2]", "S[1]", "S[2]")
    for point in chain_points(50):
        for scale in (1.0, 1e-5):
            near = {
                name: point[name.replace("[", "d[")] + scale * value if name[2] == "[" else value
                for name, value in point.items()
            }
            values, e = law(near), chain_errors(near)
            v, surface = values[:2], values[2:]
            slope = 500 * e[:, 1] + 10 * e[:, 2] + v - [near["zd3[1]"], near["zd3[2]"]]
            size = np.linalg.norm(surface)
            expected = -5 * surface - 2.5 * surface / max(size, 0.05)
            assert slope == pytest.approx(expected, rel=1e-9, abs=1e-9)
            assert (size > 0.05) == (scale == 1.0)


def test_unit_vector_rejects_a_jerk_of_any_direction_below_its_gain() -> None:
    loop = integrators(br.blocks.flat_sliding_mode())
    for angle in (0.0, 0.8, 2.5):
        p = {"p[1]": 2.0 * math.cos(angle), "p[2]": 2.0 * math.sin(angle)}
        data = br.simulate(loop, 6.0, inputs=p)
        # in the layer: 0 = -(Q + P/phi) S + p
        assert np.hypot(data["S[1]"], data["S[2]"]).values[-1] == pytest.approx(2.0 / 55, rel=1e-3)


def test_without_switching_gain_unit_vector_is_the_paper_s_law() -> None:
    ours, paper = (br.blocks.closed_loop(law()) for law in (br.blocks.flat_sliding_mode, br.blocks.sliding_mode))
    one, other = (br.simulate(loop, 2.0, parameters={"P": 0.0}) for loop in (ours, paper))
    assert one["x"].values == pytest.approx(other["x"].values, abs=1e-10)


# ---- second-order sliding mode


def test_twisting_gives_its_second_order_dynamics_and_a_decreasing_function() -> None:
    law = evaluator(br.blocks.second_order_sliding_mode(), "v[1]", "v[2]", "S[1]", "S[2]", "S_rate[1]", "S_rate[2]")
    for point in (*chain_points(50), *chain_points(50, 0.05)):
        values, e = law(point), chain_errors(point)
        v, surface, rate = values[:2], values[2:4], values[4:]
        assert surface == pytest.approx(2 * e[:, 0] + e[:, 1])
        assert rate == pytest.approx(2 * e[:, 1] + e[:, 2])
        slope = 2 * e[:, 2] + v - [point["zd3[1]"], point["zd3[2]"]]
        switch = [np.clip(one / width, -1, 1) for one, width in ((surface, 0.1), (rate, 0.5))]
        assert slope == pytest.approx(-30 * switch[0] - 15 * switch[1], rel=1e-9, abs=1e-9)
        # V = r1 integral of sat(S/phi1) + S'^2/2
        assert (30 * switch[0] * rate + rate * slope <= 1e-9).all()


def test_twisting_converges_in_finite_time_against_a_jerk_below_its_bound() -> None:
    loop = integrators(br.blocks.second_order_sliding_mode())
    p = {"p[1]": lambda t: 10 * math.sin(3 * t), "p[2]": lambda t: -12.0}
    data = br.simulate(loop, 6.0, inputs=p)
    assert abs(data["S[1]"].values[-2000:]).max() < 0.1
    assert data["S[2]"].values[-1] == pytest.approx(-12 * 0.1 / 30, rel=1e-3)
    sharp = br.simulate(loop, 6.0, step_size=1e-4, inputs=p, parameters={"phi[1]": 0.0, "phi[2]": 0.0})
    settled = sharp["time"].values > 4
    assert abs(sharp["S[1]"].values[settled]).max() < 1e-4 and abs(sharp["S[2]"].values[settled]).max() < 1e-4
    assert abs(sharp["S_rate[2]"].values[settled]).max() < 0.05


def test_twisting_refuses_gains_that_do_not_converge() -> None:
    with pytest.raises(ParameterError, match=r"r\[1\] > r\[2\] > 0 only"):
        br.simulate(br.blocks.second_order_sliding_mode(), 1.0, parameters={"r[1]": 10.0})


# ---- sliding sector


def norm_matrix(weights: tuple[float, float, float] = (4096.0, 512.0, 16.0)) -> np.ndarray:
    return solve_continuous_are(np.eye(3, k=1), np.eye(3)[:, 2:], np.diag(weights), np.eye(1))


def test_sector_norm_decreases_with_and_without_control() -> None:
    P, Q, A = norm_matrix(), np.diag([4096.0, 512.0, 16.0]), np.eye(3, k=1)
    block = br.blocks.sliding_sector()
    law = evaluator(block, "v[1]", "v[2]", "S[1]", "S[2]")
    seen = {"off": 0, "on": 0}
    for point in chain_points(300):
        for active in (0, 1):
            values, errors = law(point | {"active[1]": active, "active[2]": active}), chain_errors(point)
            for v, s, e, feedforward in zip(
                values, values[2:], errors, [point["zd3[1]"], point["zd3[2]"]], strict=False
            ):
                assert s == pytest.approx(P[2] @ e)
                slope = 2 * (P @ e) @ (A @ e + np.array([0, 0, v - feedforward]))
                if not active and s**2 <= 0.5 * e @ Q @ e:
                    assert v == feedforward and slope <= -0.5 * e @ Q @ e * (1 - 1e-9)
                    seen["off"] += 1
                elif active and s**2 > 0.25 * 0.5 * e @ Q @ e:
                    assert slope <= -e @ Q @ e * (1 - 1e-9)
                    assert P[2] @ (A @ e) + P[2, 2] * (v - feedforward) == pytest.approx(-60 * s)
                    seen["on"] += 1
    assert min(seen.values()) > 50


def test_sector_norm_decreases_along_a_run_with_few_switches() -> None:
    data = br.simulate(integrators(br.blocks.sliding_sector()), 6.0, step_size=1e-4)
    for i in (1, 2):
        e = np.array([data[f"Z{i}[{k}]"].values for k in (1, 2, 3)])
        norm = np.einsum("kt,kl,lt->t", e, norm_matrix(), e)
        assert (np.diff(norm) < 0).all() and norm[-1] < 1e-8 * norm[0]
        active = data[f"active[{i}]"].values
        assert 2 <= np.count_nonzero(np.diff(active)) < 0.01 * active.size and 0.02 < active.mean() < 0.7


def test_sector_refuses_what_its_theory_does_not_cover() -> None:
    with pytest.raises(ParameterError, match=r"the norm decreases for K >= .* only"):
        br.simulate(br.blocks.sliding_sector(), 1.0, parameters={"K": 20.0})
    with pytest.raises(ParameterError, match="must be 3 positive numbers"):
        br.blocks.sliding_sector(weights=(1.0, 0.0, 1.0))
    with pytest.raises(ParameterError, match="must be 3 positive numbers"):
        br.blocks.sliding_sector(weights=(1.0, float("nan"), 1.0))
    with pytest.raises(ParameterError, match="ratio = 1"):
        br.blocks.sliding_sector(ratio=1.0)
    for wrong in (5, None, ("a", 1, 1)):
        with pytest.raises(ParameterError, match="are not numbers"):
            br.blocks.sliding_sector(weights=wrong)  # type: ignore
    with pytest.raises(ParameterError, match="no solution of the Riccati equation"):
        br.blocks.sliding_sector(weights=(1e-300, 1e300, 1.0))


# ---- the posture behind flat outputs


def test_posture_of_a_reference_is_the_robot_s_own_where_its_chains_are_the_reference() -> None:
    """Chains of a robot that drives forward, inserted for the reference, give back its heading, speeds and inputs."""
    theta, eta2, u1, u2, w1 = symbols("theta", "eta[2]", "u[1]", "u[2]", "w[1]")
    eta1 = sp.Symbol("eta1", positive=True)
    c, s = sp.cos(theta), sp.sin(theta)
    chains = {
        **{"Z1d[1]": 0, "Z1d[2]": -eta1 * s, "Z1d[3]": -eta1 * eta2 * c - u1 * s},
        **{"Z2d[1]": 0, "Z2d[2]": eta1 * c, "Z2d[3]": -eta1 * eta2 * s + u1 * c},
        "zd3[1]": eta2**2 * eta1 * s - 2 * eta2 * u1 * c - eta1 * u2 * c - w1 * s,
        "zd3[2]": -(eta2**2) * eta1 * c - 2 * eta2 * u1 * s - eta1 * u2 * s + w1 * c,
    }
    block = br.blocks.posture_reference()
    inserted = {symbol(name): value for name, value in chains.items()} | {
        one.symbol: sp.true for one in block.relations
    }
    found = [sp.simplify(one.expression.subs(inserted)) for one in block.outputs]
    assert found == [-s, c, eta1, eta2, u1, u2]


def test_posture_of_a_resting_reference_swings() -> None:
    values = {"rest_heading": 0.7, "swing": 0.4, "swing_rate": 3.0}
    data = br.simulate(br.blocks.posture_reference(), 2.0, parameters=values)
    time = data["time"].values
    angle = 0.7 + 0.4 * np.sin(3 * time)
    assert data["direction[1]"].values == pytest.approx(-np.sin(angle))
    assert data["direction[2]"].values == pytest.approx(np.cos(angle))
    assert data["eta_d[2]"].values == pytest.approx(1.2 * np.cos(3 * time))
    assert data["u_d[2]"].values == pytest.approx(-3.6 * np.sin(3 * time))
    assert not data["eta_d[1]"].any() and not data["u_d[1]"].any()


# ---- laws on the accelerations: derivatives along the motion, by differences


def motion(random: np.random.Generator, *, resting: bool) -> Callable[[float, np.ndarray], dict[str, float]]:
    """Robot and reference near t = 0 as a function of time and the accelerations u; the equations typed by hand."""
    x, y, theta, eta1, eta2 = random.normal(size=5) * (1, 1, 3, 1, 1) + (3, -2, 0, 0, 0)
    a, w, phase = (0.0, 1.0, 0.0) if resting else random.uniform((0.5, 0.3, 0), (2, 1.5, 6))

    def at(time: float, u: np.ndarray) -> dict[str, float]:
        angle = w * time + phase
        wave = [(2 + a * math.cos(angle), -1 + 0.7 * a * math.sin(angle))]
        for k in (1, 2, 3):
            turn = angle + k * math.pi / 2
            wave.append((a * w**k * math.cos(turn), 0.7 * a * w**k * math.sin(turn)))
        reference = {f"Z{i}d[{k}]": wave[k - 1][i - 1] for i in (1, 2) for k in (1, 2, 3)}
        return reference | {
            **{"time": time, "zd3[1]": wave[3][0], "zd3[2]": wave[3][1]},
            **{"x": x - time * eta1 * math.sin(theta), "y": y + time * eta1 * math.cos(theta)},
            **{"theta": theta + time * eta2, "eta[1]": eta1 + time * u[0], "eta[2]": eta2 + time * u[1]},
        }

    return at


def slope_and_value(
    evaluate: Callable[[Mapping[str, float]], np.ndarray], at: Callable[[float, np.ndarray], dict[str, float]]
) -> tuple[np.ndarray, np.ndarray, dict[str, float]]:
    """Derivatives of what follows u in the outputs along the motion under that u, their values, and the point."""
    now = at(0.0, np.zeros(2))
    u, step = evaluate(now)[:2], 1e-5
    after, before = (evaluate(at(time, u))[2:] for time in (step, -step))
    return (after - before) / (2 * step), evaluate(now)[2:], now


@pytest.mark.parametrize("resting", [False, True])
def test_polar_surfaces_obey_their_reaching_law(resting: bool) -> None:
    random = np.random.default_rng(3)
    law = evaluator(br.blocks.polar_sliding_mode(), "u[1]", "u[2]", "S[1]", "S[2]")
    for _ in range(15):
        slope, surface, _ = slope_and_value(law, motion(random, resting=resting))
        expected = -5 * surface - 0.5 * np.clip(surface / 0.01, -1, 1)
        assert slope == pytest.approx(expected, rel=1e-4, abs=1e-4)


def test_polar_law_rejects_accelerations_below_its_switching_gains_and_backstepping_does_not() -> None:
    disturbances = {"d[1]": 0.3, "d[2]": -0.3}
    polar, stepped = (br.simulate(loop_of(name), 30.0, inputs=disturbances, parameters=SMALL) for name in POSTURE)
    # in the layer: 0 = -(Q + P/phi) S + d
    assert polar["S[1]"].values[-1] == pytest.approx(0.3 / 55, rel=1e-3)
    assert polar["S[2]"].values[-1] == pytest.approx(-0.3 / 55, rel=1e-3)
    assert distance(polar)[-1] < 0.2 * distance(stepped)[-1]
    narrow = br.simulate(
        loop_of(POSTURE[0]), 30.0, inputs=disturbances, parameters=SMALL | {"phi[1]": 0.001, "phi[2]": 0.001}
    )
    assert distance(narrow)[-1] == pytest.approx(0.1 * distance(polar)[-1], rel=0.15)


def test_polar_law_on_its_surface_is_stable_behind_a_circle_about_its_pole() -> None:
    """Eigenvalues of the error in the robot's frame, on S = 0, against those derived by hand."""
    surface = evaluator(br.blocks.polar_sliding_mode(), "S[1]", "S[2]")
    radius, rate, k1, k2, k3, g = 1.3, 0.6, 1.5, 2.5, 3.0, 0.8
    gains = {"k[1]": k1, "k[2]": k2, "k[3]": k3, "g": g}
    v = radius * rate
    reference = {"Z1d[1]": radius, "Z2d[2]": v, "Z1d[3]": -v * rate, "zd3[2]": -v * rate**2}

    def slope(error: np.ndarray) -> np.ndarray:
        ahead, left, turn = error
        theta = -turn  # reference at (radius, 0), driving along y
        h, n = np.array([-math.sin(theta), math.cos(theta)]), np.array([-math.cos(theta), -math.sin(theta)])
        x, y = np.array([radius, 0]) - ahead * h - left * n
        speed, yaw = -surface(gains | reference | {"x": x, "y": y, "theta": theta})
        return np.array([yaw * left - speed + v * math.cos(turn), v * math.sin(turn) - yaw * ahead, rate - yaw])

    jacobian = np.array([(slope(one) - slope(-one)) / 2e-5 for one in 1e-5 * np.eye(3)]).T
    expected = np.sort_complex([-k2, *np.roots([1, k3 + g * v, g * k1 * v])])
    assert np.sort_complex(np.linalg.eigvals(jacobian)) == pytest.approx(expected, abs=1e-6)
    assert expected.real.max() < 0


def test_polar_law_at_its_pole_says_so() -> None:
    with pytest.raises(SimulationError, match=r"undefined at its pole; set pole\[1\.\.2\]"):
        br.simulate(loop_of("polar_sliding_mode"), 1.0, parameters={"x_start": 0.0})


@pytest.mark.parametrize("resting", [False, True])
def test_backstepping_has_its_lyapunov_derivative(resting: bool) -> None:
    random = np.random.default_rng(5)
    law = evaluator(br.blocks.backstepping(), "u[1]", "u[2]", "V", "S[1]", "S[2]")
    k1, k2, k3, k4, gamma, g1, g2 = 2.0, 2.0, 5.0, 5.0, 4.0, 1.0, 1.0
    for _ in range(15):
        slope, (v, *s), at = slope_and_value(law, motion(random, resting=resting))
        h = np.array([-math.sin(at["theta"]), math.cos(at["theta"])])
        gap = np.array([at["Z1d[1]"] - at["x"], at["Z2d[1]"] - at["y"]])
        ahead, left = gap @ h, gap @ (-h[1], h[0])
        heading = 0.0 if resting else math.atan2(-at["Z1d[2]"], at["Z2d[2]"])
        sine, cosine = math.sin(heading - at["theta"]), math.cos(heading - at["theta"])
        assert v == pytest.approx(
            (ahead**2 + left**2) / 2 + (1 - cosine) / gamma + s[0] ** 2 / (2 * g1) + s[1] ** 2 / (2 * gamma * g2)
        )
        expected = -k1 * ahead**2 - k2 / gamma * sine**2 - k3 / g1 * s[0] ** 2 - k4 / (gamma * g2) * s[1] ** 2
        assert slope[0] == pytest.approx(expected, rel=1e-4, abs=1e-4) and expected <= 0


@pytest.mark.parametrize("values", [{}, FIGURE_5], ids=["circle", "set point"])
def test_backstepping_never_lets_its_lyapunov_function_grow(values: dict[str, float]) -> None:
    v = br.simulate(br.blocks.posture_loop(), 20.0, parameters=values)["V"].values
    assert (np.diff(v) <= 1e-9 * v[0]).all() and v[-1] < 1e-4 * v[0]


# ---- targets


@pytest.mark.parametrize("name", LAWS)
def test_engines_agree(name: str) -> None:
    loop = loop_of(name)
    native, numpy = (br.simulate(loop, 0.2, parameters=SMALL, engine=one) for one in ("native", "numpy"))
    for variable in native:
        scale = 1e-9 + abs(numpy[variable].values.astype(float)).max()
        assert abs(native[variable].astype(float) - numpy[variable].astype(float)).max() < 1e-9 * scale


@pytest.mark.parametrize(
    "name",
    [pytest.param(one, marks=() if one == "sliding_sector" else pytest.mark.slow) for one in LAWS],
)
def test_fmu_gives_the_native_simulation(name: str, tmp_path: Path) -> None:
    loop = loop_of(name)
    fmu = br.export_fmu(loop, tmp_path / f"{name}.fmu")
    expected = br.simulate(loop, 1.0, parameters=SMALL)
    found = fmpy.simulate_fmu(
        str(fmu), fmi_type="CoSimulation", stop_time=1.0, output_interval=0.01, start_values=SMALL
    )
    for variable in ("x", "y", "theta", "e1[1]", "u[1]"):
        np.testing.assert_allclose(found[variable], expected[variable].values[::10], rtol=1e-9, atol=1e-9)
    exchanged = fmpy.simulate_fmu(
        str(fmu),
        fmi_type="ModelExchange",
        stop_time=1.0,
        output_interval=0.01,
        relative_tolerance=1e-8,
        start_values=SMALL,
        record_events=False,
    )
    np.testing.assert_allclose(exchanged["x"], expected["x"].values[::10], atol=2e-3)
