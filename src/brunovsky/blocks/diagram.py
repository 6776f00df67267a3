"""Blocks wired together, which are a block again.

Flattening substitutes each connected input by the output expression that drives it, in the order of feedthrough,
so a diagram has exactly the equations of its blocks and no others.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from graphlib import CycleError, TopologicalSorter
from typing import Any, TypeVar

import sympy as sp

from brunovsky._frozen import FrozenMapping
from brunovsky.blocks.block import Block
from brunovsky.blocks.relations import root_symbols
from brunovsky.blocks.units import unit_exponents
from brunovsky.blocks.variables import Check, Input, Output, Parameter, Sample, Variable, symbol
from brunovsky.errors import ModelError

Parts = dict[str, list[Any]]
Export = Mapping[str, str | Sequence[str]]
V = TypeVar("V", bound=Input | Parameter)


@dataclass(frozen=True, init=False, repr=False)
class Diagram(Block):
    """Named blocks and the connections between them.

    Parameters
    ----------
    name, description : str
        As for a block.
    components : mapping of str to Block
        The blocks by the name they have in this diagram.
    connections : mapping of str to str
        Driven input to driving output, ``{"robot.u[1]": "inner_loop.u[1]"}``. A name without its index stands for
        all of its elements: ``{"controller.Z1": "plant.Z1"}``.
    inputs, parameters : mapping of str to str or sequence of str
        Exported name to the input or parameter behind it, or to several that share it. A parameter that is not
        exported keeps its flattened name ``component.parameter``; an input must be connected or exported.
    outputs : mapping of str to str
        Exported name to the output behind it.
    values : mapping of str to float, optional
        New default values of parameters, by their name in this diagram.

    Attributes
    ----------
    exports : mapping of str to tuple of str
        Exported name to the names behind it, for inputs, outputs and parameters.

    Raises
    ------
    ModelError
        For an unknown or unconnected name, unequal units, shared defaults that disagree, or an algebraic loop
        (the message names its cycle).
    """

    components: Mapping[str, Block] = field(default_factory=dict)
    connections: Mapping[str, str] = field(default_factory=dict)
    exports: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def __init__(
        self,
        name: str,
        description: str = "",
        *,
        components: Mapping[str, Block],
        connections: Mapping[str, str] | None = None,
        inputs: Export | None = None,
        outputs: Mapping[str, str] | None = None,
        parameters: Export | None = None,
        values: Mapping[str, float] | None = None,
    ) -> None:
        wires = _Wires.of(name, components, connections or {}, inputs or {}, outputs or {}, parameters or {})
        fixed = {"name": name, "description": description, "components": FrozenMapping(components)}
        fixed["connections"] = FrozenMapping(wires.drivers)
        shown = {key: (one,) for key, one in wires.outputs.items()}
        fixed["exports"] = FrozenMapping(wires.inputs | wires.parameters | shown)
        for key, value in (fixed | _flattened(wires, values or {})).items():
            object.__setattr__(self, key, value)
        self.__post_init__()


@dataclass(frozen=True)
class _Wires:
    """What is connected to what, all names flattened and checked."""

    name: str
    parts: tuple[Parts, ...]
    drivers: dict[str, str]
    inputs: dict[str, tuple[str, ...]]
    outputs: dict[str, str]
    parameters: dict[str, tuple[str, ...]]

    @classmethod
    def of(
        cls,
        name: str,
        components: Mapping[str, Block],
        connections: Mapping[str, str],
        inputs: Export,
        outputs: Mapping[str, str],
        parameters: Export,
    ) -> _Wires:
        parts = tuple(_prefixed(block, key) for key, block in components.items())
        known = {
            kind: {one.name: one for part in parts for one in part[kind]}
            for kind in ("inputs", "outputs", "parameters")
        }

        def named(one: str, kind: str) -> str:
            if one not in known[kind]:
                raise ModelError(f"diagram {name}: there is no {kind[:-1]} '{one}'; there are {', '.join(known[kind])}")
            return one

        def shared(export: Export, kind: str) -> dict[str, tuple[str, ...]]:
            groups = {key: (one,) if isinstance(one, str) else tuple(one) for key, one in export.items()}
            return {key: tuple(named(one, kind) for one in group) for key, group in groups.items()}

        drivers: dict[str, str] = {}
        for target, source in connections.items():
            for indices in _elements(target, known["inputs"]):
                element = named(target + indices, "inputs")
                if element in drivers:
                    raise ModelError(f"diagram {name}: input '{element}' is connected twice")
                drivers[element] = named(source + indices, "outputs")
        exported = {key: named(one, "outputs") for key, one in outputs.items()}
        wires = cls(name, parts, drivers, shared(inputs, "inputs"), exported, shared(parameters, "parameters"))
        wires._check(known["inputs"], known["outputs"])
        return wires

    def _check(self, inputs: Mapping[str, Input], outputs: Mapping[str, Output]) -> None:
        fed = [*self.drivers, *(one for group in self.inputs.values() for one in group)]
        for one in inputs:
            if fed.count(one) != 1:
                problem = "is not connected: connect or export it" if one not in fed else "is fed twice"
                raise ModelError(f"diagram {self.name}: input '{one}' {problem}")
        for target, source in self.drivers.items():
            if outputs[source].is_boolean:
                raise ModelError(f"diagram {self.name}: '{source}' is true or false and cannot drive '{target}'")
            _check_units(self.name, inputs[target], outputs[source])


def _flattened(wires: _Wires, values: Mapping[str, float]) -> Parts:
    """Parts of the flat block: inputs substituted, shared names merged, states renamed as they are exported."""
    joined: Parts = {key: [one for part in wires.parts for one in part[key]] for key in wires.parts[0]}
    parameters, merged = _merged(wires.name, wires.parameters, joined["parameters"], values)
    inputs, exported = _merged(wires.name, wires.inputs, joined["inputs"], {})
    unknown = set(values) - {one.name for one in parameters}
    if unknown:
        raise ModelError(f"diagram {wires.name}: there is no parameter '{unknown.pop()}' to give a value to")
    joined["parameters"] = [dataclasses.replace(one, value=values.get(one.name, one.value)) for one in parameters]
    joined["inputs"] = [one for one in inputs if one.name not in wires.drivers]
    origins = {one.symbol: number for number, part in enumerate(wires.parts) for one in part["samples"]}
    joined = _mapped(joined, _resolved(wires, merged | exported))
    expressions = {one.name: one for one in joined["outputs"]}
    joined["outputs"] = [dataclasses.replace(expressions[source], name=name) for name, source in wires.outputs.items()]
    joined["samples"] = _ranked(wires.name, joined, origins)
    carriers = {one.symbol: one.name for key in ("states", "samples", "modes") for one in joined[key]}
    aliases: dict[sp.Symbol, str] = {}
    for output in joined["outputs"]:
        if output.expression in carriers:
            aliases.setdefault(output.expression, output.name)
    names = {carriers[old]: new for old, new in aliases.items()}
    return _mapped(joined, {old: symbol(new) for old, new in aliases.items()}, lambda name: names.get(name, name))


def _resolved(wires: _Wires, shared: Mapping[sp.Symbol, sp.Symbol]) -> dict[sp.Symbol, sp.Basic]:
    """Symbols of all inputs as expressions of what drives them, in the order of feedthrough."""
    outputs = {one.name: one.expression for part in wires.parts for one in part["outputs"]}
    relations = [one for part in wires.parts for one in part["relations"]]
    names = {one.symbol: one.name for part in wires.parts for one in part["inputs"]}
    graph: dict[str, set[str]] = {target: {source} for target, source in wires.drivers.items()}
    for name, expression in outputs.items():
        graph[name] = {names[one] for one in root_symbols(expression, relations) if one in names}
    resolved: dict[sp.Symbol, sp.Basic] = dict(shared)
    try:
        order = list(TopologicalSorter(graph).static_order())
    except CycleError as error:
        cycle = " <- ".join(error.args[1])
        raise ModelError(
            f"diagram {wires.name} has an algebraic loop: {cycle}; put a state or a sample between"
        ) from None
    for name in order:
        if name in wires.drivers:
            resolved[symbol(name)] = outputs[wires.drivers[name]].xreplace(resolved)
    return resolved


def _merged(
    diagram: str, groups: Mapping[str, tuple[str, ...]], items: Sequence[V], values: Mapping[str, float]
) -> tuple[list[V], dict[sp.Symbol, sp.Symbol]]:
    """Exported variables first, each in place of those that share it; then the others. And the symbols replaced."""
    known = {one.name: one for one in items}
    merged: list[V] = []
    for name, group in groups.items():
        sharing = [known[one] for one in group]
        for other in sharing[1:]:
            _check_units(diagram, sharing[0], other)
            if name not in values and getattr(other, "value", None) != getattr(sharing[0], "value", None):
                raise ModelError(
                    f"diagram {diagram}: '{sharing[0].name}' and '{other.name}' share '{name}' "
                    "with different defaults; give it a value in `values`"
                )
        merged.append(dataclasses.replace(sharing[0], name=name, **_common_range(sharing)))
    used = {one for group in groups.values() for one in group}
    symbols = {symbol(one): symbol(name) for name, group in groups.items() for one in group}
    return [*merged, *(one for one in items if one.name not in used)], symbols


def _common_range(sharing: Sequence[Variable]) -> dict[str, Any]:
    parameters = [one for one in sharing if isinstance(one, Parameter)]
    if not parameters:
        return {}
    return {
        "minimum": max(one.minimum for one in parameters),
        "maximum": min(one.maximum for one in parameters),
        "tunable": all(one.tunable for one in parameters),
    }


def _ranked(diagram: str, parts: Parts, origins: Mapping[sp.Symbol, int]) -> list[Sample]:
    """Samples with the ranks of a diagram: another component's fresh value is seen, its own is from before.

    A rank that was declared is the least that a sample has.
    """
    samples: list[Sample] = parts["samples"]
    reads = {one.symbol: root_symbols(one.update, parts["relations"]) for one in samples}
    ranks = {one.symbol: one.rank for one in samples}
    for _ in range(len(samples) + 1):
        before = dict(ranks)
        for reader in samples:
            for source in samples:
                if source.symbol not in reads[reader.symbol]:
                    continue
                same = origins[reader.symbol] == origins[source.symbol]
                if same and reader.rank <= source.rank:
                    ranks[source.symbol] = max(ranks[source.symbol], ranks[reader.symbol])
                else:
                    ranks[reader.symbol] = max(ranks[reader.symbol], ranks[source.symbol] + 1)
        if ranks == before:
            return [dataclasses.replace(one, rank=ranks[one.symbol]) for one in samples]
    cycle = ", ".join(one.name for one in samples if ranks[one.symbol] > len(samples) - 1)
    raise ModelError(f"diagram {diagram}: the samples {cycle} feed each other at one instant; put a unit delay between")


def _prefixed(block: Block, prefix: str) -> Parts:
    """Parts of a block with every name flattened to ``prefix.name``."""
    parts = {one.name: list(getattr(block, one.name)) for one in dataclasses.fields(Block) if one.type != "str"}
    relations = {one.symbol: sp.Symbol(f"{prefix}.{one.name}") for one in block.relations}
    symbols = {one.symbol: symbol(f"{prefix}.{one.name}") for one in block.variables}
    return _mapped(parts, symbols | relations, lambda name: f"{prefix}.{name}")


def _mapped(
    parts: Parts, symbols: Mapping[sp.Symbol, sp.Basic], rename: Callable[[str], str] = lambda name: name
) -> Parts:
    """Parts with symbols substituted in every expression and names mapped; a check keeps its name."""
    substituted: dict[sp.Basic, sp.Basic] = dict(symbols)

    def mapped(item: Any, key: str, value: Any) -> Any:
        if key == "name":
            return value if isinstance(item, Check) else rename(value)
        if key == "clock" and value:
            return rename(value)
        if isinstance(value, sp.Basic):
            return _substituted(value, substituted)
        if isinstance(value, Mapping):
            return {mapped(item, "", one): mapped(item, "", other) for one, other in value.items()}
        return value

    def renewed(item: Any) -> Any:
        new = {one.name: mapped(item, one.name, getattr(item, one.name)) for one in dataclasses.fields(item)}
        return dataclasses.replace(item, **new)

    return {key: [renewed(item) for item in items] for key, items in parts.items()}


def _substituted(expression: sp.Basic, known: dict[sp.Basic, sp.Basic]) -> sp.Basic:
    """Expression with what is known replaced; all parts found are added, so that shared ones are renewed once."""
    if expression not in known:
        args = [_substituted(one, known) for one in expression.args]
        same = all(new is old for new, old in zip(args, expression.args, strict=True))
        known[expression] = expression if same else expression.func(*args)
    return known[expression]


def _elements(name: str, known: Mapping[str, Variable]) -> list[str]:
    """Index texts of the elements a bus name stands for; one empty text for a plain name."""
    return [""] if name in known else [one.removeprefix(name) for one in known if one.startswith(f"{name}[")] or [""]


def _check_units(diagram: str, one: Variable, other: Variable) -> None:
    if unit_exponents(one.unit) != unit_exponents(other.unit):
        raise ModelError(
            f"diagram {diagram}: '{one.name}' is in {one.unit} and '{other.name}' in {other.unit}; units must be equal"
        )
