"""What the pages of the documentation show results with: formulas, tables, figures. No models, no numbers."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import sympy as sp

try:  # figures as vectors, where a notebook runs
    from matplotlib_inline.backend_inline import set_matplotlib_formats

    set_matplotlib_formats("svg")
except (ImportError, AttributeError):
    pass


@dataclass(frozen=True)
class Markdown:
    """Text that a notebook renders as Markdown."""

    text: str

    def _repr_markdown_(self) -> str:
        return self.text


def latex(expression: Any, names: dict[sp.Symbol, str] | None = None) -> str:
    """LaTeX of an expression; Piecewise conditions are set as 'if', logic as words."""
    text = str(sp.latex(expression, symbol_names=names or {}, mat_delim="["))
    return text.replace(r"\text{for}\:", r"\text{if }").replace(r"\text{otherwise}", r"\text{else}")


def equations(*pairs: tuple[str, Any], names: dict[sp.Symbol, str] | None = None) -> Markdown:
    """Displayed equations ``left = right``; the left sides are LaTeX, the right sides what the code derived."""
    return Markdown("\n\n".join(f"$$ {left} = {latex(right, names)} $$" for left, right in pairs))


def resolved(block: Any, expression: sp.Basic) -> sp.Basic:
    """Expression with the block's relations written out as the conditions they stand for."""
    behind = {one.symbol: one.expression > 0 for one in block.relations}
    while expression.free_symbols & set(behind):
        expression = expression.xreplace(behind)
    return expression


def table(header: Sequence[str], rows: Iterable[Sequence[Any]]) -> Markdown:
    """Markdown table."""
    lines = [list(header), ["---"] * len(header), *([_cell(one) for one in row] for row in rows)]
    return Markdown("\n".join(f"| {' | '.join(line)} |" for line in lines))


def _cell(value: Any) -> str:
    return str(value).replace("|", r"\|")


def variables(block: Any) -> Markdown:
    """Table of a block's interface: inputs, outputs, parameters with unit, default and meaning."""
    rows = [(one, "input", "") for one in block.inputs]
    rows += [(one, "output, Boolean" if one.is_boolean else "output", "") for one in block.outputs]
    rows += [
        (one, "parameter, tunable" if one.tunable else "parameter, fixed", f"{one.value:g}") for one in block.parameters
    ]
    return table(
        ("variable", "causality", "unit", "default", "meaning"),
        ((f"`{one.name}`", kind, f"`{one.unit}`", value, one.description) for one, kind, value in rows),
    )


def masters() -> Markdown:
    """Table of the masters that the tests run, with their versions of the constraints."""
    root = Path(__file__).parents[2]
    pins = (line.split("==") for line in (root / "constraints.txt").read_text().splitlines() if "==" in line)
    versions = {name.lower().replace("_", "-"): version for name, version in pins}
    rows = []
    for one in tomllib.loads((root / "fmu" / "examples" / "masters.toml").read_text())["master"]:
        kinds = (
            "/".join(kind for kind in ("CS", "ME") if f"FMI {version} {kind}" in one["interfaces"])
            for version in (2, 3)
        )
        package = f"{one['package']} {versions[one['package'].lower()]}"
        cells = (one["name"], package, *kinds, one.get("ssp", ""), f"`{one['example']}`", one["remarks"])
        rows.append([cell or "–" for cell in cells])
    return table(("master", "version", "FMI 2", "FMI 3", "SSP", "example", "remarks"), rows)


def heading_arrows(axes: Any, data: Any, every: int, length: float = 0.45) -> None:
    """Arrows along the heading on a path drawn from ``x``, ``y`` and ``theta``."""
    import numpy as np

    points = data.isel(time=slice(0, None, every))
    axes.quiver(
        points["x"], points["y"], -np.sin(points["theta"]), np.cos(points["theta"]),
        angles="xy", scale_units="xy", scale=1 / length, width=0.012, color="C3", zorder=3,
    )  # fmt: skip


def command(*arguments: str) -> None:
    """Print what the command line answers."""
    import os

    import rich.console
    from typer.testing import CliRunner

    os.environ["COLUMNS"] = "84"
    rich.console._is_jupyter = lambda: False  # text as in a terminal, not a widget
    from brunovsky.cli import app

    print(f"$ brunovsky {' '.join(arguments)}".rstrip())
    result = CliRunner().invoke(app, arguments, prog_name="brunovsky", catch_exceptions=False)
    print(result.output.strip("\n"))
    assert result.exit_code == 0, result.output
