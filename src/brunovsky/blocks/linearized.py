"""Blocks made from a system and its linearisation: the plant, the inner loop, and the two together."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

import sympy as sp

from brunovsky._suggest import unknown_name
from brunovsky.blocks.block import Block
from brunovsky.blocks.diagram import Diagram
from brunovsky.blocks.guard import find_guards, guarded
from brunovsky.blocks.hardware import wired
from brunovsky.blocks.units import derivative_unit
from brunovsky.blocks.variables import NAME, TIME, Input, Output, Parameter, State, Variable, described, symbol
from brunovsky.errors import ModelError
from brunovsky.linearization import AffineSystem, Linearization, measured_chains

_TAKEN = re.compile(r"v_\d+|Z\d+_\d+|singular")  # symbols of v[i], Zi[k] and of the output that tells of the guard
Labels = Mapping[sp.Symbol, Variable]
Values = Mapping[sp.Symbol | str, float]
Declarations = Sequence[Parameter] | Values


def plant_block(
    system: AffineSystem,
    name: str,
    *,
    description: str = "",
    labels: Labels | None = None,
    parameters: Declarations = (),
    starts: Values | None = None,
) -> Block:
    """Bare plant ``x' = f + G u + sum d_k g_k`` as a block whose outputs are its states.

    Parameters
    ----------
    system : AffineSystem
        n states, m inputs; its disturbances are inputs of the block too.
    name, description : str
        Of the block.
    labels : mapping of Symbol to Variable, optional
        Name, unit, description and nominal value of states, inputs and disturbances; a symbol without one keeps its
        own name.
    parameters : sequence of Parameter, or mapping of Symbol or str to float
        One for each of ``system.parameters``, with value and range; or only the values.
    starts : mapping of Symbol or str to float, optional
        Default start values, 0 where not given; each state has a fixed parameter ``NAME_start``.

    Returns
    -------
    Block
        Inputs ``u`` and ``d``, outputs the n states.

    Raises
    ------
    ModelError
        If a parameter of the system has no declaration.
    """
    declared = _declared(system.parameters, parameters)
    known = _labelled((*system.states, *system.inputs, *system.disturbances), labels)
    new = {one: label.symbol for one, label in known.items()} | _parameter_symbols(system.parameters)
    start = _start_parameters(system.states, known, starts or {}, system.states)
    states = [
        State(**described(known[one]), derivative=slope.xreplace(new), start=start[one].symbol)
        for one, slope in zip(system.states, system.dynamics, strict=True)
    ]
    return Block(
        name,
        description,
        inputs=tuple(Input(**described(known[one])) for one in (*system.inputs, *system.disturbances)),
        parameters=(*start.values(), *declared),
        states=tuple(states),
        outputs=tuple(Output(**described(one), expression=one.symbol) for one in states),
    )


def inner_loop(
    linearization: Linearization,
    name: str = "inner_loop",
    *,
    description: str = "linearising feedback with its compensator",
    labels: Labels | None = None,
    output_units: Sequence[str] | None = None,
    parameters: Declarations = (),
    starts: Values | None = None,
    guards: Mapping[sp.Expr, Parameter | float] | None = None,
    measured: AffineSystem | None = None,
) -> Block:
    """Linearising feedback of a system: v and the plant's states in, the plant's inputs and the chains out.

    Parameters
    ----------
    linearization : Linearization
        Its law, chains and compensator states.
    name, description : str
        Of the block.
    labels, parameters, starts
        As for :func:`plant_block`.
    output_units : sequence of str, optional
        Unit of each output that heads a chain; taken from its label where the output is a state, else ``"1"``.
    guards : mapping of Expr to Parameter or float, optional
        The limit ``d_min`` for factors ``d`` of the singular locus, or its default value. A variable ``v`` has
        ``v_min``, another factor ``singular_min[k]``; the default is 0, the law as it is, which fails where ``d = 0``.
    measured : AffineSystem, optional
        The true plant, if the chains are measured on it rather than computed from the nominal model.

    Returns
    -------
    Block
        Inputs ``v[i]`` and the plant's states; outputs the plant's inputs, ``Zi[k]`` and the Boolean ``singular``.
        Where chains are measured, the block also has the disturbances that they contain, and the plant's parameters.
    """
    system, extended = linearization.system, linearization.extended_system
    chains = measured_chains(linearization, measured) if measured else linearization.chains
    seen = {one for chain in chains for expression in chain for one in expression.free_symbols}
    disturbances = [one for one in (measured.disturbances if measured else ()) if one in seen]
    constants = dict.fromkeys((*system.parameters, *(measured.parameters if measured else ())))
    known = _labelled((*extended.states, *system.inputs, *disturbances), labels)
    units = output_units or [known[one].unit if one in known else "1" for one in system.outputs]
    outer = [
        Variable(f"v[{i}]", derivative_unit(unit, order), f"input of chain {i}: derivative {order} of output {i}")
        for i, (unit, order) in enumerate(zip(units, linearization.relative_degree, strict=True), 1)
    ]
    new = {one: label.symbol for one, label in known.items()} | _parameter_symbols(constants)
    new |= {old: one.symbol for old, one in zip(linearization.outer_inputs, outer, strict=True)}
    compensator = [one for one in extended.states if one not in system.states]
    slopes = dict(zip(extended.states, extended.dynamics, strict=True))
    commands = {
        one: linearization.input_map[one].xreplace(dict(linearization.law)).xreplace(new) for one in system.inputs
    }
    slopes = {one: slopes[one].xreplace(dict(linearization.law)).xreplace(new) for one in compensator}
    locus = linearization.singular_locus.xreplace(new)
    found = find_guards(
        (*commands.values(), *slopes.values()),
        locus,
        {key.xreplace(new): limit for key, limit in (guards or {}).items()},
        {label.symbol: label for label in known.values()},
    )
    start = _start_parameters(compensator, known, starts or {}, extended.states)
    limits = [f"abs({one.shown}) <= {one.limit.name}" for one in found]
    singular = (
        f"{' or '.join(limits)}: the law is guarded against its singularity" if found else "never: no singularity"
    )
    return Block(
        name,
        description,
        inputs=tuple(
            Input(**described(one)) for one in (*outer, *(known[one] for one in (*system.states, *disturbances)))
        ),
        parameters=(*start.values(), *_declared(constants, parameters), *(one.limit for one in found)),
        states=tuple(
            State(**described(known[one]), derivative=guarded(slopes[one], found), start=start[one].symbol)
            for one in compensator
        ),
        outputs=(
            *(Output(**described(known[one]), expression=guarded(commands[one], found)) for one in system.inputs),
            *_chain_outputs(chains, units, new),
            Output("singular", "1", singular, sp.Not(sp.And(*(one.regular for one in found)))),
        ),
        relations=tuple(relation for one in found for relation in one.relations),
        checks=tuple(one.check for one in found),
    )


def linearized_block(
    linearization: Linearization,
    name: str = "linearized_plant",
    *,
    plant: AffineSystem | None = None,
    description: str = "plant with its linearising inner loop",
    labels: Labels | None = None,
    output_units: Sequence[str] | None = None,
    parameters: Declarations = (),
    starts: Values | None = None,
    guards: Mapping[sp.Expr, Parameter | float] | None = None,
    measured: bool = False,
    sensors: Block | None = None,
    inputs: Block | None = None,
    actuators: Block | None = None,
) -> Diagram:
    """Plant and inner loop: between ``v`` and the outputs it is a set of integrator chains.

    Parameters
    ----------
    linearization : Linearization
        Of the nominal plant.
    name, description : str
        Of the diagram.
    plant : AffineSystem, optional
        The true plant where it differs from the one that was linearised (uncertain parameters, disturbances).
        The law keeps to its nominal model; uncertainty lives in the plant alone.
    labels, output_units, parameters, starts, guards
        As for :func:`plant_block` and :func:`inner_loop`.
    measured : bool
        Whether ``Zi[k]`` are the derivatives of the true plant's outputs, as sensors show them, instead of those that
        the nominal model computes from its state. Everything is matched then, for disturbances that are differentiable:
        a step of one that enters a measured element makes it jump. The law itself keeps to the nominal model.
    sensors : Block, optional
        What stands between the plant and the law, such as :func:`sensors`: an input ``x`` and an output ``x_measured``
        for each state ``x`` of the plant. The law and ``Zi[k]`` know only what is measured.
    inputs : Block, optional
        What stands between the outer loop and the law, such as :func:`outer_inputs`: inputs ``v[i]``, outputs
        ``v_acting[i]``.
    actuators : Block, optional
        What stands between the law and the plant, such as :func:`actuator_lags`: inputs ``u_command`` and outputs ``u``
        for each input ``u`` of the plant. The law doesn't know it; ``Zi[k]`` keep to what it commands.

    Returns
    -------
    Diagram
        Inputs ``v[i]``, the disturbances and what else the parts take from outside; outputs the plant's states, its
        inputs, ``Zi[k]`` and ``singular``; with actuators ``u_command``, with sensors ``x_measured``, with `inputs`
        ``v_acting[i]``.

    Raises
    ------
    ModelError
        If a parameter has no declaration, the true plant has other states or inputs, sensors, inputs or actuators do
        not fit, or chains are to be measured on the true plant behind them.
    LinearizationError
        If what is to be measured contains the rate of a disturbance, or an input.

    References
    ----------
    A. Isidori, *Nonlinear Control Systems*, 3rd ed., 1995, section 5.4, doi:10.1007/978-1-84628-615-5.
    """
    if measured and (sensors is not None or actuators is not None):
        raise ModelError(
            f"{name}: chains measured on the true plant would contain what the law neither commands nor sees behind "
            "actuators or sensors; give either measured=True or actuators and sensors"
        )
    plant = plant or linearization.system
    own = {one: float(value) for one, value in (starts or {}).items() if str(one) in {*map(str, plant.states)}}
    declared = _declared((*plant.parameters, *linearization.system.parameters), parameters)

    def used(symbols: Iterable[sp.Symbol]) -> list[Parameter]:
        return [one for one in declared if one.symbol in {symbol(str(other)) for other in symbols}]

    body = plant_block(plant, "plant", labels=labels, parameters=used(plant.parameters), starts=own)
    loop = inner_loop(
        linearization,
        labels=labels,
        output_units=output_units,
        parameters=used((*linearization.system.parameters, *(plant.parameters if measured else ()))),
        starts=starts,
        guards=guards,
        measured=plant if measured else None,
    )
    return wired(name, description, body, loop, sensors=sensors, inputs=inputs, actuators=actuators)


def _chain_outputs(
    chains: Sequence[Sequence[sp.Expr]], units: Sequence[str], new: Mapping[sp.Symbol, sp.Symbol]
) -> Iterable[Output]:
    for i, (unit, chain) in enumerate(zip(units, chains, strict=True), 1):
        for k, expression in enumerate(chain):
            what = f"output {i}" if k == 0 else f"derivative {k} of output {i}"
            yield Output(
                f"Z{i}[{k + 1}]", derivative_unit(unit, k), f"chain {i}: {what}", expression.xreplace(dict(new))
            )


def _labelled(symbols: Iterable[sp.Symbol], labels: Labels | None) -> dict[sp.Symbol, Variable]:
    """Variables of symbols, as labelled or with the symbol's own name."""
    given = labels or {}
    for one in symbols:
        name = str(one)
        if one not in given and (not NAME.fullmatch(name) or name in (str(TIME), "time") or _TAKEN.fullmatch(name)):
            raise ModelError(
                f"'{name}' can't be the name of a variable of the block; give it another one with "
                f"labels={{symbol: Variable('name', 'unit', 'description')}}"
            )
    return {one: given.get(one) or Variable(str(one)) for one in symbols}


