"""Appendix: what each metric of the tables is."""

from __future__ import annotations

from brunovsky.comparison.definitions import METRIC_DEFINITIONS
from brunovsky.comparison.linear_metrics import LINEAR_DEFINITIONS
from brunovsky.comparison.protocol_section import Table


def metric_definitions() -> Table:
    """Names, units and definitions of all metrics of runs and of linear parts."""
    found = (*METRIC_DEFINITIONS, *LINEAR_DEFINITIONS)
    rows = tuple((one.name, one.unit, one.sentence, one.formula) for one in found)
    return Table("definitions", ("metric", "unit", "definition", "formula"), rows)
