"""What is kept beside a report (netCDF, CSV), the PDF, and the JSON schema of study files."""

import builtins
import csv
import json
import sys
import tomllib

import jsonschema
import numpy as np
import pytest
import xarray as xr

from brunovsky._resources import resource
from brunovsky.comparison import (
    ProtocolSection,
    Table,
    compare_study,
    load_study,
    run_study,
    study_schema,
    write_report,
)
from brunovsky.comparison.report.pdf import pdf_bytes
from brunovsky.comparison.schema import schema_text
from brunovsky.errors import ParameterError, ReportError


def test_traces_are_the_trajectories(small, tmp_path):
    comparison = run_study(load_study(small))
    written = write_report(comparison, tmp_path)
    assert [one.name for one in written.traces] == ["circle--linear.nc", "circle--relay.nc"]
    data = json.loads(written.metrics.read_text())
    assert [run["trace"] for run in data["runs"]] == ["traces/circle--linear.nc", "traces/circle--relay.nc"]
    for path, run in zip(written.traces, comparison.runs, strict=True):
        with xr.open_dataset(path, engine="scipy") as trace:
            assert set(trace.data_vars) == set(run.trajectory.data_vars)
            for name, one in run.trajectory.variables.items():
                np.testing.assert_array_equal(trace[name].values, one.values)
            assert trace["eta[1]"].attrs["units"] == "m/s"
            assert trace.attrs["law"] == run.planned.law and trace.attrs["status"] == "ok"
            assert json.loads(trace.attrs["parameters"]) == dict(run.planned.parameters)


def test_tables_have_all_digits(small, tmp_path):
    comparison = run_study(load_study(small))
    table = Table("front", ("law", "IAE", "nothing"), (("linear", 1.0 / 3.0, None), ("relay", 2, float("nan"))))
    written = write_report(comparison, tmp_path, sections=[ProtocolSection("Front", "How.", table=table)])
    rows = {path.stem: list(csv.reader(path.open(encoding="utf-8", newline=""))) for path in written.tables}
    assert set(rows) == {"metrics", "overall", "claims", "loops", "margins", "front"}
    head, *body = rows["metrics"]
    assert len(body) == 2 and float(body[1][head.index("iae")]) == comparison.runs[1].metrics.iae
    assert body[0][head.index("status_time")] == ""
    assert rows["front"][1:] == [["linear", repr(1.0 / 3.0), ""], ["relay", "2", ""]]


def test_a_table_with_a_row_too_short_is_refused():
    with pytest.raises(ParameterError, match="1 cells for 2 columns"):
        Table("one", ("a", "b"), (("x",),))


def test_the_same_traces_and_tables_have_the_same_bytes(small, tmp_path):
    first, second = (write_report(run_study(load_study(small)), tmp_path / name) for name in ("a", "b"))
    for a, b in zip((*first.traces, *first.tables), (*second.traces, *second.tables), strict=True):
        assert a.read_bytes() == b.read_bytes()


@pytest.mark.slow
def test_the_pdf_has_pages_and_text(small, tmp_path):
    pytest.importorskip("weasyprint", exc_type=(ImportError, OSError), reason="Pango is missing")
    written = write_report(run_study(load_study(small)), tmp_path, pdf=True)
    assert written.pdf.read_bytes().startswith(b"%PDF-")
    assert 50_000 < written.pdf.stat().st_size < 3_000_000


def test_the_pdf_loads_nothing():
    pytest.importorskip("weasyprint", exc_type=(ImportError, OSError), reason="Pango is missing")
    with pytest.raises(ReportError, match="refers to"):
        from brunovsky.comparison.report.pdf import _refuse

        _refuse("https://example.org/a.png")
    assert pdf_bytes("<!DOCTYPE html><title>t</title><p>text</p>").startswith(b"%PDF-")


@pytest.mark.parametrize(("error", "remedy"), [(ImportError("x"), "brunovsky[pdf]"), (OSError("x"), "libpango")])
def test_what_makes_the_pdf_is_asked_for_before_any_run(small, tmp_path, monkeypatch, error, remedy):
    load = builtins.__import__

    def missing(name, *args, **kwargs):
        if name == "weasyprint":
            raise error
        return load(name, *args, **kwargs)

    monkeypatch.delitem(sys.modules, "weasyprint", raising=False)
    monkeypatch.setattr(builtins, "__import__", missing)
    with pytest.raises(ReportError) as raised:
        compare_study(small, tmp_path / "out", pdf=True)
    assert remedy in str(raised.value)
    assert not (tmp_path / "out").exists()


def test_the_schema_that_ships_is_that_of_the_code():
    shipped = resource("comparisons", "study.schema.json").read_text(encoding="utf-8")
    assert shipped == schema_text(), "run make schema"


@pytest.mark.parametrize("path", sorted(resource("comparisons").glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_studies_keep_the_schema(path):
    jsonschema.Draft202012Validator(study_schema()).validate(tomllib.loads(path.read_text(encoding="utf-8")))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("eta_min_m_per_s = 0.05", "eta_min = 0.05"),
        ("eta_min_m_per_s = 0.05", "eta_min_m_per_s = -1.0"),
        ("x_start_m = 1.0", "P_m_per_s3 = 1.0"),
        ("duration_s = 3.0", "duration_s = 0"),
        ('kind = "linear"', 'kind = "linaer"'),
    ],
)
def test_the_schema_refuses_what_the_study_file_refuses(small, old, new):
    text = small.read_text()
    validator = jsonschema.Draft202012Validator(study_schema())
    assert validator.is_valid(tomllib.loads(text))
    assert old in text and not validator.is_valid(tomllib.loads(text.replace(old, new, 1)))
