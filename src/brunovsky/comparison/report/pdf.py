"""The report as PDF, by WeasyPrint (extra ``pdf``)."""

from __future__ import annotations

from typing import Any

from brunovsky.errors import ReportError


def require_pdf() -> Any:
    """WeasyPrint; an error that says what to install where it or its library is missing."""
    try:
        import weasyprint
    except ImportError as error:
        raise ReportError(
            f"the PDF needs WeasyPrint, which is not installed ({error}); install it with pip install "
            "'brunovsky[pdf]', "
            "or leave out the PDF: report.html prints as well from a browser"
        ) from None
    except OSError as error:
        raise ReportError(
            f"the PDF needs the library Pango, which WeasyPrint does not find ({error}); install it (on Debian: "
            "apt-get "
            "install libpango-1.0-0 libpangoft2-1.0-0 libharfbuzz-subset0), or leave out the PDF: report.html "
            "prints as "
            "well from a browser"
        ) from None
    return weasyprint


def pdf_bytes(page: str) -> bytes:
    """Page laid out for paper as a PDF; nothing is fetched for it."""
    weasyprint = require_pdf()
    return bytes(weasyprint.HTML(string=page, url_fetcher=_refuse).write_pdf())


def _refuse(url: str, *_: Any, **__: Any) -> Any:
    raise ReportError(f"the report refers to {url}; it must hold everything itself")
