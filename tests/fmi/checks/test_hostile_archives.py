"""Archives that would do harm are refused before anything is written, with a reason."""

import os
import stat
import struct
import zipfile
from collections.abc import Mapping
from pathlib import Path

import fmpy
import pytest

from brunovsky.errors import BrunovskyError
from brunovsky.fmi import check_fmu
from brunovsky.fmi.checks import markup, unpacking
from brunovsky.fmi.checks.unpacking import unpack_fmu

GOOD = {
    "modelDescription.xml": b'<fmiModelDescription fmiVersion="2.0"/>',
    f"binaries/{fmpy.platform}/a.so": b"not a library",
}


def archive_of(path: Path, files: Mapping[str, bytes], links: Mapping[str, str] | None = None) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in files.items():
            entry = zipfile.ZipInfo("placeholder")
            entry.filename = entry.orig_filename = name  # as it is, not made harmless
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, text)
        for name, target in (links or {}).items():
            entry = zipfile.ZipInfo(name)
            entry.create_system, entry.external_attr = 3, (stat.S_IFLNK | 0o777) << 16
            archive.writestr(entry, target)
    return path


def refused(path: Path, folder: Path) -> str:
    """Message of the refusal, which left the folder and what is around it as they were."""
    inside = folder / "deep" / "inside"
    inside.mkdir(parents=True)
    with pytest.raises(BrunovskyError) as error:
        unpack_fmu(path, inside)
    assert sorted(folder.rglob("*")) == [folder / "deep", inside]
    message = str(error.value)
    assert str(path) in message and "\n" not in message
    return message


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("../evil", "leaves the folder"),
        ("resources/../../../evil", "leaves the folder"),
        ("/tmp/brunovsky-evil", "absolute"),
        ("C:/evil", "absolute"),
        ("c:evil", "absolute"),
        ("..\\evil", "backslash"),
        ("\\\\server\\evil", "backslash"),
        ("resources//evil", "not a plain path"),
        ("resources/./evil", "not a plain path"),
        ("resources/e\nvil", "not a plain path"),
        ("resources/" + 300 * "x", "too long"),
        (40 * "x/" + "x", "too long"),
        ("modeldescription.XML", "differ in case"),
        ("modelDescription.xml/evil", "both a file and a folder"),
    ],
)
def test_paths_that_leave_the_folder(tmp_path: Path, name: str, says: str) -> None:
    path = archive_of(tmp_path / "a.fmu", {**GOOD, name: b"evil"})
    assert says in refused(path, tmp_path / "target")


@pytest.mark.parametrize("target", ["/etc/passwd", "../../x", "modelDescription.xml"])
def test_links(tmp_path: Path, target: str) -> None:
    path = archive_of(tmp_path / "a.fmu", GOOD, {"resources/link": target})
    assert "is a link or device" in refused(path, tmp_path / "target")


def test_a_bomb_by_its_ratio(tmp_path: Path) -> None:
    path = archive_of(tmp_path / "a.fmu", {**GOOD, "resources/zeros": bytes(8 << 20)})
    assert path.stat().st_size < 20_000
    assert "as bombs do" in refused(path, tmp_path / "target")


