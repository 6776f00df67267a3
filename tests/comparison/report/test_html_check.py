"""Pages are valid HTML that loads nothing, with every figure named and no cell that holds what is not a number."""

import re
from xml.etree.ElementTree import Element

import html5lib
import pytest

from brunovsky.comparison import ProtocolSection, Table, drawing, load_study, render_report, run_study

HTML = "{http://www.w3.org/1999/xhtml}"
SVG = "{http://www.w3.org/2000/svg}"
NOT_NUMBERS = re.compile(r"\b(nan|none|inf|null|undefined)\b", re.IGNORECASE)


def problems(text: str) -> list[str]:
    """What is wrong with a page, by a strict parser and by our own rules."""
    try:
        root = html5lib.HTMLParser(strict=True).parse(text)
    except html5lib.html5parser.ParseError as error:
        return [f"not valid HTML: {error}"]
    found = [problem for one in root.iter() for problem in _of_element(one)]
    ids = [one.get("id") for one in root.iter() if one.get("id")]
    found += (
        [f"id {one} twice" for one in sorted({one for one in ids if ids.count(one) > 1})]
        if len(set(ids)) < len(ids)
        else []
    )
    known = set(ids)
    found += [f"refers to {one}" for one in _references(root) if not (one.startswith("#") and one[1:] in known)]
    found += [f"cell '{cell}'" for cell in _cells(root) if NOT_NUMBERS.search(cell) or not cell]
    return found


def _of_element(one: Element) -> list[str]:
    found = []
    if any(name in one.attrib for name in ("src", "srcset", "data", "action", "formaction", "poster")):
        found.append(f"{one.tag} loads something")
    if one.tag == f"{HTML}link" or "@import" in (one.text or ""):
        found.append("loads a style sheet")
    if one.tag == f"{SVG}svg" and not (one.get("aria-label") and one.get("role") == "img"):
        found.append("svg says nothing")
    if one.tag == f"{HTML}img" and not one.get("alt"):
        found.append("img says nothing")
    if one.tag == f"{HTML}figure" and one.find(f"{SVG}svg") is None:
        found.append("figure is missing")
    return found


def _references(root: Element) -> list[str]:
    found = []
    for one in root.iter():
        for name, value in one.attrib.items():
            if str(name).endswith("href"):
                found.append(value)
            found += re.findall(r"url\(([^)]*)\)", value)
        if one.tag in (f"{HTML}style", f"{SVG}style"):
            found += re.findall(r"url\(([^)]*)\)", one.text or "")
    return found


def _cells(root: Element) -> list[str]:
    return ["".join(one.itertext()).strip() for one in root.iter() if one.tag in (f"{HTML}td",)]


def protocol() -> ProtocolSection:
    with drawing.settings():
        figure = drawing.new_figure(3.0, 2.0)
        figure.subplots().plot([0.0, 1.0], [0.0, 1.0])
        svg = drawing.svg(figure, "pareto")
    rows = (("linear", 1.25, None), ("relay", float("nan"), float("inf")))
    table = Table("pareto", ("law", "IAE, m s", "undefined"), rows, "A caption")
    return ProtocolSection("Pareto <front>", "What it does.", svg, table, ("Found & told.",), headline="A headline.")


def test_the_report_of_the_paper(written):
    assert problems(written.report.read_text(encoding="utf-8")) == []


def test_a_report_with_failed_runs_and_a_protocol(small, failing):
    small.write_text(small.read_text() + failing)
    comparison = run_study(load_study(small))
    text = render_report(comparison, [protocol()])
    assert problems(text) == []
    for part in ("3 of 5 runs failed", "Pareto &lt;front&gt;", "Found &amp; told.", "A headline.", "failed: singular"):
        assert part in text, part
    assert text.index("A headline.") < text.index("Pareto &lt;front&gt;</h2>")
    assert text.index('id="linear"') < text.index('id="protocol-1"') < text.index('id="definitions"')
    assert problems(render_report(comparison, [protocol()], medium="paper")) == []


PAGE = '<!DOCTYPE html><html lang="en"><head><title>t</title></head><body>{}</body></html>'


@pytest.mark.parametrize(
    ("body", "wrong"),
    [
        (
            '<figure><svg role="img" aria-label="a"></svg></figure><table><tbody><tr><td>1</td></tr></tbody></table>',
            None,
        ),
        ("<p><table></p>", "not valid HTML"),
        ("<figure></figure>", "figure is missing"),
        ("<svg></svg>", "svg says nothing"),
        ('<script src="https://example.org/a.js"></script>', "loads something"),
        ('<a href="https://example.org">a</a>', "refers to"),
        ('<p style="background: url(a.png)"></p>', "refers to"),
        ('<p id="a"></p><p id="a"></p>', "twice"),
        ("<table><tbody><tr><td>nan</td></tr></tbody></table>", "cell"),
        ("<table><tbody><tr><td>-inf</td></tr></tbody></table>", "cell"),
        ("<table><tbody><tr><td></td></tr></tbody></table>", "cell"),
    ],
)
def test_the_check_itself(body, wrong):
    found = problems(PAGE.format(body))
    assert (found == []) if wrong is None else any(wrong in one for one in found), found


def test_the_figures_of_a_scenario_stand_in_their_order(written, paper):
    text = written.report.read_text(encoding="utf-8")
    for scenario in paper.scenarios:
        names = ("Path", "Errors", "Physical inputs", "Sliding variables", "Phase portraits")
        places = [text.index(f"<figcaption>{name}: {scenario.title}. ") for name in names]
        assert places == sorted(places)
    order = [
        text.index(f'id="{name}"') for name in ("verdict", "claims", "limits", "section-1", "linear", "provenance")
    ]
    assert order == sorted(order)
