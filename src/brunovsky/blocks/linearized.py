"""Blocks made from a system and its linearisation: the plant, the inner loop, and the two together.

The singularity is guarded where it is: only a denominator that vanishes is regularised, ``1/d`` becoming
``d/d_min**2`` for ``abs(d) <= d_min``, which is continuous and zero at ``d = 0``. ``d_min = 0`` is the plain law.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.diagram import Diagram
from brunovsky.blocks.units import derivative_unit
from brunovsky.blocks.variables import Check, Input, Output, Parameter, Relation, State, Variable
from brunovsky.linearization import AffineSystem, Linearization

Labels = Mapping[sp.Symbol, Variable]


def start_name(name: str) -> str:
    """Name of the parameter that holds a state's start value: ``eta[1]`` has ``eta_start[1]``."""
    stem, indices = re.fullmatch(r"([^\[]+)(.*)", name).groups()  # type: ignore[union-attr]
    return f"{stem}_start{indices}"


def plant_block(
    system: AffineSystem,
    name: str,
    *,
    description: str = "",
    labels: Labels | None = None,
    parameters: Sequence[Parameter] = (),
    starts: Mapping[sp.Symbol, float] | None = None,
) -> Block:
    """Bare plant ``x' = f + G u + sum d_k g_k`` as a block whose outputs are its states.

    Parameters
    ----------
    system : AffineSystem
        n states, m inputs, its disturbances are inputs too.
    name, description : str
        Of the block.
    labels : mapping of Symbol to Variable, optional
        Name, unit and description of states, inputs and disturbances; a symbol without one keeps its own name.
    parameters : sequence of Parameter
        One for each of ``system.parameters``, with value and range.
    starts : mapping of Symbol to float, optional
        Default start values, 0 where not given; each state has a fixed parameter ``NAME_start``.

    Raises
    ------
    ModelError
        If a parameter of the system has no declaration.
    """
    states = [_label(one, labels) for one in system.states]
    new = {one: _label(one, labels).symbol for one in (*system.states, *system.inputs, *system.disturbances)}
    start_parameters = [_start_parameter(label, (starts or {}).get(one, 0.0)) for one, label in _zip(system.states, states)]
    return Block(
        name,
        description,
        inputs=tuple(_input(_label(one, labels)) for one in (*system.inputs, *system.disturbances)),
        parameters=(*start_parameters, *parameters),
        states=tuple(
            State(label.name, label.unit, label.description, derivative.xreplace(new), start.symbol)
            for label, derivative, start in zip(states, system.dynamics, start_parameters, strict=True)
        ),
        outputs=tuple(Output(one.name, one.unit, one.description, one.symbol) for one in states),
    )


