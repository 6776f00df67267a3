"""Jacobians that CasADi's DaeBuilder takes from the FMU, against the FMU's own by fmpy and against differences.

CasADi handles no events: the plant stays on one branch, away from rest, as at its start.
"""

from pathlib import Path
from zipfile import ZipFile

import fmpy
import numpy as np
import pytest

import brunovsky as br

CENTRE = np.eye(10)[3] * 1.5  # eta[1] = 1.5 m/s
POINTS = CENTRE + np.random.default_rng(1).uniform(-0.8, 0.8, (4, 10))


def ours(fmu: Path, point: np.ndarray, states: list[str], inputs: list[str]) -> np.ndarray:
    """Directional derivatives of the state derivatives, column by column; shape (states, states + inputs)."""
    description = fmpy.read_model_description(fmu)
    number = {one.name: one.valueReference for one in description.modelVariables}
    rates, knowns = [number[f"der({one})"] for one in states], [number[one] for one in [*states, *inputs]]
    robot = fmpy.instantiate_fmu(fmpy.extract(fmu), description, "ModelExchange")
    two = description.fmiVersion.startswith("2")
    if two:
        robot.setupExperiment(startTime=0.0)
    robot.enterInitializationMode()
    robot.exitInitializationMode()
    (robot.newDiscreteStates if two else robot.updateDiscreteStates)()
    robot.enterContinuousTimeMode()
    (robot.setReal if two else robot.setFloat64)(knowns[len(states) :], point[len(states) :])
    (robot.setReal if two else robot.setFloat64)(knowns[: len(states)], point[: len(states)])
    derivative = robot.getDirectionalDerivative
    columns = [derivative(rates, [one], [1.0]) for one in knowns]
    robot.terminate()
    robot.freeInstance()
    return np.array(columns).T


@pytest.mark.parametrize("version", [2, 3])
def test_the_jacobian_of_the_rates(version: int, tmp_path: Path) -> None:
    casadi = pytest.importorskip("casadi")
    fmu = br.export_fmu(br.blocks.linearized_robot(), tmp_path / "robot.fmu", fmi_version=version)
    ZipFile(fmu).extractall(tmp_path / "robot")
    dae = casadi.DaeBuilder("robot", str(tmp_path / "robot"))

    rates = dae.create("rates", ["t", "x", "u"], ["ode"])
    jacobian = rates.factory("jacobian", ["t", "x", "u"], ["jac:ode:x", "jac:ode:u"])

    def value(point: np.ndarray) -> np.ndarray:
        return rates(0.0, point[:6], point[6:]).full().ravel()

    for point in POINTS:
        exact = ours(fmu, point, dae.x(), dae.u())
        scale = np.abs(exact).max()
        assert scale >= 1.0
        # It asks the FMU along seeds that it scales by nominal values: rounding is left.
        theirs = np.hstack([casadi.DM(one).full() for one in jacobian(0.0, point[:6], point[6:])])
        assert np.abs(theirs - exact).max() < 1e-12 * scale
        # Central differences of CasADi's function: rounding over the step is 1e-10, 1e-6 squared is far less.
        steps = 1e-6 * np.eye(len(point))
        differences = np.array([(value(point + one) - value(point - one)) / 2e-6 for one in steps]).T
        assert np.abs(differences - exact).max() < 1e-8 * scale
