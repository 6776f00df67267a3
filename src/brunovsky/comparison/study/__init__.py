"""Study files: laws, scenarios and how they are run, resolved to runs of blocks.

keys of the model <- tables (laws, scenarios, signals, hardware) <- Study -> PlannedRun
"""

from brunovsky.comparison.study.chatter_grid import ChatterGrid, ChatterTable
from brunovsky.comparison.study.hardware import HardwareTable
from brunovsky.comparison.study.law import Law
from brunovsky.comparison.study.loops import LawKind, Loop
from brunovsky.comparison.study.planned import PlannedRun
from brunovsky.comparison.study.scenario import Scenario
from brunovsky.comparison.study.signals import Noise, Signal
from brunovsky.comparison.study.study import EngineName, FigureName, Study, load_study

__all__ = [
    "ChatterGrid",
    "ChatterTable",
    "EngineName",
    "FigureName",
    "HardwareTable",
    "Law",
    "LawKind",
    "Loop",
    "Noise",
    "PlannedRun",
    "Scenario",
    "Signal",
    "Study",
    "load_study",
]