def inner_loop(
    linearization: Linearization,
    name: str = "inner_loop",
    *,
    description: str = "linearising feedback with its compensator",
    labels: Labels | None = None,
    output_units: Sequence[str] | None = None,
    parameters: Sequence[Parameter] = (),
    starts: Mapping[sp.Symbol, float] | None = None,
    guards: Mapping[sp.Expr, Parameter] | None = None,
) -> Block:
    """Linearising feedback of a system: v and the plant's states in, the plant's inputs and the chains out.

    Parameters
    ----------
    linearization : Linearization
        Its law, chains and compensator states.
    labels, parameters, starts
        As for :func:`plant_block`.
    output_units : sequence of str, optional
        Unit of each output that heads a chain; taken from its label where the output is a state.
    guards : mapping of Expr to Parameter, optional
        The parameter ``d_min`` for each denominator ``d`` of the law; missing ones are named ``singular_min[k]``.

    Returns
    -------
    Block
        Inputs ``v[i]`` and the plant's states; outputs the plant's inputs, ``Zi[k]`` and the Boolean ``singular``.
    """
    system, extended = linearization.system, linearization.extended_system
    compensator = [one for one in extended.states if one not in system.states]
    units = output_units or [_label(one, labels).unit for one in system.outputs]
    outer = [
        Variable(f"v[{i}]", derivative_unit(unit, order), f"derivative {order} of z{i} that the outer loop asks for")
        for i, (unit, order) in enumerate(zip(units, linearization.relative_degree, strict=True), 1)
    ]
    new = {one: _label(one, labels).symbol for one in (*extended.states, *system.inputs)}
    new |= {old: one.symbol for old, one in _zip(linearization.outer_inputs, outer)}
    guard = _Guard({key.xreplace(new): value for key, value in (guards or {}).items()})
    law = {old: guard.applied(expression.xreplace(new)) for old, expression in linearization.law.items()}
    start_parameters = {one: _start_parameter(_label(one, labels), (starts or {}).get(one, 0.0)) for one in compensator}
    dynamics = dict(_zip(extended.states, extended.dynamics))
    chains = [
        Output(f"Z{i}[{k}]", derivative_unit(unit, k - 1), f"z{i}" if k == 1 else f"derivative {k - 1} of z{i}", expression.xreplace(new))
        for i, (unit, chain) in enumerate(zip(units, linearization.chains, strict=True), 1)
        for k, expression in enumerate(chain, 1)
    ]  # fmt: skip
    commands = []
    for one in system.inputs:
        label = _label(one, labels)
        commands.append(Output(label.name, label.unit, label.description, label.symbol if one in compensator else law[one]))
    return Block(
        name,
        description,
        inputs=tuple(_input(one) for one in (*outer, *(_label(one, labels) for one in system.states))),
        parameters=(*start_parameters.values(), *parameters, *guard.parameters),
        states=tuple(
            State(*_parts(_label(one, labels)), derivative=dynamics[one].xreplace(law).xreplace(new), start=start_parameters[one].symbol)
            for one in compensator
        ),
        outputs=(*commands, *chains, Output("singular", "1", guard.description, guard.singular)),
        relations=guard.relations,
        checks=guard.checks,
    )  # fmt: skip


def linearized_block(
    linearization: Linearization,
    name: str = "linearized_plant",
    *,
    plant: AffineSystem | None = None,
    description: str = "plant with its linearising inner loop",
    labels: Labels | None = None,
    output_units: Sequence[str] | None = None,
    parameters: Sequence[Parameter] = (),
    starts: Mapping[sp.Symbol, float] | None = None,
    guards: Mapping[sp.Expr, Parameter] | None = None,
) -> Diagram:
    """Plant and inner loop: between ``v`` and the outputs it is a set of integrator chains.

    Parameters
    ----------
    plant : AffineSystem, optional
        The true plant where it differs from the one that was linearised (uncertain parameters, disturbances).
        The law keeps to its nominal model; uncertainty lives in the plant alone.
    labels, output_units, parameters, starts, guards
        As for :func:`plant_block` and :func:`inner_loop`.

    Returns
    -------
    Diagram
        Inputs ``v[i]`` and the disturbances; outputs the plant's states, its inputs, ``Zi[k]`` and ``singular``.

    Source: A. Isidori, Nonlinear Control Systems, 3rd ed., 1995, section 5.4, doi:10.1007/978-1-84628-615-5.
    """
    plant = plant or linearization.system
    own = {one.symbol: one for one in parameters}
    plant_parameters = [own[one] for one in plant.parameters if one in own]
    law_parameters = [own[one] for one in linearization.system.parameters if one in own]
    body = plant_block(plant, "plant", labels=labels, parameters=plant_parameters, starts=starts)
    loop = inner_loop(
        linearization,
        labels=labels,
        output_units=output_units,
        parameters=law_parameters,
        starts=starts,
        guards=guards,
    )
    states = [_label(one, labels).name for one in plant.states]
    inputs = [_label(one, labels).name for one in plant.inputs]
    disturbances = [_label(one, labels).name for one in plant.disturbances]
    shared = {one.name: [f"{key}.{one.name}" for key, block in _pairs(body, loop) if one in block.parameters] for one in parameters}
    starts_of = {one.name: f"{key}.{one.name}" for key, block in _pairs(body, loop) for one in block.parameters if one.name not in shared}
    ordered = [one for one in starts_of if "_start" in one] + [*shared] + [one for one in starts_of if "_start" not in one]
    return Diagram(
        name,
        description,
        components={"plant": body, "inner_loop": loop},
        connections={f"plant.{one}": f"inner_loop.{one}" for one in inputs} | {f"inner_loop.{one}": f"plant.{one}" for one in states},
        inputs={one.name: f"inner_loop.{one.name}" for one in loop.inputs if one.name not in states}
        | {one: f"plant.{one}" for one in disturbances},
        outputs={one: f"plant.{one}" for one in states} | {one.name: f"inner_loop.{one.name}" for one in loop.outputs},
        parameters={one: shared.get(one) or starts_of[one] for one in ordered},
    )  # fmt: skip


