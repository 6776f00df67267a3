"""Writes what is committed of the studies: comparisons/paper.md, comparisons/chatter.md and docs/_static/paper.svg.

Run it from the root of the repository after a change that moves the numbers: ``python docs/refresh_paper.py``.
"""

from pathlib import Path

from brunovsky.comparison import (
    analyze_study,
    chatter_markdown,
    load_study,
    readme_figure,
    run_study,
    summary_markdown,
)

ROOT = Path(__file__).resolve().parents[1]

comparison = run_study(load_study(ROOT / "comparisons" / "paper.toml"))
(ROOT / "comparisons" / "paper.md").write_text(summary_markdown(comparison), encoding="utf-8")
chatter = analyze_study(ROOT / "comparisons" / "chatter.toml")
(ROOT / "comparisons" / "chatter.md").write_text(chatter_markdown(chatter), encoding="utf-8")
(ROOT / "docs" / "_static" / "paper.svg").write_text(readme_figure(comparison), encoding="utf-8")
