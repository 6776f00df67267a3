"""Co-simulation of linearized_robot.fmu against an independent RK4 of the model's equations, typed here by hand.

Figure 6 of the paper from outside the circle. The saturated outer loop is computed outside the FMU and v is held over
each communication step of 1 ms, in both. The equations below are those of the paper, corrected (see the errata), and
share no code with the package.
"""

import math
from collections.abc import Iterator
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave

import brunovsky as br

R, W = math.sqrt(2), 0.5
C, Q, P, PHI = (500.0, 10.0, 1.0), 5.0, 2.5, 0.05
STEP, STEPS = 1e-3, 20_000
START = [2.5, 0.0, 0.0, 0.5, 0.0, 0.0]


def chains(X: list[float]) -> tuple[list[float], list[float]]:
    x, y, th, n1, n2, u1 = X
    s, c = math.sin(th), math.cos(th)
    return [x, -n1 * s, -n1 * n2 * c - u1 * s], [y, n1 * c, -n1 * n2 * s + u1 * c]


def outer_loop(t: float, Z: tuple[list[float], list[float]]) -> list[float]:
    c, s = R * math.cos(W * t), R * math.sin(W * t)
    references = ([c, -W * s, -W * W * c, W**3 * s], [s, W * c, -W * W * s, -(W**3) * c])
    v = []
    for z, zd in zip(Z, references, strict=True):
        e = [z[k] - zd[k] for k in range(3)]
        S = sum(gain * error for gain, error in zip(C, e, strict=True))
        v.append((-Q * S - P * max(-1.0, min(1.0, S / PHI)) - C[0] * e[1] - C[1] * e[2]) / C[2] + zd[3])
    return v


def slope(X: list[float], v: list[float]) -> list[float]:
    _, _, th, n1, n2, u1 = X
    s, c = math.sin(th), math.cos(th)
    f1 = n2 * n2 * n1 * s - 2 * n2 * u1 * c
    f2 = -n2 * n2 * n1 * c - 2 * n2 * u1 * s
    # [u2, w1] = G^-1 (v - F) with G = [[-n1 c, -s], [-n1 s, c]], det G = -n1
    a, b, d, e = -n1 * c, -s, -n1 * s, c
    determinant = a * e - b * d
    u2 = (e * (v[0] - f1) - b * (v[1] - f2)) / determinant
    w1 = (-d * (v[0] - f1) + a * (v[1] - f2)) / determinant
    return [-n1 * s, n1 * c, n2, u1, u2, w1]


def rk4() -> Iterator[list[float]]:
    X = list(START)
    yield X
    for k in range(STEPS):
        v = outer_loop(k * STEP, chains(X))
        k1 = slope(X, v)
        k2 = slope([x + STEP / 2 * d for x, d in zip(X, k1, strict=True)], v)
        k3 = slope([x + STEP / 2 * d for x, d in zip(X, k2, strict=True)], v)
        k4 = slope([x + STEP * d for x, d in zip(X, k3, strict=True)], v)
        X = [x + STEP / 6 * (a + 2 * b + 2 * c + d) for x, a, b, c, d in zip(X, k1, k2, k3, k4, strict=True)]
        yield X


@pytest.fixture(scope="module")
def reference() -> np.ndarray:
    trajectory = np.array(list(rk4()))
    assert abs(trajectory[:, 3]).min() > 0.05  # eta_min is never reached: the printed law holds all along
    return trajectory


def test_cosimulation_of_the_fmu_agrees_with_an_independent_rk4(reference: np.ndarray, tmp_path: Path) -> None:
    path = br.export_fmu(br.blocks.linearized_robot(), tmp_path / "linearized_robot.fmu")
    folder = fmpy.extract(str(path), str(tmp_path / "unzipped"))
    description = fmpy.read_model_description(folder)
    vr = {one.name: one.valueReference for one in description.modelVariables}
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="robot",
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    names = ["x_start", "y_start", "theta_start", "eta_start[1]", "eta_start[2]", "u_start[1]"]
    fmu.setReal([vr[name] for name in names], START)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    states = [vr[name] for name in ("x", "y", "theta", "eta[1]", "eta[2]", "u[1]")]
    Z = [vr[f"Z{i}[{k}]"] for i in (1, 2) for k in (1, 2, 3)]
    worst = np.zeros(6)
    for k, expected in enumerate(reference):
        worst = np.maximum(worst, abs(np.array(fmu.getReal(states)) - expected))
        if k < STEPS:
            z = fmu.getReal(Z)
            fmu.setReal([vr["v[1]"], vr["v[2]"]], outer_loop(k * STEP, (z[:3], z[3:])))
            fmu.doStep(currentCommunicationPoint=k * STEP, communicationStepSize=STEP)
    fmu.terminate()
    fmu.freeInstance()
    assert worst.max() < 1e-9, dict(zip(names, worst, strict=True))
    assert worst.max() > 0  # two implementations, not one with itself


def test_native_simulation_agrees_with_an_independent_rk4(reference: np.ndarray) -> None:
    v = np.array([outer_loop(k * STEP, chains(X)) for k, X in enumerate(reference.tolist())])
    result = br.simulate(
        br.blocks.linearized_robot(),
        STEPS * STEP,
        parameters={"x_start": 2.5, "eta_start[1]": 0.5},
        inputs={"v[1]": v[:, 0], "v[2]": v[:, 1]},
    )
    # v is replayed here, not fed back, so nothing damps the integrators: rounding grows with t^2
    assert result["x"].values == pytest.approx(reference[:, 0], abs=1e-8)
    assert result["theta"].values == pytest.approx(reference[:, 2], abs=1e-8)
