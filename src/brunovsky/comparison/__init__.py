"""Comparisons: study files, runs of scenarios under several laws, metrics, and one offline report.

    study file (TOML) -> Study -> runs, by an engine -> metrics -> report.html, metrics.json, traces, tables

:func:`compare_study` does all of it in one call. :func:`analyze_study` looks at a study without running it:

    Study -> linear loops, reaching, bounds, chatter -> tables, figures, analysis.json
"""

from brunovsky.comparison.agreement import Agreement
from brunovsky.comparison.analyze import (
    Analysis,
    AnalysisFiles,
    analysis_data,
    analyze_study,
    write_analysis,
)
from brunovsky.comparison.analyze_tables import analysis_tables
from brunovsky.comparison.analyzed_loops import AnalyzedLaw, AnalyzedLoop
from brunovsky.comparison.analyzed_runs import ActuatorMargins, AnalyzedRun, NearestApproach
from brunovsky.comparison.chatter_summary import chatter_markdown
from brunovsky.comparison.engines import Status
from brunovsky.comparison.metrics import Metrics, compute_metrics
from brunovsky.comparison.protocol_section import ProtocolSection, Table
from brunovsky.comparison.protocol_sections import protocol_sections
from brunovsky.comparison.readme import readme_figure
from brunovsky.comparison.report import ReportFiles, compare_study, render_report, write_report
from brunovsky.comparison.run import Comparison, Run, run_study
from brunovsky.comparison.study import Law, Scenario, Study, load_study
from brunovsky.comparison.study.chatter_grid import ChatterGrid, ChatterTable
from brunovsky.comparison.summary import summary_markdown

__all__ = [
    "ActuatorMargins",
    "Agreement",
    "Analysis",
    "AnalysisFiles",
    "AnalyzedLaw",
    "AnalyzedLoop",
    "AnalyzedRun",
    "ChatterGrid",
    "ChatterTable",
    "Comparison",
    "Law",
    "Metrics",
    "NearestApproach",
    "ProtocolSection",
    "ReportFiles",
    "Run",
    "Scenario",
    "Status",
    "Study",
    "Table",
    "analysis_data",
    "analysis_tables",
    "analyze_study",
    "chatter_markdown",
    "compare_study",
    "compute_metrics",
    "load_study",
    "protocol_sections",
    "readme_figure",
    "render_report",
    "run_study",
    "summary_markdown",
    "write_analysis",
    "write_report",
]
