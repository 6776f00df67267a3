"""Analysis of a study without simulating its runs: poles, margins, bounds, singularity, and predicted chatter."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from brunovsky._frozen import FrozenMapping
from brunovsky.analysis import ChatterRow, chatter_table
from brunovsky.comparison.analyze_figures import analysis_figures
from brunovsky.comparison.analyzed_loops import AnalyzedLaw, analyzed_laws, family_runs, laws_outside
from brunovsky.comparison.analyzed_runs import AnalyzedRun, analyzed_run
from brunovsky.comparison.output import plain, write_text
from brunovsky.comparison.run import Progress, study_provenance
from brunovsky.comparison.study import Study, load_study
from brunovsky.comparison.study.chatter_grid import ChatterGrid
from brunovsky.errors import ParameterError, StudyError


@dataclass(frozen=True, eq=False)
class Analysis:
    """What is known of a study before any of its runs is simulated.

    Attributes
    ----------
    study : Study
        What was asked for.
    laws : tuple of AnalyzedLaw
        Poles, margins and so on of each law of the paper's family; what is of another kind is not analysed.
    runs : tuple of AnalyzedRun
        Reaching, bounds and singularity, scenario by scenario, law by law.
    chatter : tuple of tuple of ChatterRow
        Chatter, grid by grid.
    provenance : mapping
        Versions, and when it was made.
    """

    study: Study
    laws: tuple[AnalyzedLaw, ...]
    runs: tuple[AnalyzedRun, ...]
    chatter: tuple[tuple[ChatterRow, ...], ...]
    provenance: Mapping[str, Any]

    @property
    def grids(self) -> tuple[tuple[ChatterGrid, tuple[ChatterRow, ...]], ...]:
        """Chatter grids with their rows."""
        return tuple(zip(self.study.chatter_grids(), self.chatter, strict=True))


class AnalysisFiles(NamedTuple):
    """What an analysis leaves behind."""

    analysis: Path
    figures: tuple[Path, ...]


def analyze_study(study: Study | str | Path, *, progress: Progress | None = None) -> Analysis:
    """Analyse the laws of a study, its runs before they are simulated, and its chatter grids.

    Parameters
    ----------
    study : Study or path
        A study, or its file (TOML).
    progress : function of (done, total, what), optional
        Called before each run and each point of a chatter grid, and at the end.

    Returns
    -------
    Analysis
        Where something is undefined (an unstable loop, a switching law's forecast) it is None, with the reason where
        that is not plain.

    Raises
    ------
    StudyError
        If the study file cannot be used, or a chatter table asks for a period that is too fine to be followed.
    """
    loaded = study if isinstance(study, Study) else load_study(study)
    plan, grids = family_runs(loaded), loaded.chatter_grids()
    total = len(plan) + sum(len(grid.loops) for grid in grids)
    step = _counter(total, progress or (lambda done, total, what: None))
    step("laws", 0)
    laws = analyzed_laws(loaded)
    runs = []
    for planned in plan:
        step(planned.name, 1)
        runs.append(analyzed_run(planned, loaded.law(planned.law)))
    chatter = []
    for number, grid in enumerate(grids, 1):
        rows: list[ChatterRow] = []
        for loop in grid.loops:
            step(f"chatter: {grid.title}", 1)
            try:
                rows += chatter_table([loop])
            except ParameterError as error:
                raise StudyError(f"study '{loaded.name}', chatter[{number}] ('{grid.title}'): {error}") from None
        chatter.append(tuple(rows))
    step("analysis", 1)
    return Analysis(loaded, laws, tuple(runs), tuple(chatter), FrozenMapping(study_provenance(loaded)))


def write_analysis(analysis: Analysis, folder: str | Path, *, progress: Progress | None = None) -> AnalysisFiles:
    """Write ``analysis.json`` and ``figures/*.svg``, each complete or not at all.

    Parameters
    ----------
    analysis : Analysis
        From :func:`analyze_study`.
    folder : path
        Made if missing.
    progress : function of (done, total, what), optional
        Called before each figure.

    Raises
    ------
    StudyError
        If the folder is a file.
    """
    folder = Path(folder)
    require_folder(folder)
    figures = analysis_figures(analysis, progress)
    data = analysis_data(analysis) | {"figures": [f"figures/{name}.svg" for name in figures]}
    text = json.dumps(data, indent=1, allow_nan=False) + "\n"
    (folder / "figures").mkdir(parents=True, exist_ok=True)
    written = AnalysisFiles(folder / "analysis.json", tuple(folder / "figures" / f"{name}.svg" for name in figures))
    for path, figure in zip(written.figures, figures.values(), strict=True):
        write_text(path, figure + "\n")
    write_text(written.analysis, text)
    return written


def require_folder(folder: Path) -> None:
    """Refuse a folder that cannot be one, before any work is done for it."""
    for path in (folder / "figures", folder, *folder.parents):
        if path.exists() and not path.is_dir():
            raise StudyError(f"{path}: is a file where a folder is needed; give another folder, or move the file away")


def analysis_data(analysis: Analysis) -> dict[str, Any]:
    """What ``analysis.json`` holds: SI units, angles in rad, null for what is infinite or undefined.

    Parameters
    ----------
    analysis : Analysis
        From :func:`analyze_study`.
    """
    study = analysis.study
    return {
        "study": study.name,
        "provenance": {**plain(analysis.provenance), "resolved_study": study.model_dump(mode="json")},
        "laws": plain(analysis.laws),
        "laws_not_analyzed": list(laws_outside(study)),
        "runs": plain(analysis.runs),
        "chatter": [{"grid": grid.title, **plain(row)} for grid, rows in analysis.grids for row in rows],
    }


def _counter(total: int, progress: Progress) -> Callable[[str, int], None]:
    """Progress by name of what comes next; `advance` is 1 for each of the `total` items, and once more at the end."""
    begun = 0

    def step(what: str, advance: int) -> None:
        nonlocal begun
        begun += advance
        progress(max(begun - 1, 0), total, what)

    return step
