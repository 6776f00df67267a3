"""The report of a comparison: one HTML file that opens offline, on request a PDF, and its numbers beside it.

Comparison (+ ProtocolSections) -> Content, drawn and worded once -> report.html, report.pdf, tables; metrics, traces
"""

from brunovsky.comparison.report.compare import ReportFiles, compare_study, write_report
from brunovsky.comparison.report.data import metrics_data
from brunovsky.comparison.report.page import render_report

__all__ = ["ReportFiles", "compare_study", "metrics_data", "render_report", "write_report"]
