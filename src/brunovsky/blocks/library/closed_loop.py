"""The closed loop: reference, outer loop and linearised plant, wired as a diagram."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.diagram import Diagram
from brunovsky.blocks.hardware import computed, measured
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.errors import errors
from brunovsky.blocks.library.outer_loops import sliding_mode
from brunovsky.blocks.library.outer_loops.surface_map import PERIOD
from brunovsky.blocks.library.references import circle, set_point
from brunovsky.blocks.library.robot import linearized_robot
from brunovsky.blocks.library.sampling import computer
from brunovsky.blocks.variables import Output, symbol

_POSITIONS = ("x", "y")
FIGURE_6_OUTSIDE = {"x_start": 2.5, "eta_start[1]": 0.5}


def closed_loop(
    controller: Block | None = None,
    *,
    plant: Block | None = None,
    reference: Block | None = None,
    name: str = "closed_loop",
) -> Diagram:
    """Reference -> outer loop -> linearised plant, with errors recorded.

    Names say what is wired to what: an input of the controller is fed by the reference or the plant, whichever has an
    output of that name, an input of the plant by the controller. What nothing feeds is an input of the diagram.
    From a plant behind sensors (:func:`robot_with_hardware`) the controller gets what is measured, ``x_measured``
    for ``x``; so are the chains, and ``e1``, ``e2``. The true errors of the robot are ``position_error[1..2]`` then.
    Where such a plant samples, ``e1``, ``e2`` and what the controller gives are those of the last sample.

    Parameters
    ----------
    controller : Block, optional
        An outer loop for the plant's chains; the default, for chains like the robot's, is :func:`sliding_mode`.
    plant : Block, optional
        A plant with its inner loop, :func:`linearized_robot` by default; ``linearized_block`` makes others.
    reference : Block, optional
        The default is :func:`circle` for chains like the robot's, else :func:`set_point`.
    name : str
        Of the diagram.

    Returns
    -------
    Diagram
        Inputs the disturbances of the plant; outputs those of plant, errors and controller; all their parameters
        under their own names, or ``controller.NAME`` where the plant has the same. Defaults: figure 6 of the paper
        from outside the circle. With the default controller ``P = 0`` makes it pole placement, ``radius = 0``
        regulation to the centre.

    Raises
    ------
    ModelError
        If the plant has no chains, or units differ.
    """
    body = plant or linearized_robot()
    chains = Chains.of(body)
    is_measured = {f"{one}_measured" for one in _POSITIONS} <= {one.name for one in body.outputs}
    parts = {
        "reference": reference or (circle() if chains == ROBOT_CHAINS else set_point(chains)),
        "controller": controller or sliding_mode(chains),
        "plant": body,
        "errors": errors(chains, _POSITIONS if chains == ROBOT_CHAINS and is_measured else ()),
    }
    period = next((one.value for one in body.parameters if one.name == PERIOD.name), None)
    if is_measured and period is not None:
        parts["computer"] = computer(_results(parts["errors"], parts["controller"]), period)
    provided = {key: {one.name for one in parts[key].outputs} for key in parts}
    sources: dict[str, tuple[str, ...]] = {
        "controller": ("reference", "plant"),
        "plant": ("controller",),
        "errors": ("reference", "plant"),
        "computer": ("errors", "controller"),
    }
    connections: dict[str, str] = {}
    inputs: dict[str, list[str]] = {}
    for target, candidates in sources.items():
        for one in parts[target].inputs if target in parts else ():
            names = (measured(one).name, one.name) if target == "controller" else (one.name,)
            pairs = ((key, name) for key in candidates for name in names if name in provided[key])
            if source := next(pairs, None):
                connections[f"{target}.{one.name}"] = ".".join(source)
            else:
                inputs.setdefault(one.name, []).append(f"{target}.{one.name}")
    outputs = {key: [one.name for one in parts[key].outputs] for key in ("plant", "errors", "controller")}
    outputs["controller"].sort(key={one.name for one in body.inputs}.__contains__)  # v after S
    taken = {symbol(one) for one in (*inputs, *(state.name for state in body.states))}
    shown = _exported(outputs, taken - {symbol(one) for one in outputs["plant"]})
    if "computer" in parts:
        found = {
            connections[f"computer.{one.name}"]: f"computer.{computed(one).name}" for one in parts["computer"].inputs
        }
        shown = {name: found.get(behind, behind) for name, behind in shown.items()}
    own = {key: [one.name for one in parts[key].parameters] for key in ("plant", "reference", "controller")}
    return Diagram(
        name,
        "reference, outer loop and linearised plant",
        components=parts,
        connections=connections,
        inputs=inputs,
        outputs=shown,
        parameters=_with_one_period(
            _exported(own, taken | {symbol(one) for one in shown}), sampled="computer" in parts
        ),
        values=FIGURE_6_OUTSIDE if plant is None else {},
    )


def _results(*parts: Block) -> list[Output]:
    """What a computer finds: real outputs, but for the true errors, which it doesn't know."""
    found = [one for part in parts for one in part.outputs]
    return [one for one in found if not one.is_boolean and not one.name.startswith("position_error")]


def _exported(names: Mapping[str, Sequence[str]], taken: Collection[sp.Symbol]) -> dict[str, str]:
    """Names under which components' variables are exported: their own, unless taken, else the flattened one."""
    exported: dict[str, str] = {}
    used = set(taken)
    for component, own in names.items():
        for one in own:
            name = one if symbol(one) not in used else f"{component}.{one}"
            used.add(symbol(name))
            exported[name] = f"{component}.{one}"
    return exported


def _with_one_period(parameters: Mapping[str, str], *, sampled: bool) -> dict[str, str | Sequence[str]]:
    """Periods that are one: of a reference known one sample ahead and its outer loop, of a plant and its computer."""
    found: dict[str, str | Sequence[str]] = dict(parameters)
    names = {behind: name for name, behind in parameters.items()}
    ahead, own, plant = (f"{component}.{PERIOD.name}" for component in ("reference", "controller", "plant"))
    if {ahead, own} <= set(names):
        del found[names[own]]
        found[names[ahead]] = (ahead, own)
    if sampled:
        found[names[plant]] = (plant, f"computer.{PERIOD.name}")
    return found
