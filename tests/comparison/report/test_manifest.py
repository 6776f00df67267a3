"""A report in the folder of an earlier one leaves nothing of that one behind, and takes nothing that is not its own."""

import pytest

from brunovsky.comparison.report.manifest import ReportFolder


def report(folder, **files: bytes) -> tuple[str, ...]:
    """A report that writes traces of these names; what it removed."""
    writing = ReportFolder(folder)
    for name, data in files.items():
        writing.write(folder / "traces" / f"{name}.nc", data)
    return tuple(path.relative_to(folder).as_posix() for path in writing.finish())


def names(folder):
    return sorted(path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file())


def test_what_was_changed_since_stays(tmp_path):
    report(tmp_path, a=b"1", b=b"2")
    (tmp_path / "traces" / "a.nc").write_bytes(b"by hand")
    assert report(tmp_path, c=b"3") == ("traces/b.nc",)
    assert names(tmp_path) == ["manifest.json", "traces/a.nc", "traces/c.nc"]


def test_an_interrupted_report_removes_nothing_and_the_next_one_removes_what_it_left(tmp_path):
    report(tmp_path, a=b"1", b=b"2")
    writing = ReportFolder(tmp_path)
    writing.write(tmp_path / "traces" / "b.nc", b"new")
    writing.write(tmp_path / "traces" / "c.nc", b"3")  # and no more
    assert names(tmp_path) == ["manifest.json", "traces/a.nc", "traces/b.nc", "traces/c.nc"]
    assert report(tmp_path, d=b"4") == ("traces/a.nc", "traces/b.nc", "traces/c.nc")


@pytest.mark.parametrize(
    "name", ["../own.nc", "traces/../../own.nc", "/etc/own.nc", "own.nc", "traces/a/own.nc", "fmus/x.fmu"]
)
def test_a_manifest_that_names_other_files_removes_none_of_them(tmp_path, name):
    folder = tmp_path / "out"
    report(folder, a=b"1")
    text = (folder / "manifest.json").read_text()
    target = folder / name
    if not name.startswith("/"):
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(b"1")
    (folder / "manifest.json").write_text(text.replace("traces/a.nc", name))
    assert report(folder, b=b"1") == ()
    assert name.startswith("/") or target.exists()


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"sha256": [1]}', '{"sha256": {"traces/a.nc": 1}}', "\xff"])
def test_a_file_of_that_name_that_no_report_wrote_removes_nothing(tmp_path, text):
    (tmp_path / "traces").mkdir()
    (tmp_path / "traces" / "a.nc").write_bytes(b"1")
    (tmp_path / "manifest.json").write_text(text, encoding="latin-1")
    assert report(tmp_path, b=b"2") == ()
    assert names(tmp_path) == ["manifest.json", "traces/a.nc", "traces/b.nc"]


def test_names_that_differ_in_case_alone_are_one_file(tmp_path):
    report(tmp_path, a=b"1")
    assert report(tmp_path, A=b"1") == ()


def test_a_link_is_not_followed(tmp_path):
    folder, elsewhere = tmp_path / "out", tmp_path / "elsewhere.nc"
    report(folder, a=b"1")
    elsewhere.write_bytes(b"1")
    (folder / "traces" / "a.nc").unlink()
    (folder / "traces" / "a.nc").symlink_to(elsewhere)
    assert report(folder, b=b"2") == () and elsewhere.exists()
