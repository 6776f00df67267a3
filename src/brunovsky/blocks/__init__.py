"""Blocks: frozen descriptions of what runs, diagrams of them, and the library that ships."""

from brunovsky.blocks.block import Block
from brunovsky.blocks.diagram import Diagram
from brunovsky.blocks.engine import NumpyEngine
from brunovsky.blocks.library import (
    Chains,
    circle,
    closed_loop,
    errors,
    linearized_robot,
    pole_placement,
    robot,
    robot_linearization,
    robot_system,
    set_point,
    sliding_mode,
)
from brunovsky.blocks.linearized import inner_loop, linearized_block, plant_block
from brunovsky.blocks.variables import (
    TIME,
    Check,
    Input,
    Mode,
    Output,
    Parameter,
    Relation,
    Sample,
    State,
    Transition,
    Variable,
    symbol,
    symbols,
)

__all__ = [
    "TIME",
    "Block",
    "Chains",
    "Check",
    "Diagram",
    "Input",
    "Mode",
    "NumpyEngine",
    "Output",
    "Parameter",
    "Relation",
    "Sample",
    "State",
    "Transition",
    "Variable",
    "circle",
    "closed_loop",
    "errors",
    "inner_loop",
    "linearized_block",
    "linearized_robot",
    "plant_block",
    "pole_placement",
    "robot",
    "robot_linearization",
    "robot_system",
    "set_point",
    "sliding_mode",
    "symbol",
    "symbols",
]
