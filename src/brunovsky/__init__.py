"""Feedback linearisation, sliding-mode and linear outer loops, FMUs and comparison reports.

The way the data flows: an :class:`AffineSystem` is linearised (:func:`linearize`), becomes a :class:`Block`
(:func:`linearized_block`), is wired with outer loops and references into a :class:`Diagram`, and runs as a native
simulation (:func:`simulate`), an FMU (:func:`export_fmu`) or an in-process component (:func:`component`).
"""

from importlib import import_module
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

from brunovsky import _sources as _sources  # first, for it notes when the package is loaded

# isort: split
from brunovsky import blocks
from brunovsky.blocks import Block, Diagram, linearized_block
from brunovsky.errors import BrunovskyError
from brunovsky.fmi import check_fmu, component, export_fmu, export_ssp
from brunovsky.linearization import (
    AffineSystem,
    Linearization,
    disturbance_map,
    forecast,
    gallery,
    linearize,
    static_linearizability,
)
from brunovsky.native import simulate

if TYPE_CHECKING:
    from brunovsky import analysis
    from brunovsky.analysis import to_control

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
    "check_fmu",
    "component",
    "disturbance_map",
    "export_fmu",
    "export_ssp",
    "forecast",
    "gallery",
    "linearize",
    "linearized_block",
    "simulate",
    "static_linearizability",
    "to_control",
]


def __getattr__(name: str) -> Any:
    """Import :mod:`brunovsky.analysis` when it is first used: python-control takes longer than all the rest."""
    if name == "analysis":
        return import_module("brunovsky.analysis")
    if name == "to_control":
        return import_module("brunovsky.analysis").to_control
    raise AttributeError(f"module 'brunovsky' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
