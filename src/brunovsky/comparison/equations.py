"""The model's equations for the report, as MathML of the same expressions that run."""

from __future__ import annotations

import sympy as sp
from sympy.printing.mathml import MathMLPresentationPrinter

from brunovsky.blocks import robot_linearization, robot_system


def plant_equations() -> list[str]:
    """State equations of the robot, one MathML element each."""
    system = robot_system()
    return [
        _element(f"<mover>{_mathml(state)}<mo>˙</mo></mover>", slope)
        for state, slope in zip(system.states, system.dynamics, strict=True)
    ]


def inner_loop_equations() -> list[str]:
    """Linearising law of the robot, one MathML element for each input of the extended system."""
    return [_element(_mathml(one), expression) for one, expression in robot_linearization().law.items()]


def determinant() -> str:
    """Determinant of the robot's decoupling matrix, as MathML."""
    return _element('<mi>det</mi><mspace width="0.2em"/><mi>G</mi>', robot_linearization().determinant)


def _element(left: str, right: sp.Expr) -> str:
    return f'<math displaystyle="true">{left}<mo>=</mo>{_mathml(right)}</math>'


def _mathml(expression: sp.Basic) -> str:
    printer = MathMLPresentationPrinter({"disable_split_super_sub": False})
    return str(printer._print(expression).toxml())
