"""What is written on the board: headings, sentences and equations, rendered as text, LaTeX and Markdown."""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import sympy as sp
from sympy.printing.str import StrPrinter


@dataclass(frozen=True)
class Heading:
    """Title of a step."""

    title: str


@dataclass(frozen=True)
class Formula:
    """A formula that SymPy does not print, in plain text and in LaTeX."""

    plain: str
    latex: str


@dataclass(frozen=True)
class Sentence:
    """Prose with a ``{}`` for each of its arguments (formulas, SymPy objects, numbers, tuples of these)."""

    template: str
    arguments: tuple[Any, ...] = ()


@dataclass(frozen=True)
class Equation:
    """A displayed equation."""

    left: Formula
    right: Any


_DERIVATIVE = re.compile(r"(.+)_(d+)ot")

Line = Heading | Sentence | Equation


def as_text(lines: Iterable[Line]) -> str:
    """Render lines as plain ASCII text."""
    blocks = []
    for line in lines:
        if isinstance(line, Heading):
            blocks.append(f"\n{line.title}\n{'-' * len(line.title)}")
        elif isinstance(line, Sentence):
            blocks.append(line.template.format(*map(_plain, line.arguments)))
        else:
            left = f"  {line.left.plain} = "
            blocks.append(left + _plain(line.right).replace("\n", "\n" + " " * len(left)))
    return "\n".join(blocks).lstrip("\n") + "\n"


def as_latex(lines: Iterable[Line]) -> str:
    r"""Render lines as a LaTeX fragment: ``\paragraph`` titles, prose and ``\[ … \]`` displays."""
    return _with_mathematics(lines, "\\paragraph{{{}}}", "\\[ {} \\]")


def as_markdown(lines: Iterable[Line]) -> str:
    """Render lines as Markdown with dollar mathematics, for notebooks."""
    return _with_mathematics(lines, "### {}", "$$ {} $$")


def _with_mathematics(lines: Iterable[Line], heading: str, display: str) -> str:
    blocks = []
    for line in lines:
        if isinstance(line, Heading):
            blocks.append(heading.format(line.title))
        elif isinstance(line, Sentence):
            blocks.append(line.template.format(*(f"${_latex(argument)}$" for argument in line.arguments)))
        else:
            blocks.append(display.format(f"{line.left.latex} = {_latex(line.right)}"))
    return "\n\n".join(blocks) + "\n"


class Explained(ABC):
    """A result that explains itself, in three renderings of the same lines."""

    @abstractmethod
    def lines(self) -> Iterable[Line]:
        """Headings, sentences and equations, in order."""

    def explain(self) -> str:
        """Return the derivation step by step, as on the board, as plain text."""
        return as_text(self.lines())

    def latex(self) -> str:
        """Return the same as a LaTeX fragment (paragraphs and displayed equations; needs amsmath)."""
        return as_latex(self.lines())

    def _repr_markdown_(self) -> str:
        return as_markdown(self.lines())


def definitions(values: Mapping[sp.Symbol, sp.Expr]) -> Iterator[Line]:
    """Symbols with what they are, an equation each."""
    return (Equation(name(symbol), value) for symbol, value in values.items())


def formula(expression: sp.Expr) -> Formula:
    """Formula of an expression, for a left side."""
    return Formula(str(expression), latex(expression))


def name(symbol: sp.Symbol) -> Formula:
    """Formula of a symbol."""
    return Formula(str(symbol), latex(symbol))


def rate(symbol: sp.Symbol) -> Formula:
    """Formula of the time derivative of a symbol."""
    return Formula(f"d{symbol}/dt", rf"\dot{{{latex(symbol)}}}")


def latex(expression: sp.Basic | sp.MatrixBase) -> str:
    """LaTeX of an expression, names like d1_dot set as derivatives, words upright and not as products of letters."""
    return str(sp.latex(expression, symbol_names={symbol: _set(symbol.name) for symbol in expression.free_symbols}))


def _set(name: str) -> str:
    if match := _DERIVATIVE.fullmatch(name):
        accent = rf"\{match[2]}ot" if len(match[2]) < 5 else rf"{{}}^{{({len(match[2])})}}"
        return f"{accent}{{{_set(match[1])}}}"
    plain = str(sp.latex(sp.Symbol(name)))
    word = re.match(r"[A-Za-z]{2,}", plain)
    return rf"\mathrm{{{word[0]}}}{plain[word.end() :]}" if word else plain


def text(sentence: str) -> Formula:
    """Words within which a LaTeX renderer is to leave underscores and carets alone."""
    escaped = sentence.replace("_", r"\_").replace("^", r"\textasciicircum ")
    return Formula(sentence, rf"\text{{{escaped}}}")


def _plain(value: Any) -> str:
    if isinstance(value, Formula):
        return value.plain
    if isinstance(value, tuple):
        return ", ".join(map(_plain, value))
    if isinstance(value, sp.MatrixBase):
        return str(value.table(StrPrinter(), colsep="  "))
    return f"{value.lhs} = {value.rhs}" if isinstance(value, sp.Eq) else str(value)


def _latex(value: Any) -> str:
    if isinstance(value, Formula):
        return value.latex
    return ", ".join(map(_latex, value)) if isinstance(value, tuple) else latex(sp.sympify(value))
