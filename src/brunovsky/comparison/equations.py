"""The model's equations for the report, as MathML of the same expressions that run."""

from __future__ import annotations

from brunovsky._mathml import derivative, equation, mathml
from brunovsky.blocks import robot_linearization, robot_system


def plant_equations() -> list[str]:
    """State equations of the robot, one MathML element each."""
    system = robot_system()
    return [equation(derivative(state), slope) for state, slope in zip(system.states, system.dynamics, strict=True)]


def inner_loop_equations() -> list[str]:
    """Linearising law of the robot, one MathML element for each input of the extended system."""
    return [equation(mathml(one), expression) for one, expression in robot_linearization().law.items()]


def determinant() -> str:
    """Determinant of the robot's decoupling matrix, as MathML."""
    return equation('<mi>det</mi><mspace width="0.2em"/><mi>G</mi>', robot_linearization().determinant)
