"""FMUs and in-process components of any block, in FMI 2.0 and 3.0, the FMUs that ship, and checks of any FMU."""

from brunovsky.fmi.archive import export_fmu
from brunovsky.fmi.checks import Check, CheckReport, check_fmu
from brunovsky.fmi.component import component
from brunovsky.fmi.instances import ComponentError
from brunovsky.fmi.manifest import shipped_block, shipped_fmus
from brunovsky.fmi.structure import ModelStructure, Unknown, model_structure
from brunovsky.fmi.variables import ScalarVariable, scalar_variables

__all__ = [
    "Check",
    "CheckReport",
    "ComponentError",
    "ModelStructure",
    "ScalarVariable",
    "Unknown",
    "check_fmu",
    "component",
    "export_fmu",
    "model_structure",
    "scalar_variables",
    "shipped_block",
    "shipped_fmus",
]
