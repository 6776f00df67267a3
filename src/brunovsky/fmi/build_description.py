"""buildDescription.xml of FMI 3.0, which FMI 2.0.4 took over as it is: how the sources make a library."""

from __future__ import annotations

from collections.abc import Sequence

from lxml import etree

from brunovsky.blocks import Block
from brunovsky.fmi.definitions import xml_text

_WINDOWS = ("x86_64-windows", "aarch64-windows")
"""Platforms whose C library has the mathematical functions in it."""


def build_description(block: Block, source_files: Sequence[str]) -> bytes:
    """Text of the buildDescription.xml.

    It defines nothing: without a prefix the sources make a shared library, and the importer names the prefix of a
    static one (``FMI3_FUNCTION_PREFIX``), which goes to all other names of the runtime as well.

    Parameters
    ----------
    block : Block
        Its name is the model identifier.
    source_files : sequence of str
        C files in ``sources`` that make up the binary.

    Returns
    -------
    bytes
        UTF-8. The first configuration is for every platform but Windows, where the mathematical functions are no
        library of their own.
    """
    root = etree.Element("fmiBuildDescription", fmiVersion="3.0")
    for platform in (None, *_WINDOWS):
        configuration = etree.SubElement(root, "BuildConfiguration", modelIdentifier=block.name)
        if platform:
            configuration.set("platform", platform)
        files = etree.SubElement(configuration, "SourceFileSet", language="C99")
        for name in source_files:
            etree.SubElement(files, "SourceFile", name=name)
        if not platform:
            text = "mathematical functions of the C library"
            etree.SubElement(configuration, "Library", name="m", external="true", description=text)
    return xml_text(root)
