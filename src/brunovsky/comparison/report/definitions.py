"""Appendix: what each metric of the tables is."""

from __future__ import annotations

import re
from inspect import cleandoc

from brunovsky.comparison.metrics import Metrics
from brunovsky.comparison.protocol_section import Table

_ENTRY = re.compile(r"^(?P<names>[\w, ]+) : .*\n(?P<text>(?:^ +.*\n?)+)", re.MULTILINE)


def metric_definitions() -> Table:
    """Names and definitions of all metrics, as the code that computes them says."""
    found = _ENTRY.finditer(cleandoc(Metrics.__doc__ or ""))
    rows = tuple((one["names"], " ".join(one["text"].split()).replace("None if", "not defined if")) for one in found)
    return Table("definitions", ("metric", "definition"), rows)
