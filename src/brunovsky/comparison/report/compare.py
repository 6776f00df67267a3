"""From a study to its report, and what is kept beside it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from brunovsky.comparison.protocol_section import ProtocolSection
from brunovsky.comparison.protocol_sections import protocol_data, protocol_sections, trial_tables
from brunovsky.comparison.report.data import metrics_data
from brunovsky.comparison.report.files import csv_text, trace_bytes, trace_name
from brunovsky.comparison.report.manifest import ReportFolder
from brunovsky.comparison.report.page import render, report_content
from brunovsky.comparison.report.pdf import pdf_bytes, require_pdf
from brunovsky.comparison.run import Comparison, Progress, run_study
from brunovsky.comparison.study import EngineName, Study, load_study


class ReportFiles(NamedTuple):
    """What a comparison leaves behind.

    Attributes
    ----------
    report, metrics : Path
        ``report.html`` and ``metrics.json``.
    protocols : Path or None
        ``protocols.json``, where the study has protocols.
    pdf : Path or None
        ``report.pdf``, where it was asked for.
    traces : tuple of Path
        ``traces/SCENARIO--LAW.nc``, one for each run that made a step.
    tables : tuple of Path
        ``tables/NAME.csv``.
    """

    report: Path
    metrics: Path
    protocols: Path | None
    pdf: Path | None
    traces: tuple[Path, ...]
    tables: tuple[Path, ...]


def compare_study(
    study: Study | str | Path,
    folder: str | Path,
    *,
    engine: EngineName | None = None,
    pdf: bool = False,
    progress: Progress | None = None,
) -> ReportFiles:
    """Run a study and write its report, metrics, traces and tables.

    Parameters
    ----------
    study : Study or path
        A study, or its file (TOML).
    folder : path
        Where ``report.html``, ``metrics.json``, ``traces/``, ``tables/`` and ``fmus/`` go; made if missing.
    engine : {"fmpy", "native"}, optional
        In place of the study's own choice.
    pdf : bool
        Whether to write ``report.pdf`` too.
    progress : function of (done, total, what), optional
        See :func:`run_study`.

    Raises
    ------
    StudyError
        If the study file cannot be used.
    ReportError
        If a PDF is asked for and what makes it is not installed; before anything is run.
    """
    loaded = study if isinstance(study, Study) else load_study(study)
    if pdf:
        require_pdf()
    comparison = run_study(loaded, engine=engine, folder=folder, progress=progress)
    if progress is not None:
        progress(len(comparison.runs), len(comparison.runs), "drawing the report")
    return write_report(comparison, folder, sections=protocol_sections(comparison), pdf=pdf)


def write_report(
    comparison: Comparison, folder: str | Path, *, sections: Sequence[ProtocolSection] = (), pdf: bool = False
) -> ReportFiles:
    """Write a report and what is kept beside it, each file complete or not at all.

    Files of an earlier report in the folder that this one does not write are removed, as far as ``manifest.json`` names
    them and they have not been changed since.

    Parameters
    ----------
    comparison : Comparison
        From :func:`run_study`.
    folder : path
        Made if missing.
    sections : sequence of ProtocolSection, optional
        Protocols of fairness, in the order in which the report shows them.
    pdf : bool
        Whether to write ``report.pdf`` too.

    Raises
    ------
    ReportError
        If a PDF is asked for and what makes it is not installed; nothing is written then.
    """
    folder = Path(folder)
    if pdf:
        require_pdf()
    content = report_content(comparison, sections)
    page = render(content, "screen")
    metrics = json.dumps(metrics_data(comparison), indent=1, allow_nan=False) + "\n"
    printed = pdf_bytes(render(content, "paper")) if pdf else None
    tables = (*content.tables, *trial_tables(comparison))
    traced = [run for run in comparison.runs if run.trajectory.sizes["time"]]
    protocols = json.dumps(protocol_data(comparison), indent=1, allow_nan=False) + "\n" if comparison.protocols else ""
    written = ReportFiles(
        report=folder / "report.html",
        metrics=folder / "metrics.json",
        protocols=folder / "protocols.json" if protocols else None,
        pdf=folder / "report.pdf" if printed is not None else None,
        traces=tuple(folder / trace_name(run) for run in traced),
        tables=tuple(folder / "tables" / f"{table.name}.csv" for table in tables),
    )
    files = ReportFolder(folder)
    for path, run in zip(written.traces, traced, strict=True):
        files.write(path, trace_bytes(comparison, run))
    for path, table in zip(written.tables, tables, strict=True):
        files.write(path, csv_text(table).encode())
    files.write(written.report, page.encode())
    if written.pdf is not None and printed is not None:
        files.write(written.pdf, printed)
    if written.protocols is not None:
        files.write(written.protocols, protocols.encode())
    files.write(written.metrics, metrics.encode())
    files.finish()
    return written