class _Guard:
    """Collects the vanishing denominators of a law and what they need: relations, parameters, checks."""

    def __init__(self, given: Mapping[sp.Expr, Parameter]) -> None:
        self._given = dict(given)
        self._found: dict[sp.Expr, Parameter] = {}

    def applied(self, expression: sp.Expr) -> sp.Expr:
        numerator, denominator = sp.fraction(sp.together(expression))
        if not denominator.free_symbols:
            return expression
        if -denominator in self._given:
            numerator, denominator = -numerator, -denominator
        if denominator not in self._found:
            default = Parameter(
                f"singular_min[{len(self._found) + 1}]", "1", f"guards {denominator} against zero", 0.0, 0.0, tunable=True
            )
            self._found[denominator] = self._given.get(denominator, default)
        low = self._found[denominator].symbol
        high_side, low_side = (one.symbol for one in self._pair(denominator))
        reciprocal = sp.Piecewise((1 / denominator, sp.Or(high_side, low_side)), (denominator / low**2, True))
        return numerator * reciprocal

    def _pair(self, denominator: sp.Expr) -> tuple[Relation, Relation]:
        limit = self._found[denominator]
        stem = re.sub(r"\W", "_", limit.name)
        return (
            Relation(f"above_{stem}", denominator - limit.symbol),
            Relation(f"below_minus_{stem}", -denominator - limit.symbol, indicator=denominator + limit.symbol),
        )

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        return tuple(self._found.values())

    @property
    def relations(self) -> tuple[Relation, ...]:
        return tuple(one for denominator in self._found for one in self._pair(denominator))

    @property
    def singular(self) -> sp.Basic:
        return sp.Or(*(sp.Not(sp.Or(*(one.symbol for one in self._pair(denominator)))) for denominator in self._found))

    @property
    def description(self) -> str:
        limits = " or ".join(f"abs({one}) <= {limit.name}" for one, limit in self._found.items())
        return f"{limits or 'never'}: the linearising law is singular there and guarded"

    @property
    def checks(self) -> tuple[Check, ...]:
        return tuple(
            Check(
                "singular",
                sp.Abs(one) > limit.symbol,
                f"the linearising law is singular at {one} = 0; start away from it or set {limit.name} > 0",
                when="failure",
            )
            for one, limit in self._found.items()
        )


def _zip(first: Sequence[sp.Symbol], second: Sequence[object]) -> zip:  # type: ignore[type-arg]
    return zip(first, second, strict=True)


def _pairs(body: Block, loop: Block) -> tuple[tuple[str, Block], ...]:
    return (("plant", body), ("inner_loop", loop))


def _label(one: sp.Symbol, labels: Labels | None) -> Variable:
    return (labels or {}).get(one) or Variable(str(one))


def _parts(one: Variable) -> tuple[str, str, str]:
    return one.name, one.unit, one.description


def _input(one: Variable) -> Input:
    return Input(*_parts(one))


def _start_parameter(one: Variable, value: float) -> Parameter:
    return Parameter(start_name(one.name), one.unit, f"start value of {one.name}", value)
