"""Run every study that ships, in full; write its report to build/reports/NAME and comparisons/NAME.md.

Names of studies run these alone: ``python docs/refresh_reports.py noise matched``. The figure of the README is made
with the study ``paper``. A study with chatter tables has the summary of these, and of its runs' chatter, in place of
the one of its scenarios.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

from brunovsky.comparison import (
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

ROOT = Path(__file__).resolve().parents[1]
STUDIES = ROOT / "comparisons"


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
        (ROOT / "docs" / "_static" / "paper.svg").write_text(readme_figure(comparison), encoding="utf-8")


if __name__ == "__main__":
    wanted = sys.argv[1:]
    unknown = sorted(set(wanted) - {path.stem for path in STUDIES.glob("*.toml")})
    if unknown:
        sys.exit(f"there is no study {', '.join(unknown)} in {STUDIES}")
    main(wanted)
