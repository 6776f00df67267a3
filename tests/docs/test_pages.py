"""What the pages show can be pasted: visible cells, in order, use only names that visible cells define."""

import ast
import builtins
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
CELL = re.compile(r"^```\{code-cell\}[^\n]*\n((?::[^\n]*\n)*)(.*?)^```$", re.MULTILINE | re.DOTALL)
PAGES = sorted(page for page in DOCS.rglob("*.md") if "_build" not in page.parts and "{code-cell}" in page.read_text())


def visible_cells(page: Path) -> list[str]:
    text = page.read_text(encoding="utf-8")
    cells = CELL.findall(text)
    assert len(cells) == text.count("{code-cell}")
    return [code for options, code in cells if not re.search(r"remove-(input|cell)|hide-(input|cell)", options)]


def defined(statement: ast.stmt) -> set[str]:
    """Names that a statement defines, those of inner scopes included."""
    names = set()
    for node in ast.walk(statement):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
        elif isinstance(node, ast.alias):
            names.add((node.asname or node.name).partition(".")[0])
        elif isinstance(node, ast.FunctionDef | ast.ClassDef):
            names.add(node.name)
        elif isinstance(node, ast.arg):
            names.add(node.arg)
        elif isinstance(node, ast.ExceptHandler) and node.name:
            names.add(node.name)
    return names


def used(statement: ast.stmt) -> set[str]:
    return {one.id for one in ast.walk(statement) if isinstance(one, ast.Name) and isinstance(one.ctx, ast.Load)}


def missing(cells: list[str]) -> set[str]:
    known, lacking = set(dir(builtins)), set()
    for cell in cells:
        for statement in ast.parse(cell).body:
            known |= defined(statement)
            lacking |= used(statement) - known
    return lacking


def test_a_missing_name_is_found() -> None:
    assert missing(["import a.b as c\n", "d = c.e + [f for f in d]\n", "print(d, np.pi)\n"]) == {"np"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(DOCS).as_posix())
def test_visible_cells_stand_alone(page: Path) -> None:
    cells = visible_cells(page)
    assert missing(cells) == set()
    for cell in cells:
        assert not re.search(r"\b(import|from) pages\b", cell), "a helper of the pages is shown"
