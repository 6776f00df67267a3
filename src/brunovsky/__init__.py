"""Feedback linearisation, sliding-mode and linear outer loops, FMUs and comparison reports.

The way the data flows: an :class:`AffineSystem` is linearised (:func:`linearize`), becomes a :class:`Block`
(:func:`linearized_block`), is wired with outer loops and references into a :class:`Diagram`, and runs as a native
simulation (:func:`simulate`), an FMU (:func:`export_fmu`) or an in-process component (:func:`component`).
"""

from importlib.metadata import PackageNotFoundError, version

from brunovsky import analysis, blocks
from brunovsky.analysis import to_control
from brunovsky.blocks import Block, Diagram, linearized_block
from brunovsky.errors import BrunovskyError
from brunovsky.fmi import component, export_fmu
from brunovsky.linearization import AffineSystem, Linearization, linearize
from brunovsky.native import simulate

try:
    __version__ = version("brunovsky")
except PackageNotFoundError:  # a checkout on the path, not installed
    __version__ = "0+unknown"

__all__ = [
    "AffineSystem",
    "Block",
    "BrunovskyError",
    "Diagram",
    "Linearization",
    "analysis",
    "blocks",
    "component",
    "export_fmu",
    "linearize",
    "linearized_block",
    "simulate",
    "to_control",
]
