"""What the laws of a study are that are not of the paper's form: read from the blocks that the runs simulate."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import brunovsky.blocks.library as library
from brunovsky.blocks import Block
from brunovsky.comparison.facts import given
from brunovsky.comparison.protocol_section import Table
from brunovsky.comparison.run import Comparison, Run
from brunovsky.comparison.study import Law
from brunovsky.comparison.symbols import unit_text, variable_symbol

_OWN = "this project"  # source of a block that names none
_REFERENCES = re.compile(r"^References\n-+\n(.*?)(?=^\w+\n-+\n|\Z)", re.MULTILINE | re.DOTALL)
_SOURCE = re.compile(r"^Source: (.*?)(?=\n\n|\Z)", re.MULTILINE | re.DOTALL)
_NAMED = re.compile(r":func:`(?:[\w.]+\.)?(\w+)`")
_OF_THE_TASK = re.compile(r"(x|y|theta|eta|u|goal|d|rho)(_start|_heading)?(\[\d\])?")


@dataclass(frozen=True)
class OtherLaw:
    """A law that is not of the paper's form.

    Attributes
    ----------
    name, title : str
        As in the study.
    description : str
        What the block says that it is.
    parameters : str
        With which values it was run, with units.
    source : str
        Where it comes from, as the reference of the block says.
    """

    name: str
    title: str
    description: str
    parameters: str
    source: str


def other_laws(comparison: Comparison) -> tuple[OtherLaw, ...]:
    """Laws of a comparison that are not of the paper's form, in the order of the study."""
    return tuple(
        _other_law(law, [run for run in comparison.runs if run.planned.law == law.name])
        for law in comparison.study.laws
        if not law.in_family
    )


def other_laws_table(comparison: Comparison) -> Table:
    """What they are, a row for each."""
    rows = tuple((one.name, one.description, one.parameters, one.source) for one in other_laws(comparison))
    return Table("laws", ("law", "what it is", "parameters of the runs", "source"), rows)


def source_of(maker: Callable[..., Any]) -> str:
    """Source of a block of the library: the references of its docstring, or those of the block that it refers to."""
    text = inspect.getdoc(maker) or ""
    found = _REFERENCES.search(text) or _SOURCE.search(text)
    source = " ".join(found[1].split()) if found else ""
    named = _NAMED.search(source or text)
    if named and (not source or source.startswith("See ")):
        return source_of(getattr(library, named[1]))
    plain = re.sub(r"[`*]", "", source).rstrip(".") or _OWN
    return plain[0].upper() + plain[1:]


def _other_law(law: Law, runs: list[Run]) -> OtherLaw:
    loop = law.loop()
    return OtherLaw(law.name, law.title or law.name, loop.law.description, _told(loop.law, runs), source_of(loop.maker))


def _told(block: Block, runs: list[Run]) -> str:
    """Parameters of a block as its runs had them; a range where scenarios differ."""
    parts = []
    for one in block.parameters:
        found = {
            run.planned.parameters.get(f"controller.{one.name}", run.planned.parameters.get(one.name)) for run in runs
        }
        values = sorted(value for value in found if value is not None)
        if values and not _OF_THE_TASK.fullmatch(one.name):
            ends = [given(values[0])] if len(values) == 1 else [given(values[0]), given(values[-1])]
            parts.append(f"{variable_symbol(one.name)} = {' to '.join(ends)} {unit_text(one.unit)}".rstrip())
    return ", ".join(parts)
