"""XML that may be hostile: refused before a parser that resolves entities sees it."""

from __future__ import annotations

from pathlib import Path
from xml.parsers import expat

from brunovsky.errors import BrunovskyError

MAX_BYTES = 64 << 20
MAX_DEPTH = 64


class _Refused(Exception):
    pass


def require_plain(path: Path, shown: str) -> None:
    """Require a well-formed XML file of moderate size and depth without a document type.

    Without one there are no entities besides the five of XML, and nothing to load from elsewhere.

    Raises
    ------
    BrunovskyError
        If it is something else; ``shown`` is its name in the message.
    """
    if path.stat().st_size > MAX_BYTES:
        raise BrunovskyError(f"{shown}: refused: larger than {MAX_BYTES >> 20} MiB")
    depth = 0

    def doctype(*_: object) -> None:
        raise _Refused("it declares a document type, by which entities and other files could be pulled in; remove it")

    def start(*_: object) -> None:
        nonlocal depth
        depth += 1
        if depth > MAX_DEPTH:
            raise _Refused(f"elements are nested more than {MAX_DEPTH} deep")

    def end(*_: object) -> None:
        nonlocal depth
        depth -= 1

    parser = expat.ParserCreate()
    parser.StartDoctypeDeclHandler = doctype
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    try:
        with path.open("rb") as file:
            parser.ParseFile(file)
    except _Refused as error:
        raise BrunovskyError(f"{shown}: refused: {error}") from None
    except (expat.ExpatError, LookupError, ValueError) as error:
        raise BrunovskyError(f"{shown}: not well-formed XML: {error}") from None
