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
    place, found = 32, set()
    for _ in range(struct.unpack_from("<I", data, 16)[0]):
        command, size = struct.unpack_from("<2I", data, place)
        if command == 2:  # LC_SYMTAB
            symbols, count, names, _ = struct.unpack_from("<4I", data, place + 8)
            for one in range(count):
                name, kind = struct.unpack_from("<IB", data, symbols + 16 * one)
                if kind & 0x1F == 0x0F:  # external, defined in a section, not private
                    found.add(_text(data, names + name).removeprefix("_"))
        place += size
    return found
