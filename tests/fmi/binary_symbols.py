"""Names that a shared library exports, and the libraries that it needs, read from ELF, PE and Mach-O files."""

from __future__ import annotations

import struct


def exported(data: bytes) -> set[str]:
    """Exported names of a library for Linux, Windows or macOS (64 bits)."""
    if data[:4] == b"\x7fELF":
        return _elf(data)
    if data[:2] == b"MZ":
        return _pe(data)
    assert struct.unpack_from("<I", data)[0] == 0xFEEDFACF, "neither ELF nor PE nor Mach-O"
    return _mach_o(data)


def parts(universal: bytes) -> list[bytes]:
    """Files in a universal file, after its header's own words."""
    magic, count = struct.unpack_from(">2I", universal)
    assert magic == 0xCAFEBABE
    rows = [struct.unpack_from(">5I", universal, 8 + 20 * one) for one in range(count)]
    assert all(start % (1 << alignment) == 0 for _, _, start, _, alignment in rows)
    files = [universal[start : start + size] for _, _, start, size, _ in rows]
    assert [struct.unpack_from("<2I", one, 4) for one in files] == [row[:2] for row in rows]
    return files


def _text(data: bytes, start: int) -> str:
    return data[start : data.index(b"\0", start)].decode()


def _elf(data: bytes) -> set[str]:
    start, size, count = *struct.unpack_from("<Q", data, 40), *struct.unpack_from("<2H", data, 58)
    sections = [struct.unpack_from("<2I4Q2I2Q", data, start + size * one) for one in range(count)]
    (symbols,) = (one for one in sections if one[1] == 11)  # SHT_DYNSYM
    names = sections[symbols[6]][4]
    rows = [struct.unpack_from("<I2BH2Q", data, symbols[4] + 24 * one) for one in range(symbols[5] // 24)]
    return {_text(data, names + name) for name, info, _, section, _, _ in rows if section and info >> 4 in (1, 2)}


def _pe(data: bytes) -> set[str]:
    header = struct.unpack_from("<I", data, 60)[0]
    sections, optional = struct.unpack_from("<H", data, header + 6)[0], struct.unpack_from("<H", data, header + 20)[0]
    first = header + 24 + optional
    rows = [struct.unpack_from("<4I", data, first + 40 * one + 8) for one in range(sections)]

    def place(address: int) -> int:
        return next(raw + address - base for size, base, _, raw in rows if base <= address < base + size)

    table = place(struct.unpack_from("<I", data, header + 24 + 112)[0])
    count, _, names = struct.unpack_from("<3I", data, table + 24)
    return {_text(data, place(struct.unpack_from("<I", data, place(names) + 4 * one)[0])) for one in range(count)}


def _mach_o(data: bytes) -> set[str]:
    place = 32
    for _ in range(struct.unpack_from("<I", data, 16)[0]):
        command, size = struct.unpack_from("<2I", data, place)
        if command in (0x22, 0x80000022, 0x80000033):  # LC_DYLD_INFO, LC_DYLD_INFO_ONLY, LC_DYLD_EXPORTS_TRIE
            start, length = struct.unpack_from("<2I", data, place + (8 if command == 0x80000033 else 40))
            return {one.removeprefix("_") for one in _trie(data[start : start + length], 0, "")}
        place += size
    raise AssertionError("a Mach-O file without a table of exported names")


def _trie(trie: bytes, node: int, prefix: str) -> set[str]:
    size, place = _number(trie, node)
    found = {prefix} if size else set()
    place += size
    children = trie[place]
    place += 1
    for _ in range(children):
        edge = _text(trie, place)
        child, place = _number(trie, place + len(edge) + 1)
        found |= _trie(trie, child, prefix + edge)
    return found


def _number(data: bytes, place: int) -> tuple[int, int]:
    """Number of groups of seven bits, lowest first, and where it ends."""
    value, shift = 0, 0
    while True:
        value |= (data[place] & 0x7F) << shift
        shift, place = shift + 7, place + 1
        if data[place - 1] < 0x80:
            return value, place
