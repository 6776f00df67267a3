"""The model's equations for the report, from the expressions that run: as MathML, or drawn where that is not read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import sympy as sp
from matplotlib.font_manager import FontProperties
from matplotlib.mathtext import MathTextParser

from brunovsky._mathml import derivative, equation, mathml
from brunovsky.blocks import robot_linearization, robot_system
from brunovsky.comparison import drawing

_POINTS = 11.0  # size of drawn equations


@dataclass(frozen=True)
class Equation:
    """One equation: what stands on the left, as MathML and LaTeX, and the expression on the right."""

    mathml: str
    latex: str
    right: sp.Expr


Render = Callable[[Equation], str]


def plant_equations() -> list[Equation]:
    """State equations of the robot."""
    system = robot_system()
    return [
        Equation(derivative(state), _dotted(state), slope)
        for state, slope in zip(system.states, system.dynamics, strict=True)
    ]


def inner_loop_equations() -> list[Equation]:
    """Linearising law of the robot, one equation for each input of the extended system."""
    return [Equation(mathml(one), sp.latex(one), right) for one, right in robot_linearization().law.items()]


def determinant() -> Equation:
    """Determinant of the robot's decoupling matrix."""
    left = '<mi>det</mi><mspace width="0.2em"/><mi>G</mi>'
    return Equation(left, r"\det\, G", robot_linearization().determinant)


def as_mathml(one: Equation) -> str:
    """Equation as a MathML element."""
    return equation(one.mathml, one.right)


def as_svg(one: Equation) -> str:
    """Equation as an SVG element that stands in a line of text, for what does not read MathML."""
    text = rf"${one.latex} = {_mathtext(sp.latex(one.right))}$"
    width, height, depth, *_ = MathTextParser("path").parse(text, dpi=72, prop=FontProperties(size=_POINTS))
    figure = drawing.new_figure(width / 72.0, height / 72.0, left=0.0)
    figure.text(0.0, depth / height, text, fontsize=_POINTS)
    key = "equation-" + "".join(letter if letter.isalnum() else "-" for letter in one.latex)
    drawn = drawing.svg(figure, key, title=f"{one.latex} = {sp.latex(one.right)}")
    return drawn.replace("<svg", f'<svg style="vertical-align: -{depth:.2f}pt"', 1)


def _dotted(state: sp.Symbol) -> str:
    base, _, index = sp.latex(state).partition("_")
    return rf"\dot{{{base}}}" + (f"_{index}" if index else "")


def _mathtext(latex: str) -> str:
    """LaTeX without the invisible braces of sizes, which matplotlib does not know."""
    return latex.replace(r"\left(", "(").replace(r"\right)", ")")
