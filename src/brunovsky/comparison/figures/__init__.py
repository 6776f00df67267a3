"""Figures of a report in their fixed order: path, errors, inputs, sliding variables, phase portraits, linear part."""

from brunovsky.comparison.figures.describing import DescribingFunction, describing_function_figure, describing_functions
from brunovsky.comparison.figures.loop import bode_figures, poles_figure
from brunovsky.comparison.figures.paths import path_figure, path_of, paths_figure
from brunovsky.comparison.figures.phase import phase_figure
from brunovsky.comparison.figures.signals import errors_figure, inputs_figure, sliding_figure
from brunovsky.comparison.figures.traces import linear_parts, transient_window
from brunovsky.comparison.figures.worst import worst_paths_figure

__all__ = [
    "DescribingFunction",
    "bode_figures",
    "describing_function_figure",
    "describing_functions",
    "errors_figure",
    "inputs_figure",
    "linear_parts",
    "path_figure",
    "path_of",
    "paths_figure",
    "phase_figure",
    "poles_figure",
    "sliding_figure",
    "transient_window",
    "worst_paths_figure",
]
