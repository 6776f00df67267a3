"""Run every study that ships, in full; write its report to build/reports/NAME and comparisons/NAME.md.

Names of studies run these alone: ``python docs/refresh_reports.py noise matched``. The figure of the README is made
with the study ``paper``, that of the page on coupling with the study ``coupling``. A study with chatter tables has the
summary of these, and of its runs' chatter, in place of the one of its scenarios.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from matplotlib import pyplot

from brunovsky.analysis import coupling_error_plot
from brunovsky.analysis.coupling.scheme import ORDERS
from brunovsky.comparison import (
    Comparison,
    analyze_study,
    chatter_markdown,
    load_study,
    protocol_sections,
    readme_figure,
    run_study,
    sections_markdown,
    summary_markdown,
    write_report,
)
from brunovsky.comparison.protocols import Coupling

ROOT = Path(__file__).resolve().parents[1]
STUDIES = ROOT / "comparisons"
STATIC = ROOT / "docs" / "_static"


def main(names: list[str]) -> None:
    """Run the studies of these names, by default all."""
    for path in sorted(STUDIES.glob("*.toml")):
        if not names or path.stem in names:
            started = time.perf_counter()
            refresh(path)
            print(f"{path.stem}: {time.perf_counter() - started:.0f} s", flush=True)


def refresh(path: Path) -> None:
    """Run one study, and write what is kept of it."""
    study = load_study(path)
    folder = ROOT / "build" / "reports" / path.stem
    comparison = run_study(study, folder=folder)
    sections = protocol_sections(comparison)
    write_report(comparison, folder, sections=sections)
    if study.chatter:
        summary = chatter_markdown(analyze_study(study)) + "\n".join([*sections_markdown(sections), ""])
    else:
        summary = summary_markdown(comparison)
    path.with_suffix(".md").write_text(summary, encoding="utf-8")
    if path.stem == "paper":
        (STATIC / "paper.svg").write_text(readme_figure(comparison), encoding="utf-8")
    if path.stem == "coupling":
        draw_coupling(comparison)


def draw_coupling(comparison: Comparison) -> None:
    """Coupling error under pole placement over the communication step, with the limits of stability."""
    found = next(one.result for one in comparison.protocols if isinstance(one.result, Coupling))
    stable = [one for one in found.errors["linear"] if one.error < found.large]
    limits = {f"limit {words}, inputs held": found.limits["linear", scheme, 0] for scheme, words in ORDERS.items()}
    style = {"svg.hashsalt": "brunovsky", "svg.fonttype": "path", "axes.grid": True, "grid.alpha": 0.35}
    with pyplot.rc_context(style):
        drawn = coupling_error_plot(stable, limits=limits)
        drawn.figure.savefig(STATIC / "coupling.svg", metadata={"Date": None})


if __name__ == "__main__":
    wanted = sys.argv[1:]
    unknown = sorted(set(wanted) - {path.stem for path in STUDIES.glob("*.toml")})
    if unknown:
        sys.exit(f"there is no study {', '.join(unknown)} in {STUDIES}")
    main(wanted)
