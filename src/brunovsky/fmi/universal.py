"""Universal libraries of macOS: several Mach-O files, one for each processor, in one file.

The layout is that of ``mach-o/fat.h``: a header of big-endian words, then the files, each aligned to a page of its
processor.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence

from brunovsky.errors import ParameterError

FAT_MAGIC = 0xCAFEBABE
_MACH_O_64 = 0xFEEDFACF
_ALIGNMENT = 14  # pages of 16 KiB, those of aarch64, do for x86_64 as well


def universal_library(libraries: Sequence[bytes]) -> bytes:
    """Universal file of Mach-O files.

    Parameters
    ----------
    libraries : sequence of bytes
        64-bit Mach-O files, each for another processor.

    Returns
    -------
    bytes
        The universal file, its parts in the order given.

    Raises
    ------
    ParameterError
        If one isn't a 64-bit Mach-O file, or two are for one processor.
    """
    processors = [_processor(one) for one in libraries]
    if len({kind for kind, _ in processors}) != len(processors):
        raise ParameterError("two Mach-O files for one processor; a universal file has one of each")
    header = struct.pack(">2I", FAT_MAGIC, len(libraries))
    body = b""
    start = len(header) + 20 * len(libraries)
    for (kind, subkind), library in zip(processors, libraries, strict=True):
        body += b"\0" * (-(start + len(body)) % (1 << _ALIGNMENT))
        header += struct.pack(">5I", kind, subkind, start + len(body), len(library), _ALIGNMENT)
        body += library
    return header + body


def _processor(library: bytes) -> tuple[int, int]:
    """CPU type and subtype of a Mach-O file."""
    if len(library) < 12 or struct.unpack_from("<I", library)[0] != _MACH_O_64:
        raise ParameterError("not a 64-bit Mach-O file; compile it for macOS")
    kind, subkind = struct.unpack_from("<2I", library, 4)
    return kind, subkind
