"""Sphinx extension: formulas become MathML at build time, which browsers show without any script or network."""

from __future__ import annotations

import re
from html import escape
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util import logging

_logger = logging.getLogger(__name__)
_UNKNOWN = re.compile(r"<m[ion]>(&|&amp;|\\[^<]*)</m[ion]>")  # what the converter lets through as text
_OPENING = r"(<mo>&#x0003D;</mo>|<mo[^>]*>[(\[]</mo>|&#x00028;</mo>)"
_BEFORE_NAME = r"(</(?:mi|mn|mrow|msub|msup|msubsup)>|&#x00029;</mo>)"
_SPACING = (  # as TeX has it: a unary minus closes up, bars and slashes too, a function name keeps a distance
    (_OPENING + "<mo>&#x02212;</mo>", r'\1<mo form="prefix">&#x02212;</mo>'),
    ('<mo(?: stretchy="false")?>(&#x0007C;|&#x0002F;)</mo>', r'<mo lspace="0" rspace="0" stretchy="false">\1</mo>'),
    (_BEFORE_NAME + "(<mi>(?:sin|cos|tan|ln|exp)</mi>)", r'\1<mspace width="0.167em"/>\2'),
)
_LOW = re.compile(  # parentheses around what is no higher than a line
    r"\\left(\(|\[)"
    r"((?:[^()\[\]\\]|\\(?!frac|begin|left|right|sum)[a-zA-Z]+|\\[^a-zA-Z]|\([^()]*\))*?)"
    r" *\\right(\)|\])"
)


def to_mathml(latex: str, display: str, where: nodes.Node) -> str:
    """MathML of a formula; warns about LaTeX that the converter does not know."""
    previous = None
    while previous != latex:  # low parentheses need not stretch
        previous, latex = latex, _LOW.sub(r"\1\2\3", latex)
    try:
        result = str(convert(latex, display=display))
    except Exception as error:
        _logger.warning("this formula cannot be shown (%s): %s", error, latex, location=where)
        return f"<code>{escape(latex)}</code>"
    for pattern, replacement in _SPACING:
        result = re.sub(pattern, replacement, result)
    if unknown := _UNKNOWN.search(result):
        _logger.warning("this formula has %s, which has no MathML: %s", unknown[1], latex, location=where)
    return result


def visit_inline(self: Any, node: nodes.Element) -> None:
    """Write a formula within a sentence."""
    self.body.append(to_mathml(node.astext(), "inline", node))
    raise nodes.SkipNode


def visit_display(self: Any, node: nodes.Element) -> None:
    """Write a displayed formula."""
    self.body.append(self.starttag(node, "div", CLASS="math-display"))
    self.body.append(to_mathml(node.astext(), "block", node))
    self.body.append("</div>\n")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, bool]:
    """Register the renderer under the name ``mathml``."""
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_display, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
