"""The closed loop: reference, outer loop and linearised robot, wired as a diagram."""

from __future__ import annotations

from brunovsky.blocks.block import Block
from brunovsky.blocks.diagram import Diagram
from brunovsky.blocks.library.circle import circle
from brunovsky.blocks.library.outer_loop import errors
from brunovsky.blocks.library.robot import linearized_robot
from brunovsky.blocks.library.sliding_mode import sliding_mode

FIGURE_6_OUTSIDE = {"x_start": 2.5, "eta_start[1]": 0.5}


def closed_loop(
    controller: Block | None = None,
    *,
    plant: Block | None = None,
    reference: Block | None = None,
    name: str = "closed_loop",
) -> Diagram:
    """Reference -> outer loop -> linearised robot, with errors recorded.

    Parameters
    ----------
    controller : Block, optional
        An outer loop of two chains; the default is :func:`sliding_mode`.
    plant, reference : Block, optional
        The defaults are :func:`linearized_robot` and :func:`circle`.
    name : str
        Of the diagram.

    Returns
    -------
    Diagram
        Inputs the disturbances of the plant; outputs those of plant, errors and controller; all their parameters
        under their own names. Defaults: figure 6 of the paper from outside the circle. With the default controller
        ``P = 0`` makes it pole placement, ``radius = 0`` regulation to the centre.
    """
    parts = {
        "reference": reference or circle(),
        "controller": controller or sliding_mode(),
        "plant": plant or linearized_robot(),
        "errors": errors(),
    }
    chains, references = ("Z1", "Z2"), ("Z1d", "Z2d")
    connections = {f"{target}.{one}": f"plant.{one}" for target in ("controller", "errors") for one in chains}
    connections |= {f"{target}.{one}": f"reference.{one}" for target in ("controller", "errors") for one in references}
    connections |= {"controller.zd3": "reference.zd3", "plant.v": "controller.v"}
    driven = [one.name for one in parts["controller"].outputs if one.name.startswith("v[")]
    shown = {
        "plant": [one.name for one in parts["plant"].outputs],
        "errors": [one.name for one in parts["errors"].outputs],
        "controller": sorted((one.name for one in parts["controller"].outputs), key=driven.__contains__),
    }
    own = {key: [one.name for one in parts[key].parameters] for key in ("plant", "reference", "controller")}
    return Diagram(
        name,
        "reference, outer loop and linearised robot",
        components=parts,
        connections=connections,
        inputs={one.name: f"plant.{one.name}" for one in parts["plant"].inputs if one.name not in driven},
        outputs={one: f"{key}.{one}" for key, names in shown.items() for one in names},
        parameters={one: f"{key}.{one}" for key, names in own.items() for one in names},
        values=FIGURE_6_OUTSIDE,
    )
