"""Formulas as MathML, which browsers show without any script or network."""

from __future__ import annotations

import sympy as sp
from sympy.printing.mathml import MathMLPresentationPrinter


def mathml(expression: sp.Basic) -> str:
    """Presentation MathML of an expression, without the ``math`` element around it."""
    printer = MathMLPresentationPrinter({"disable_split_super_sub": False})
    text = str(printer._print(expression).toxml())
    return text.replace("<mo>&InvisibleTimes;</mo>", '<mo lspace="0" rspace="0.17em">&#8290;</mo>')  # a thin space


def equation(left: str, right: sp.Basic) -> str:
    """Displayed equation of a MathML text and an expression."""
    return f'<math displaystyle="true">{left}<mo>=</mo>{mathml(right)}</math>'


def derivative(symbol: sp.Symbol) -> str:
    """MathML of a symbol's time derivative, a dot above it."""
    return f"<mover>{mathml(symbol)}<mo>˙</mo></mover>"
