"""System structures and packages (SSP 1.0 and 2.0) of diagrams: one FMU for each component, and what connects them."""

from brunovsky.fmi.ssp.package import export_ssp
from brunovsky.fmi.ssp.shipped import robot_system, robot_variants
from brunovsky.fmi.ssp.variant import Variant

__all__ = ["Variant", "export_ssp", "robot_system", "robot_variants"]
