"""Hash of everything that a block says: equal hashes mean equal blocks, in any process."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Iterable, Mapping
from functools import lru_cache
from typing import Any

import sympy as sp

from brunovsky.blocks.block import Block

_KNOWN = ("brunovsky", "sympy")


class _UnknownKind(Exception):
    """A value whose text does not say all that it is."""


@lru_cache(maxsize=64)
def block_digest(block: Block) -> str | None:
    """Hash of a block by its declarations, expressions, and components if it is a diagram.

    Parameters
    ----------
    block : Block
        Any block or diagram.

    Returns
    -------
    str or None
        64 hexadecimal digits; None if something in it is of a class of neither this package nor SymPy (a function of
        one's own), whose name does not say what it does.
    """
    try:
        return _digest(block, {}).hex()
    except _UnknownKind:
        return None


_Known = dict[int, tuple[sp.Basic, bytes]]
"""Hashes of expressions by identity, since equal ones may differ: 1.0 and 1, or numbers of other precision."""


def _digest(value: Any, known: _Known) -> bytes:
    if isinstance(value, sp.Basic):
        if id(value) not in known:
            kind, args = _kind(value), value.args
            found = _node(kind, (_digest(one, known) for one in args)) if args else _leaf(kind, sp.srepr(value))
            known[id(value)] = value, found
        return known[id(value)][1]
    if dataclasses.is_dataclass(value):
        fields = (getattr(value, one.name) for one in dataclasses.fields(value))
        return _node(_kind(value), (_digest(one, known) for one in fields))
    if isinstance(value, Mapping):
        return _node("mapping", (_digest(one, known) for pair in value.items() for one in pair))
    if isinstance(value, tuple | list):
        return _node("sequence", (_digest(one, known) for one in value))
    if value is None or isinstance(value, str | int | float):
        return _leaf(type(value).__name__, repr(value))
    raise _UnknownKind


def _kind(value: object) -> str:
    module, name = type(value).__module__, type(value).__qualname__
    if module.partition(".")[0] not in _KNOWN:
        raise _UnknownKind
    return f"{module}.{name}"


def _node(kind: str, parts: Iterable[bytes]) -> bytes:
    return hashlib.sha256(b"\0".join([kind.encode(), b"".join(parts)])).digest()


def _leaf(kind: str, text: str) -> bytes:
    return hashlib.sha256(b"\0".join([kind.encode(), b"=", text.encode()])).digest()
