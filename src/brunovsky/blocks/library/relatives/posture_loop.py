"""The closed loop of laws that act on the accelerations of the bare robot, wired as a diagram."""

from __future__ import annotations

from brunovsky.blocks.block import Block
from brunovsky.blocks.diagram import Diagram
from brunovsky.blocks.library.circle import circle
from brunovsky.blocks.library.closed_loop import FIGURE_6_OUTSIDE
from brunovsky.blocks.library.outer_loop import CHAINS, ORDER, errors
from brunovsky.blocks.library.relatives.backstepping import backstepping
from brunovsky.blocks.library.robot import robot, robot_linearization
from brunovsky.blocks.units import derivative_unit
from brunovsky.blocks.variables import Input, Output


def posture_loop(
    controller: Block | None = None,
    *,
    plant: Block | None = None,
    reference: Block | None = None,
    name: str = "posture_loop",
) -> Diagram:
    """Reference -> law on the accelerations -> bare robot, with the same things recorded as in ``closed_loop``.

    Parameters
    ----------
    controller : Block, optional
        From ``x``, ``y``, ``theta``, ``eta[1..2]`` and the reference to ``u[1..2]``; the default is
        :func:`backstepping`.
    plant, reference : Block, optional
        The defaults are :func:`robot` and :func:`circle`.
    name : str
        Of the diagram.

    Returns
    -------
    Diagram
        Inputs the disturbances ``d[1..2]``; outputs ``x``, ``y``, ``theta``, ``eta[1..2]``, ``u[1..2]``, the chains
        ``Z1[1..3]``, ``Z2[1..3]`` of the nominal model, the errors ``e1[1..3]``, ``e2[1..3]``, and what else the law
        shows; parameters of all under their own names. Defaults: figure 6 of the paper from outside the circle.

    Raises
    ------
    ModelError
        If two of the parts share the name of a parameter, or the law lacks a variable.
    """
    parts = {
        "reference": reference or circle(),
        "controller": controller or backstepping(),
        "plant": plant or robot(),
        "chains": _chains(),
        "errors": errors(),
    }
    driven = [one.name for one in parts["plant"].inputs if one.name.startswith("u[")]
    connections = {f"plant.{one}": f"controller.{one}" for one in driven} | {"controller.zd3": "reference.zd3"}
    connections |= {f"{target}.{one}": f"reference.{one}" for target in ("controller", "errors") for one in _REFERENCES}
    connections |= {f"errors.{one}": f"chains.{one}" for one in ("Z1", "Z2")}
    for target in ("controller", "chains"):
        taken = {one.name for one in parts[target].inputs}
        connections |= {
            f"{target}.{one.name}": f"plant.{one.name}" for one in parts["plant"].outputs if one.name in taken
        }
    connections["chains.u[1]"] = "controller.u[1]"
    shown = {key: [one.name for one in parts[key].outputs] for key in ("plant", "chains", "errors")}
    extra = [one.name for one in parts["controller"].outputs if one.name not in driven]
    own = {key: [one.name for one in parts[key].parameters] for key in ("plant", "reference", "controller")}
    return Diagram(
        name,
        "reference, law on the accelerations and bare robot",
        components=parts,
        connections=connections,
        inputs={one.name: f"plant.{one.name}" for one in parts["plant"].inputs if one.name not in driven},
        outputs={one: f"plant.{one}" for one in shown["plant"]}
        | {one: f"controller.{one}" for one in driven}
        | {one: f"{key}.{one}" for key in ("chains", "errors") for one in shown[key]}
        | {one: f"controller.{one}" for one in extra},
        parameters={one: f"{key}.{one}" for key, names in own.items() for one in names},
        values=FIGURE_6_OUTSIDE,
    )


_REFERENCES = ("Z1d", "Z2d")


def _chains() -> Block:
    """Chains of the nominal robot, from its states and the forward acceleration."""
    linearization = robot_linearization()
    known = {one.symbol: one for one in (*robot().states, *robot().inputs)}
    used = [one for one in linearization.extended_system.states if one in known]
    return Block(
        "chains",
        "chains of the nominal robot",
        inputs=tuple(Input(known[one].name, known[one].unit, known[one].description) for one in used),
        outputs=tuple(
            Output(
                f"Z{i}[{k}]", derivative_unit("m", k - 1), f"chain {i}, element {k}", linearization.chains[i - 1][k - 1]
            )
            for i in CHAINS
            for k in range(1, ORDER + 1)
        ),
    )