def _parameter_symbols(parameters: Iterable[sp.Symbol]) -> dict[sp.Symbol, sp.Symbol]:
    return {one: symbol(str(one)) for one in parameters}


def _declared(symbols: Iterable[sp.Symbol], given: Declarations) -> list[Parameter]:
    """Declarations of a system's parameters, each by itself or by its value alone."""
    names = dict.fromkeys(map(str, symbols))
    if isinstance(given, Mapping):
        values = {str(one): value for one, value in given.items()}
        declared = [Parameter(name, "1", f"parameter {name}", float(values[name])) for name in names if name in values]
        there = set(values)
    else:
        declared, there = list(given), {str(one.symbol) for one in given}
    known = {str(symbol(name)) for name in names}
    if missing := [name for name in names if str(symbol(name)) not in {str(one.symbol) for one in declared}]:
        raise ModelError(f"parameters without a value: {', '.join(missing)}; give `parameters` one for each")
    if unknown := [name for name in there if str(symbol(name)) not in known]:
        raise ModelError(f"the system has {unknown_name('parameter', unknown[0], list(names))}")
    return declared


def _start_parameters(
    states: Iterable[sp.Symbol], known: Mapping[sp.Symbol, Variable], starts: Values, allowed: Iterable[sp.Symbol]
) -> dict[sp.Symbol, Parameter]:
    values = {str(one): float(value) for one, value in starts.items()}
    names = [str(one) for one in allowed]
    for name in values:
        if name not in names:
            raise ModelError(f"starts: there is {unknown_name('state', name, names)}")
    return {one: start_parameter(known[one], values.get(str(one), 0.0)) for one in states}


def start_parameter(one: Variable, value: float = 0.0) -> Parameter:
    """Fixed parameter that is the start value of a state."""
    stem, bracket, indices = one.name.partition("[")
    return Parameter(
        f"{stem}_start{bracket}{indices}", one.unit, f"start value of {one.name}", value, nominal=one.nominal
    )
