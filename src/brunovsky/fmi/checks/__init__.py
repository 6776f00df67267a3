"""Checks of FMUs, ours and foreign ones: the archive, the description, and a run in a process of its own."""

from brunovsky.fmi.checks.check import check_fmu
from brunovsky.fmi.checks.report import Check, CheckReport

__all__ = ["Check", "CheckReport", "check_fmu"]
