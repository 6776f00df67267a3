"""FMUs, components and packages (SSP) of blocks and diagrams, in FMI 2.0 and 3.0, what ships, and checks of any FMU."""

from brunovsky.fmi.archive import export_fmu
from brunovsky.fmi.checks import Check, CheckReport, check_fmu
from brunovsky.fmi.component import component
from brunovsky.fmi.instances import ComponentError
from brunovsky.fmi.manifest import shipped_block, shipped_fmus
from brunovsky.fmi.ssp import Variant, export_ssp, robot_system, robot_variants
from brunovsky.fmi.structure import ModelStructure, Unknown, model_structure
from brunovsky.fmi.variables import ScalarVariable, scalar_variables

__all__ = [
    "Check",
    "CheckReport",
    "ComponentError",
    "ModelStructure",
    "ScalarVariable",
    "Unknown",
    "Variant",
    "check_fmu",
    "component",
    "export_fmu",
    "export_ssp",
    "model_structure",
    "robot_system",
    "robot_variants",
    "scalar_variables",
    "shipped_block",
    "shipped_fmus",
]
