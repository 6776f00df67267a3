"""The noun of the package: a block, a frozen description that every target is derived from."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, TypeVar

import sympy as sp

from brunovsky._suggest import unknown_name
from brunovsky.blocks.clocks import checked_clocks, clocked_samples
from brunovsky.blocks.relations import RelationTable, ordered_relations, reached_relations, root_symbols, symbols_in
from brunovsky.blocks.units import unit_exponents
from brunovsky.blocks.variables import (
    NAME,
    TIME,
    Check,
    Clock,
    Input,
    Mode,
    Output,
    Parameter,
    Relation,
    Sample,
    State,
    Transition,
    Variable,
    check_nominal,
)
from brunovsky.errors import ModelError, ParameterError

V = TypeVar("V", bound=Variable)
_FROM_PARAMETERS = "parameters"
KINDS = {
    "inputs": Input,
    "parameters": Parameter,
    "states": State,
    "samples": Sample,
    "modes": Mode,
    "outputs": Output,
    "relations": Relation,
    "transitions": Transition,
    "checks": Check,
    "clocks": Clock,
}
"""Class of the declarations in each group of a block."""


@dataclass(frozen=True, repr=False)
class Block:
    """Named variables and the SymPy expressions that connect them; not a running thing.

    Switching functions in the expressions are converted into named relations at construction (those found are
    appended to ``relations``), so that all targets freeze the same conditions. ``description`` is one line.

    Parameters
    ----------
    name : str
        Identifier, also of the FMU.
    inputs, parameters, states, samples, modes, outputs : sequences of variables
        The order of declaration is the order of value references.
    relations, transitions, checks
        Switching conditions, what happens at events, and what must hold.
    clocks
        What samples may name instead of a period.

    Raises
    ------
    ModelError
        If a name is illegal or used twice, a symbol or clock unknown, a unit unreadable, a clock without samples or
        fixed period, or an expression cannot be frozen.
    ParameterError
        If a default value is not finite or out of its range, or a nominal one not positive.
    """

    name: str
    description: str = ""
    inputs: tuple[Input, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    states: tuple[State, ...] = ()
    samples: tuple[Sample, ...] = ()
    modes: tuple[Mode, ...] = ()
    outputs: tuple[Output, ...] = ()
    relations: tuple[Relation, ...] = ()
    transitions: tuple[Transition, ...] = ()
    checks: tuple[Check, ...] = field(default=())
    clocks: tuple[Clock, ...] = ()

    def __post_init__(self) -> None:
        """Freeze the sequences, lower the switching functions and check what is declared."""
        for item in dataclasses.fields(Block):
            value = getattr(self, item.name)
            if not isinstance(value, str):
                object.__setattr__(self, item.name, self._checked(item.name, value))
        self._check_names()
        self._clock()
        self._lower()
        self._check_symbols()
        self.parameter_values()

    def _checked(self, group: str, items: Any) -> tuple[Any, ...]:
        """Declarations of a group as a tuple, each of the class that belongs there."""
        kind = KINDS[group]
        if isinstance(items, kind):
            raise ModelError(f"{self.name}: {group} must be a sequence; write {group}=[{kind.__name__}(…)]")
        for one in items:
            if not isinstance(one, kind):
                raise ModelError(f"{self.name}: {group} must be made of {kind.__name__}(…), not {one!r}")
            if isinstance(one, Variable) and not isinstance(one.unit, str):
                raise ModelError(
                    f"{self.name}: '{one.name}' has the unit {one.unit!r}, which is not a text like 'm/s2'"
                )
        return tuple(items)

    def _check_names(self) -> None:
        if not NAME.fullmatch(self.name) or "." in self.name or "[" in self.name:
            raise ModelError(f"block name '{self.name}' is not an identifier")
        if self.name == "time":
            raise ModelError("a block cannot be called 'time', the name of the independent variable")
        seen: dict[sp.Symbol, str] = {TIME: "time"}
        carriers = {one.name for one in (*self.states, *self.samples, *self.modes)}
        named: tuple[Variable | Clock, ...] = (*self.variables, *self.clocks)
        for variable in named:
            if isinstance(variable, Output) and variable.name in carriers and variable.expression == variable.symbol:
                continue
            if not NAME.fullmatch(variable.name) or variable.name == "time":
                raise ModelError(f"{self.name}: '{variable.name}' is not a legal variable name; write it like 'eta[1]'")
            if variable.symbol in seen:
                raise ModelError(f"{self.name}: '{variable.name}' and '{seen[variable.symbol]}' share a name or symbol")
            seen[variable.symbol] = variable.name
            unit_exponents(variable.unit)
        for one in self.variables:
            check_nominal(self.name, one)

    def _clock(self) -> None:
        clocks = checked_clocks(self.name, self.clocks, self.parameters, self.samples)
        object.__setattr__(self, "clocks", clocks)
        object.__setattr__(self, "samples", clocked_samples(self.name, self.samples, clocks))

    def _lower(self) -> None:
        table = RelationTable(self.relations, [mode.symbol for mode in self.modes])

        def lower(expression: object, what: str) -> sp.Basic:
            return table.lower(sp.sympify(expression), f"{self.name}: {what}")

        def replaced(items: Iterable[V], *attributes: str) -> tuple[V, ...]:
            return tuple(
                dataclasses.replace(
                    item,
                    **{name: lower(getattr(item, name), f"{name} of '{item.name}'") for name in attributes},
                )
                for item in items
            )

        object.__setattr__(self, "states", replaced(self.states, "derivative", "start"))
        object.__setattr__(self, "samples", replaced(self.samples, "update", "start", "period"))
        outputs = replaced(self.outputs, "expression")
        transitions = tuple(
            Transition(
                one.name,
                lower(one.guard, f"guard of '{one.name}'"),
                {target: lower(value, f"assignment of '{one.name}'") for target, value in one.assign.items()},
            )
            for one in self.transitions
        )
        relations = {one.symbol for one in table.relations}
        outputs = tuple(
            dataclasses.replace(one, is_boolean=one.expression in relations or not isinstance(one.expression, sp.Expr))
            for one in outputs
        )
        object.__setattr__(self, "outputs", outputs)
        object.__setattr__(self, "transitions", transitions)
        object.__setattr__(self, "relations", tuple(ordered_relations(table.relations, self.name)))
        acting = set(self.acting_relations)
        object.__setattr__(self, "relations", tuple(sorted(self.relations, key=lambda one: one not in acting)))

    def _check_symbols(self) -> None:
        parameters = {parameter.symbol for parameter in self.parameters}
        relations = {relation.symbol for relation in self.relations}
        assignable = {item.symbol for item in (*self.states, *self.samples, *self.modes)}
        outputs = {output.symbol for output in self.outputs} - assignable
        everything = {variable.symbol for variable in self.variables} - outputs | relations | {TIME}
        for what, expression, known in self._expressions():
            usable = parameters if known == _FROM_PARAMETERS else everything
            unknown = symbols_in(expression) - usable
            if unknown:
                twins = {str(one) for one in unknown} & {str(one) for one in usable}
                if twins:
                    raise ModelError(
                        f"{self.name}: {what} uses a symbol {min(twins)} that is not the variable's, which is real; "
                        f"take it from brunovsky.blocks.symbol"
                    )
                names = ", ".join(sorted(str(one) for one in unknown))
                allowed = "parameters of the block" if known == _FROM_PARAMETERS else "variables of the block and time"
                raise ModelError(f"{self.name}: {what} uses {names}; it may use only {allowed}")
        modes = {mode.symbol for mode in self.modes}
        for transition in self.transitions:
            for target, value in transition.assign.items():
                where = f"{self.name}: transition '{transition.name}' assigns {target}"
                if target not in assignable:
                    raise ModelError(f"{where}, not a state, sample or mode")
                if target in modes and value.is_number and not value.is_integer:
                    raise ModelError(f"{where} = {value}; a mode is an integer")
        tunable = {parameter.symbol for parameter in self.parameters if parameter.tunable}
        for sample in self.samples:
            if sample.period.free_symbols & tunable:
                raise ModelError(f"{self.name}: the period of '{sample.name}' is tunable; a period must be fixed")

    def _expressions(self) -> Iterable[tuple[str, sp.Basic, str]]:
        for state in self.states:
            yield f"derivative of '{state.name}'", state.derivative, ""
            yield f"start of '{state.name}'", state.start, _FROM_PARAMETERS
        for sample in self.samples:
            yield f"update of '{sample.name}'", sample.update, ""
            yield f"start of '{sample.name}'", sample.start, _FROM_PARAMETERS
            yield f"period of '{sample.name}'", sample.period, _FROM_PARAMETERS
        for output in self.outputs:
            yield f"output '{output.name}'", output.expression, ""
        for relation in self.relations:
            yield f"relation '{relation.name}'", relation.expression, ""
            yield f"indicator of '{relation.name}'", relation.indicator or relation.expression, ""
        for transition in self.transitions:
            yield f"guard of '{transition.name}'", transition.guard, ""
            for target, value in transition.assign.items():
                yield f"assignment of {target} in '{transition.name}'", value, ""
        for check in self.checks:
            yield f"check '{check.name}'", check.condition, "" if check.when == "failure" else _FROM_PARAMETERS

    def __repr__(self) -> str:
        groups = ("inputs", "parameters", "states", "samples", "modes", "clocks", "outputs")
        counts = ", ".join(f"{len(getattr(self, one))} {one}" for one in groups if getattr(self, one))
        return f"<{type(self).__name__} {self.name}: {counts or 'empty'}>"

    def table(self) -> str:
        """Variables with kind, unit, value and description, as a Markdown table that reads as plain text too."""
        rows = [("name", "kind", "unit", "value", "description")]
        for kind in ("inputs", "parameters", "states", "samples", "modes", "clocks", "outputs"):
            for one in getattr(self, kind):
                value = next((getattr(one, key) for key in ("value", "start", "period") if hasattr(one, key)), "")
                rows.append((one.name, kind[:-1], one.unit, str(value), one.description))
        widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
        rows.insert(1, tuple("-" * width for width in widths))  # type: ignore[arg-type]
        return "\n".join(
            "| " + " | ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) + " |" for row in rows
        )

    def _repr_markdown_(self) -> str:
        return f"**{self.name}**: {self.description}\n\n{self.table()}\n"

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """Parameters, inputs, states, samples, modes and outputs, in order of declaration."""
        return (*self.parameters, *self.inputs, *self.states, *self.samples, *self.modes, *self.outputs)

    @cached_property
    def acting_relations(self) -> tuple[Relation, ...]:
        """Relations that act between samples; the others, which come last, are read by updates of samples alone."""
        acting = reached_relations(
            [
                *(one.derivative for one in self.states),
                *(one.expression for one in self.outputs),
                *(one.guard for one in self.transitions),
                *(one.condition for one in self.checks if one.when == "failure"),
            ],
            self.relations,
        )
        return tuple(one for one in self.relations if one.symbol in acting)

    @cached_property
    def indicators(self) -> tuple[sp.Expr, ...]:
        """Functions whose zero crossings are state events, of the relations that act between events, once each."""
        fixed = {item.symbol for item in (*self.parameters, *self.modes, *self.samples)}
        found: list[sp.Expr] = []
        for relation in self.acting_relations:
            expression = relation.expression if relation.indicator is None else relation.indicator
            if symbols_in(expression) - fixed and not {expression, -expression} & set(found):
                found.append(expression)
        return tuple(found)

    @cached_property
    def periods(self) -> tuple[sp.Expr, ...]:
        """Distinct sample periods, in order of first use, s."""
        return tuple(dict.fromkeys(sample.period for sample in self.samples))

    def depends_on(self, expression: sp.Basic) -> frozenset[sp.Symbol]:
        """Symbols an expression depends on, relations resolved into what they are evaluated from."""
        return root_symbols(expression, self.relations)

    @cached_property
    def feedthrough(self) -> Mapping[str, frozenset[str]]:
        """For each output the inputs it depends on without a state between."""
        inputs = {one.symbol: one.name for one in self.inputs}
        return {
            output.name: frozenset(inputs[one] for one in self.depends_on(output.expression) if one in inputs)
            for output in self.outputs
        }

    def parameter_values(self, values: Mapping[str, float] | None = None) -> dict[str, float]:
        """Defaults with some values replaced, in order of declaration.

        Raises
        ------
        ParameterError
            For an unknown name, or a value that is not finite or out of range.
        """
        result = {parameter.name: parameter.value for parameter in self.parameters}
        for name, value in (values or {}).items():
            if name not in result:
                raise ParameterError(f"{self.name} has {unknown_name('parameter', name, result)}")
            try:
                result[name] = float(value)
            except (TypeError, ValueError):
                raise ParameterError(f"{self.name}: {name} = {value!r} is not a number") from None
        for parameter in self.parameters:
            value = result[parameter.name]
            if not math.isfinite(value) or not parameter.minimum <= value <= parameter.maximum:
                raise ParameterError(
                    f"{self.name}: {parameter.name} = {value:g} {parameter.unit} is not a finite number "
                    f"from {parameter.minimum:g} to {parameter.maximum:g}"
                )
        return result

    def failed_checks(self, values: Mapping[str, float], *whens: str) -> list[Check]:
        """Checks of the given kinds whose condition does not hold for these parameter values."""
        numbers = {parameter.symbol: sp.Float(values[parameter.name]) for parameter in self.parameters}
        return [one for one in self.checks if one.when in whens and one.condition.xreplace(numbers) == sp.false]
