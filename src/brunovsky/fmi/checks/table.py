"""A report of checks as a table for the terminal."""

from __future__ import annotations

from rich.markup import escape
from rich.table import Table
from rich.text import Text

from brunovsky.fmi.checks.report import FAILED, NOT_PROVIDED, NOT_RUN, PASSED, CheckReport

_STYLES = {PASSED: "green", FAILED: "bold red", NOT_PROVIDED: "dim", NOT_RUN: "yellow"}
_PARTS = {
    "CoSimulation": "co-simulation",
    "ModelExchange": "model exchange",
    "ScheduledExecution": "scheduled execution",
}


def check_table(report: CheckReport) -> Table:
    """One row for each check, in sections for the parts of the FMU."""
    title = f"{escape(report.path)}: {escape(report.model)}, FMI {escape(report.fmi_version)}"
    table = Table(title=title, title_justify="left", title_style="bold", box=None, pad_edge=False)
    table.add_column("part", no_wrap=True)
    table.add_column("check", no_wrap=True)
    table.add_column("result", no_wrap=True)
    table.add_column("what was found", overflow="fold")
    part = ""
    for one in report.checks:
        if part and one.part != part:
            table.add_row()
        shown = "" if one.part == part else _PARTS.get(one.part, one.part)
        part = one.part
        detail = Text("".join(letter if letter.isprintable() else "?" for letter in one.detail))
        table.add_row(shown, one.name, Text(one.status, style=_STYLES[one.status]), detail)
    return table


def check_summary(report: CheckReport) -> str:
    """One sentence: how many checks had which result."""
    counts = {status: sum(one.status == status for one in report.checks) for status in _STYLES}
    return ", ".join(f"{count} {status}" for status, count in counts.items() if count)
