"""Messages for study files that cannot be used: file, line, key, what is wrong, what to do."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from brunovsky.comparison.study.keys import remedy

_HEADER = re.compile(r"\s*\[\[?\s*([\w.-]+)\s*\]\]?\s*(?:#.*)?$")

_NAMED = re.compile(r"([a-z]+)\[(\d+)\] ")


def describe(path: Path, text: str, error: ValidationError, models: Mapping[str, type[BaseModel]]) -> str:
    """One line for the first problem of a study file, with the number of others.

    Parameters
    ----------
    path, text
        The file and what is in it, to find the line.
    error : ValidationError
        From pydantic.
    models : mapping of str to model
        Model of each table of the file; ``""`` is the top level.
    """
    found = error.errors(include_url=False)
    # A list that is "too short" has lost the items with problems; a missing key is often one that is misspelt.
    problems = [one for one in found if one["type"] != "too_short"] or found
    problems.sort(key=lambda one: one["type"] == "missing")
    first = problems[0]
    where = [part for part in first["loc"] if part != "[key]"]
    if where[:1] == ["protocols"]:  # pydantic names the kind of a protocol as if it were a table
        del where[2:3]
    named = _NAMED.match(_plain(first)) if not where else None
    if named:  # a check of the whole study that names its table
        line = _line(text, [named[1], int(named[2]) - 1])
        return f"{path}{f', line {line}' if line else ''}: {_plain(first)}"
    line = _line(text, where)
    place = f"{path}, line {line}" if line else str(path)
    others = len(problems) - 1
    more = f" ({others} more problem{'s' if others > 1 else ''} after this one)" if others else ""
    return f"{place}: {_place(where)}{_what(first, where, models)}{more}"


def place_of(path: Path, text: str, key: str) -> str:
    """File, line and name of a key at the top of a study file."""
    line = _line(text, [key])
    return f"{path}{f', line {line}' if line else ''}: {key}"


def _what(problem: Any, where: list[int | str], models: Mapping[str, type[BaseModel]]) -> str:
    if problem["type"] == "extra_forbidden":
        table = next((str(part) for part in where[:-1] if not isinstance(part, int)), "")
        fields = models[table].model_fields if table in models else {}
        return f"unknown key; {remedy(str(where[-1]), list(fields))}"
    if problem["type"] == "missing":
        return "is missing; add it"
    if problem["type"] == "value_error":
        return _plain(problem)
    if problem["type"] == "tuple_type":
        return (
            f"is one table; write [[{where[0]}]]" if len(where) == 1 and where[0] in models else "is no list; write one"
        )
    message = str(problem["msg"]).replace("Tuple", "list").replace(" after validation", "")
    message = message[:1].lower() + message[1:]
    given = problem.get("input")
    return f"{message}; it is {given!r}" if isinstance(given, str | int | float | bool) else message


def _plain(problem: Any) -> str:
    return str(problem["msg"]).removeprefix("Value error, ")


def _place(where: list[int | str]) -> str:
    if not where:
        return ""
    parts: list[str] = []
    for part in where:
        if isinstance(part, int):
            parts[-1] += f"[{part + 1}]"
        else:
            parts.append(part)
    return ".".join(parts) + ": "


def _line(text: str, where: list[int | str]) -> int | None:
    """Number of the line that sets a key, or of its table's header; None where it isn't found."""
    names = [str(part) for part in where if not isinstance(part, int)]
    index = next((part for part in where if isinstance(part, int)), None)
    if not names:
        return None
    found = _line_of(text, names, index)
    return found if found or index is None else _line_of(text, names, None)  # an item of a list of values


def _line_of(text: str, names: list[str], index: int | None) -> int | None:
    counts: dict[str, int] = {}
    table: list[str] = []
    header = None
    for number, line in enumerate(text.splitlines(), 1):
        match = _HEADER.match(line)
        if match:
            table = match[1].split(".")
            if line.lstrip().startswith("[["):
                counts[table[0]] = counts.get(table[0], -1) + 1
        here = index is None or (bool(table) and table[0] == names[0] and counts.get(names[0]) == index)
        if match and here and table == names[: len(table)]:
            header = number
        assigned = re.match(r"\s*([\w.\-\"']+)\s*=", line)
        if assigned and here:
            path = [*table, *(part.strip("\"'") for part in assigned[1].split("."))]
            if path == names:
                return number
            if path == names[: len(path)]:  # an inline table
                header = number
    return header
