"""Every public name has a docstring and stands in docs/reference, and what stands there exists."""

import importlib
import pkgutil
import re
from functools import cache, reduce
from pathlib import Path
from types import ModuleType

import pytest

import brunovsky

REFERENCE = Path(__file__).parents[2] / "docs" / "reference"
DIRECTIVE = re.compile(
    r"^ *\.\. (?:auto|py:)(module|class|function|exception|data):: +(brunovsky[\w.]*) *$", re.MULTILINE
)


def public_modules() -> list[str]:
    """The package, its packages, the gallery, and the errors: where people import names from."""
    packages = [one.name for one in pkgutil.iter_modules(brunovsky.__path__) if one.ispkg and one.name[0] != "_"]
    nested = ["brunovsky.linearization.gallery", "brunovsky.errors"]
    return ["brunovsky", *(f"brunovsky.{name}" for name in packages), *nested]


def public_names(module: str) -> list[str]:
    loaded = importlib.import_module(module)
    if module == "brunovsky.errors":
        return [name for name, one in vars(loaded).items() if getattr(one, "__module__", "") == module]
    return list(loaded.__all__)


@cache
def documented() -> dict[str, object]:
    """Objects that the reference documents, by the name it gives them."""
    found = {}
    for page in sorted(REFERENCE.glob("*.md")):
        for kind, name in DIRECTIVE.findall(page.read_text(encoding="utf-8")):
            found[name] = _resolved(name, is_module=kind == "module")
    return found


def _resolved(name: str, *, is_module: bool) -> object:
    if is_module:
        return importlib.import_module(name)
    module, _, attribute = name.rpartition(".")
    return reduce(getattr, attribute.split("."), importlib.import_module(module))


def doc_of(module: ModuleType, name: str) -> str:
    """Docstring of a name; of a constant, which has none, the string that follows it in its source."""
    value = getattr(module, name)
    if isinstance(value, ModuleType) or callable(value):
        own = value.__doc__ or ""
        # a dataclass without a docstring gets its signature for one
        return "" if own.startswith(f"{name}(") else own
    for source in Path(brunovsky.__file__).parent.rglob("*.py"):
        match = re.search(rf'^{name}\b[^\n]*= [^\n]*\n"""(.+?)"""', source.read_text(encoding="utf-8"), re.M | re.S)
        if match:
            return match[1]
    return ""


PUBLIC = [(module, name) for module in public_modules() for name in public_names(module)]
IDS = [".".join(one) for one in PUBLIC]


@pytest.mark.parametrize(("module", "name"), PUBLIC, ids=IDS)
def test_public_name_has_a_docstring(module: str, name: str) -> None:
    assert doc_of(importlib.import_module(module), name).strip(), f"{module}.{name} has no docstring"


@pytest.mark.parametrize(("module", "name"), PUBLIC, ids=IDS)
def test_public_name_stands_in_the_reference(module: str, name: str) -> None:
    thing = getattr(importlib.import_module(module), name)
    assert any(one is thing for one in documented().values()), (
        f"{module}.{name} is missing from docs/reference; add '.. autofunction:: {module}.{name}' or the like"
    )


@pytest.mark.parametrize("name", sorted(documented()))
def test_what_stands_in_the_reference_is_public(name: str) -> None:
    if isinstance(documented()[name], ModuleType):
        return
    assert tuple(name.rpartition(".")[::2]) in PUBLIC, f"{name} stands in docs/reference but is not public"


def test_every_reference_page_is_in_the_index() -> None:
    listed = (REFERENCE / "index.md").read_text(encoding="utf-8").splitlines()
    pages = {page.stem for page in REFERENCE.glob("*.md")} - {"index"}
    assert pages <= set(listed)
