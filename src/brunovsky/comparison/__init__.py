"""Comparisons: study files, runs of scenarios under several laws, metrics, and one offline report.

    study file (TOML) -> Study -> runs, by an engine -> metrics -> report.html, metrics.json, traces, tables

:func:`compare_study` does all of it in one call. What is held equal when laws are compared is a protocol:
:func:`swept`, :func:`equal_effort`, :func:`pareto`, :func:`monte_carlo`. :func:`analyze_study` looks at a study without
running it:

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
from brunovsky.comparison.definitions import METRIC_DEFINITIONS, Definition
from brunovsky.comparison.engines import Status
from brunovsky.comparison.linear_metrics import LinearMetrics, linear_metrics
from brunovsky.comparison.measured_margins import (
    MeasuredMargin,
    MeasuredMargins,
    bisect_margin,
    bounded_at_the_end,
    measured_margins,
)
from brunovsky.comparison.metrics import Metrics, compute_metrics
from brunovsky.comparison.protocol_section import ProtocolSection, Table
from brunovsky.comparison.protocol_sections import protocol_sections
from brunovsky.comparison.protocols import (
    Distribution,
    EqualEffort,
    Explanation,
    Failure,
    Knob,
    MonteCarlo,
    Pareto,
    Swept,
    Trial,
    Tuning,
    draw_case,
    equal_effort,
    equal_effort_figure,
    monte_carlo,
    monte_carlo_figure,
    noise_seed,
    pareto,
    pareto_figure,
    step_sensitive_metrics,
    swept,
    swept_figure,
)
from brunovsky.comparison.readme import readme_figure
from brunovsky.comparison.report import ReportFiles, compare_study, render_report, write_report
from brunovsky.comparison.run import Comparison, Run, run_study
from brunovsky.comparison.schema import study_schema
from brunovsky.comparison.statistics import (
    Estimate,
    mean_estimate,
    median_estimate,
    paired_differences,
    rate_estimate,
    sign_estimate,
)
from brunovsky.comparison.study import Law, Scenario, Study, load_study
from brunovsky.comparison.study.chatter_grid import ChatterGrid, ChatterTable
from brunovsky.comparison.summary import sections_markdown, summary_markdown

__all__ = [
    "METRIC_DEFINITIONS",
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
    "Definition",
    "Distribution",
    "EqualEffort",
    "Estimate",
    "Explanation",
    "Failure",
    "Knob",
    "Law",
    "LinearMetrics",
    "MeasuredMargin",
    "MeasuredMargins",
    "Metrics",
    "MonteCarlo",
    "NearestApproach",
    "Pareto",
    "ProtocolSection",
    "ReportFiles",
    "Run",
    "Scenario",
    "Status",
    "Study",
    "Swept",
    "Table",
    "Trial",
    "Tuning",
    "analysis_data",
    "analysis_tables",
    "analyze_study",
    "bisect_margin",
    "bounded_at_the_end",
    "chatter_markdown",
    "compare_study",
    "compute_metrics",
    "draw_case",
    "equal_effort",
    "equal_effort_figure",
    "linear_metrics",
    "load_study",
    "mean_estimate",
    "measured_margins",
    "median_estimate",
    "monte_carlo",
    "monte_carlo_figure",
    "noise_seed",
    "paired_differences",
    "pareto",
    "pareto_figure",
    "protocol_sections",
    "rate_estimate",
    "readme_figure",
    "render_report",
    "run_study",
    "sections_markdown",
    "sign_estimate",
    "step_sensitive_metrics",
    "study_schema",
    "summary_markdown",
    "swept",
    "swept_figure",
    "write_analysis",
    "write_report",
]
