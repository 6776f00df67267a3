"""How a table is set: in how many parts, which columns are flush right, which rows share a name, which failed."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from itertools import groupby, pairwise
from typing import TypeVar

from brunovsky.comparison.facts import number
from brunovsky.comparison.protocol_section import Cell, Table

_T = TypeVar("_T")
WIDEST = 6  # columns behind the heads of the rows that fit a page
_NUMERIC = re.compile(
    r"(≈\u00a0)?−?[\d.]+(×10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?(\u00a0?%)?|[–∞]|−∞|ok|never|unstable|failed.*|singular.*|diverged.*"
)


@dataclass(frozen=True)
class Layout:
    """How a table is set.

    Attributes
    ----------
    flush_right : tuple of bool
        For each column, whether it holds numbers.
    spans : tuple of int
        For each row, how many rows its name stands for; 0 where it is that of the row above.
    failed : tuple of bool
        For each row, whether it is of a run that failed.
    """

    flush_right: tuple[bool, ...]
    spans: tuple[int, ...]
    failed: tuple[bool, ...]


def table_parts(table: Table) -> tuple[Table, ...]:
    """A table in parts that fit a page: each with the heads of the rows and at most six of the columns behind them."""
    count = len(table.columns) - table.heads
    if not table.heads or count <= WIDEST:
        return (table,)
    parts = math.ceil(count / WIDEST)
    ends = [table.heads + round(count * k / parts) for k in range(parts + 1)]
    return tuple(
        replace(
            table,
            columns=_some(table.columns, table.heads, first, last),
            rows=tuple(_some(row, table.heads, first, last) for row in table.rows),
            caption=f"{table.caption} (part {k} of {parts})".strip(),
        )
        for k, (first, last) in enumerate(pairwise(ends), 1)
    )


def _some(cells: tuple[_T, ...], heads: int, first: int, last: int) -> tuple[_T, ...]:
    return (*cells[:heads], *cells[first:last])


def table_layout(table: Table) -> Layout:
    """How a table is set, from its cells."""
    texts = [[cell_text(cell) for cell in row] for row in table.rows]
    numeric = [all(_NUMERIC.fullmatch(row[k]) for row in texts) for k in range(len(table.columns))]
    spans: list[int] = []
    for _, rows in groupby(texts, key=lambda row: row[0]):
        count = len(list(rows))
        spans += [count, *[0] * (count - 1)]
    failed = [any(cell.startswith("failed") for cell in row[1:]) for row in texts]
    right = tuple(found and bool(texts) and k > 0 for k, found in enumerate(numeric))
    return Layout(right, tuple(spans), tuple(failed))


def cell_text(cell: Cell) -> str:
    """A cell for people: a dash for what is undefined or empty."""
    if cell is None or cell == "":
        return "–"
    return number(cell) if isinstance(cell, float) else str(cell)