def test_a_bomb_by_its_sum(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(unpacking, "MAX_BYTES", 1 << 20)
    parts = {f"resources/{one}": os.urandom(4096) + bytes(1 << 18) for one in range(8)}
    path = archive_of(tmp_path / "a.fmu", {**GOOD, **parts})
    assert "it unpacks to 2 MiB, more than 1" in refused(path, tmp_path / "target")


def test_a_bomb_that_lies_about_its_size(tmp_path: Path) -> None:
    path = archive_of(tmp_path / "a.fmu", {**GOOD, "resources/zeros": bytes(8 << 20)})
    data = bytearray(path.read_bytes())
    for signature, place in ((b"PK\x03\x04", 22), (b"PK\x01\x02", 24)):
        at = data.rindex(signature)
        data[at + place : at + place + 4] = struct.pack("<I", 100)
    path.write_bytes(bytes(data))
    target = tmp_path / "target"
    target.mkdir()
    with pytest.raises(BrunovskyError, match="not a zip archive that can be read"):
        unpack_fmu(path, target)
    assert sum(one.stat().st_size for one in target.rglob("*") if one.is_file()) < 1000


def test_too_many_entries(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(unpacking, "MAX_ENTRIES", 3)
    path = archive_of(tmp_path / "a.fmu", {**GOOD, "a": b"", "b": b""})
    assert "has 4 entries, more than 3" in refused(path, tmp_path / "target")


@pytest.mark.parametrize(("missing", "says"), [("modelDescription.xml", "isn't an FMU"), ("binaries", "no binaries")])
def test_what_an_fmu_must_have(tmp_path: Path, missing: str, says: str) -> None:
    path = archive_of(tmp_path / "a.fmu", {name: text for name, text in GOOD.items() if not name.startswith(missing)})
    assert says in refused(path, tmp_path / "target")


@pytest.mark.parametrize("content", [b"", b"no zip at all", b"PK\x03\x04 cut", b"PK\x05\x06" + bytes(18)])
def test_what_is_no_archive(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.fmu"
    path.write_bytes(content)
    assert refused(path, tmp_path / "target")


def test_a_cut_archive(tmp_path: Path) -> None:
    path = archive_of(tmp_path / "a.fmu", GOOD)
    path.write_bytes(path.read_bytes()[:-30])
    assert "not a zip archive" in refused(path, tmp_path / "target")


def test_what_is_no_file(tmp_path: Path) -> None:
    assert "no such file" in refused(tmp_path / "missing.fmu", tmp_path / "one")
    os.mkfifo(tmp_path / "pipe.fmu")  # to open it would wait for ever
    assert "not a file" in refused(tmp_path / "pipe.fmu", tmp_path / "two")
    assert "not a file" in refused(tmp_path, tmp_path / "three")


def test_a_secret(tmp_path: Path) -> None:
    path = archive_of(tmp_path / "a.fmu", GOOD)
    data = bytearray(path.read_bytes())
    data[data.index(b"PK\x01\x02") + 8] |= 1
    path.write_bytes(bytes(data))
    assert "is encrypted" in refused(path, tmp_path / "target")


LAUGHS = (
    '<!DOCTYPE a [<!ENTITY l0 "lol">'
    + "".join(f'<!ENTITY l{i} "{10 * f"&l{i - 1};"}">' for i in range(1, 10))
    + ']><fmiModelDescription fmiVersion="2.0" modelName="&l9;"/>'
)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (LAUGHS.encode(), "document type"),
        ('<?xml version="1.0" encoding="UTF-16"?>'.encode("utf-16") + LAUGHS.encode("utf-16")[2:], "document type"),
        (b'<!DOCTYPE a SYSTEM "file:///etc/passwd"><fmiModelDescription/>', "document type"),
        (b'<!DOCTYPE a [<!ENTITY x SYSTEM "http://localhost/">]><a>&x;</a>', "document type"),
        (b'<?xml version="1.0" encoding="ebcdic-none"?><a/>', "not well-formed"),
        (b"<a><b></a>", "not well-formed"),
        (b"", "not well-formed"),
        (70 * b"<a>" + 70 * b"</a>", "nested more than 64 deep"),
        (b'<fmiModelDescription fmiVersion="1.0"/>', "fmiVersion '1.0' is not known"),
        (b"<html/>", "fmiVersion '' is not known"),
    ],
)
def test_hostile_xml(tmp_path: Path, text: bytes, says: str) -> None:
    path = archive_of(tmp_path / "a.fmu", {**GOOD, "modelDescription.xml": text})
    with pytest.raises(BrunovskyError, match=says) as error:
        check_fmu(path)
    assert "passwd" not in str(error.value).replace("/etc/passwd", "") and "root:" not in str(error.value)


def test_huge_xml(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(markup, "MAX_BYTES", 1 << 20)
    path = archive_of(
        tmp_path / "a.fmu", {**GOOD, "modelDescription.xml": b"<!--" + os.urandom(1 << 20).hex().encode()}
    )
    with pytest.raises(BrunovskyError, match="larger than 1 MiB"):
        check_fmu(path)
