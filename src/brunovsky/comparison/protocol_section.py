"""What a protocol of fairness adds to a report: its explanation, figure, table and findings."""

from __future__ import annotations

import math
from dataclasses import dataclass

from brunovsky.errors import ParameterError

Cell = str | float | int | None


@dataclass(frozen=True)
class Table:
    """A table that stands in the report, and beside it as CSV.

    Numbers are given as numbers: the report rounds them, the CSV file has all their digits. None is what is undefined.

    Attributes
    ----------
    name : str
        Of its file, ``tables/NAME.csv``: letters, digits, ``-`` and ``_``.
    columns : tuple of str
        Headings, with units; the first is that of the rows' names.
    rows : tuple of tuple of str, float, int or None
        As many cells each as there are columns; a float that is not a number counts as None.
    caption : str
        What it shows; may be empty.
    heads : int
        How many first columns say what a row is: page and PDF repeat them where they set the columns behind them in
        parts (see ``report.layout.table_parts``), the CSV file is one; 0 for a table that is never parted.

    Raises
    ------
    ParameterError
        If a row has another number of cells than there are columns.
    """

    name: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Cell, ...], ...]
    caption: str = ""
    heads: int = 0

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise ParameterError(
                    f"table '{self.name}': a row has {len(row)} cells for {len(self.columns)} columns ({row!r}); "
                    "give one cell for each column, None where it is undefined"
                )
        rows = tuple(tuple(_defined(cell) for cell in row) for row in self.rows)
        object.__setattr__(self, "rows", rows)


@dataclass(frozen=True)
class ProtocolSection:
    """One protocol of fairness, or another part of a report that stands on its own.

    Attributes
    ----------
    title : str
        Heading.
    explanation : str
        What the protocol does and why it is fair: a paragraph of plain text.
    figure_svg : str
        SVG element from ``drawing.svg`` with a key of its own; empty for none.
    table : Table or None
        Its numbers.
    findings : tuple of str
        What was found: paragraphs of plain text, never stronger than the numbers.
    caption : str
        Of the figure, also what a screen reader says of it; the title by default.
    headline : str
        One sentence for the verdict at the top of the report; may be empty.
    leads : bool
        Whether that sentence comes before the comparison of laws, for it tells what the study is about.
    """

    title: str
    explanation: str
    figure_svg: str = ""
    table: Table | None = None
    findings: tuple[str, ...] = ()
    caption: str = ""
    headline: str = ""
    leads: bool = False


def _defined(cell: Cell) -> Cell:
    return None if isinstance(cell, float) and math.isnan(cell) else cell
