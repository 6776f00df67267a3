"""documentation/index.html of an FMU: variables, equations, feedthrough and checks, readable without a network."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from html import escape

import sympy as sp

from brunovsky._mathml import derivative, equation, mathml
from brunovsky.blocks import Block
from brunovsky.fmi.definitions import number_text
from brunovsky.fmi.variables import ScalarVariable

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; color: #1f2d3d }
table { border-collapse: collapse; margin: 1rem 0 } th, td { border-bottom: 1px solid #cfd8e0; padding: .2rem .8rem;
text-align: left; vertical-align: top } th { color: #2f6f9f } .equation { margin: .6rem 0; overflow: auto hidden }
h1, h2 { color: #2f6f9f } code { font-size: 90% }
"""


LONG = 5000
"""Parts of an expression from which on its common subexpressions are shown by themselves."""


def documentation(block: Block, variables: Sequence[ScalarVariable]) -> bytes:
    """Text of the page.

    Parameters
    ----------
    block : Block
        What the FMU runs; its own expressions are what the page shows.
    variables : sequence of ScalarVariable
        Those of the description.

    Returns
    -------
    bytes
        HTML with MathML in UTF-8, the same for equal arguments.
    """
    parts = [
        f"<h1>{escape(block.name)}</h1><p>{escape(block.description)}</p>",
        _section("Variables", [_variables(variables)]),
        _model(block),
        '<p>Reference results: <a href="fmi-ls-ref.txt">fmi-ls-ref.txt</a>.</p>',
        '<p>Licence of the runtime: <a href="licenses/license.txt">license.txt</a>.</p>',
    ]
    head = f'<meta charset="utf-8"><title>{escape(block.name)}</title><style>{_STYLE}</style>'
    return f'<!doctype html>\n<html lang="en"><head>{head}</head>\n<body>{"".join(parts)}</body></html>\n'.encode()


@lru_cache(maxsize=64)
def _model(block: Block) -> str:
    """What both versions of the standard share."""
    sections = {
        "Equations": _equations(block),
        "Switching": _switching(block),
        "Feedthrough": _feedthrough(block),
        "Checks": _checks(block),
    }
    return "".join(_section(title, lines) for title, lines in sections.items())


def _section(title: str, lines: Iterable[str]) -> str:
    text = "\n".join(lines)
    return f"\n<h2>{title}</h2>\n{text}\n" if text else ""


def _table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    def row(cells: Sequence[str], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{one}</{tag}>" for one in cells) + "</tr>"

    return f"<table>{row(header, 'th')}\n" + "\n".join(row(one, "td") for one in rows) + "</table>"


def _variables(variables: Sequence[ScalarVariable]) -> str:
    rows = (
        (
            f"<code>{escape(one.name)}</code>",
            f"{one.causality}, {one.variability}",
            escape(one.unit or ""),
            "" if one.start is None else number_text(one.start, one.type),
            escape(one.description),
        )
        for one in variables
    )
    return _table(("variable", "causality", "unit", "start", "meaning"), rows)


def _shown(text: str) -> str:
    return f'<div class="equation">{text}</div>'


def _shortened(expressions: Sequence[sp.Basic], prefix: str) -> tuple[list[str], list[sp.Basic]]:
    """Equations of the common subexpressions of long expressions, and the expressions in terms of these."""
    long = [one for one in expressions if sum(1 for _ in sp.preorder_traversal(one)) > LONG]
    common, reduced = sp.cse(long, symbols=sp.numbered_symbols(prefix), order="none") if long else ([], [])
    short = dict(zip(long, reduced, strict=True))
    lines = [_shown(equation(mathml(name), value)) for name, value in common]
    return ["<p>With</p>", *lines] if lines else [], [short.get(one, one) for one in expressions]


def _equations(block: Block) -> list[str]:
    shown = [one for one in block.outputs if not _is_itself(one)]
    wanted = [*(one.derivative for one in block.states), *(one.expression for one in shown)]
    common, expressions = _shortened(wanted, "c_")
    slopes, values = expressions[: len(block.states)], expressions[len(block.states) :]
    lines = [_shown(equation(derivative(one.symbol), slope)) for one, slope in zip(block.states, slopes, strict=True)]
    for one in block.samples:
        if one.is_held:
            continue
        when = f"when {escape(one.clock)} ticks" if one.clock else f"every <math>{mathml(one.period)}</math> s"
        update = f'<math displaystyle="true">{mathml(one.symbol)}<mo>&#8592;</mo>{mathml(one.update)}</math>'
        lines.append(_shown(f"{update} {when}"))
    lines += [_shown(equation(mathml(one.symbol), value)) for one, value in zip(shown, values, strict=True)]
    lines += common
    starts = [(one.symbol, one.start) for one in block.states]
    starts += [(one.symbol, one.start) for one in block.samples]
    if starts:
        lines.append("<p>At the start:</p>")
        lines += [_shown(equation(mathml(symbol), sp.sympify(start))) for symbol, start in starts]
    return lines


def _is_itself(output: object) -> bool:
    return bool(getattr(output, "symbol", None) == getattr(output, "expression", None))


def _switching(block: Block) -> list[str]:
    lines = [
        _shown(f'<math displaystyle="true">{mathml(one.symbol)}<mo>:</mo>{mathml(sp.Gt(one.expression, 0))}</math>')
        for one in block.relations
    ]
    for one in block.transitions:
        common, values = _shortened([sp.sympify(value) for value in one.assign.values()], "k_")
        assigned = "<mo>,</mo>".join(
            f"{mathml(symbol)}<mo>&#8592;</mo>{mathml(value)}" for symbol, value in zip(one.assign, values, strict=True)
        )
        lines.append(
            _shown(f"<code>{escape(one.name)}</code>: where <math>{mathml(one.guard)}</math>, <math>{assigned}</math>")
        )
        lines += common
    return lines


def _feedthrough(block: Block) -> list[str]:
    order = [one.name for one in block.inputs]
    through = block.feedthrough
    rows = [
        (
            f"<code>{escape(one.name)}</code>",
            ", ".join(f"<code>{escape(u)}</code>" for u in order if u in through[one.name]),
        )
        for one in block.outputs
        if through[one.name]
    ]
    if rows:
        return ["<p>Outputs that follow inputs at once:</p>", _table(("output", "inputs"), rows)]
    return ["<p>No output follows an input at once.</p>"] if order else []


def _checks(block: Block) -> list[str]:
    rows = [
        (escape(one.name), f"<math>{mathml(one.condition)}</math>", one.when, escape(one.message))
        for one in block.checks
    ]
    return [_table(("check", "must hold", "at", "otherwise"), rows)] if rows else []
