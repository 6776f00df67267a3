"""The package that ships: reference, outer loop and linearised robot as three FMUs."""

from __future__ import annotations

import tomllib

from brunovsky._resources import resource
from brunovsky.blocks import Diagram, library
from brunovsky.fmi.ssp.variant import Variant


def robot_system() -> Diagram:
    """Circle, sliding mode and linearised robot under the names of their FMUs, connected as in ``closed_loop``.

    Inputs ``d[1..2]`` and outputs of the robot, ``v[1..2]`` and ``S[1..2]``; the parameters of all three under
    their own names, with the defaults of the blocks.
    """
    parts = {name: getattr(library, name)() for name in ("circle", "sliding_mode", "linearized_robot")}
    reference = ("Z1d", "Z2d", "zd3")
    wires = {f"sliding_mode.{name}": f"circle.{name}" for name in reference}
    wires |= {f"sliding_mode.{name}": f"linearized_robot.{name}" for name in ("Z1", "Z2")}
    shown = [(key, one.name) for key in ("linearized_robot", "sliding_mode") for one in parts[key].outputs]
    return Diagram(
        "robot",
        "circular reference, sliding-mode outer loop and linearised robot",
        components=parts,
        connections=wires | {"linearized_robot.v": "sliding_mode.v"},
        inputs={name: f"linearized_robot.{name}" for name in ("d[1]", "d[2]")},
        outputs={name: f"{key}.{name}" for key, name in shown},
        parameters={one.name: f"{key}.{one.name}" for key, block in parts.items() for one in block.parameters},
    )


def robot_variants() -> tuple[Variant, ...]:
    """Variants of ``ssp/robot.ssp``, as ``fmu/ssp.toml`` lists them: figure 6 of the paper from outside, figure 5."""
    listed = tomllib.loads(resource("fmu", "ssp.toml").read_text(encoding="utf-8"))["variant"]
    return tuple(Variant(**one) for one in listed)
