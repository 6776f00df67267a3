"""Comparisons: study files, runs of scenarios under several laws, metrics, and one offline report.

    study file (TOML) -> Study -> runs, through the FMU or natively -> metrics -> report.html, metrics.json

:func:`compare_study` does all of it in one call.
"""

from brunovsky.comparison.agreement import Agreement
from brunovsky.comparison.engines import Status
from brunovsky.comparison.metrics import Metrics, compute_metrics
from brunovsky.comparison.readme import readme_figure
from brunovsky.comparison.report import ReportFiles, compare_study, write_report
from brunovsky.comparison.run import Comparison, Run, run_study
from brunovsky.comparison.study import Law, Scenario, Study, load_study
from brunovsky.comparison.summary import summary_markdown

__all__ = [
    "Agreement",
    "Comparison",
    "Law",
    "Metrics",
    "ReportFiles",
    "Run",
    "Scenario",
    "Status",
    "Study",
    "compare_study",
    "compute_metrics",
    "load_study",
    "readme_figure",
    "run_study",
    "summary_markdown",
    "write_report",
]
