"""The proofs on the errata page hold: its code cells run here as they stand."""

import re
from pathlib import Path

ERRATA = Path(__file__).parents[2] / "docs" / "errata.md"
CELL = re.compile(r"^```\{code-cell\}[^\n]*\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_the_proofs_on_the_errata_page_hold() -> None:
    page = ERRATA.read_text(encoding="utf-8")
    cells = CELL.findall(page)
    assert len(cells) == page.count("{code-cell}")
    assert sum(cell.count("assert ") for cell in cells) >= 10
    names: dict[str, object] = {}
    for cell in cells:
        exec(compile(cell, str(ERRATA), "exec"), names)
