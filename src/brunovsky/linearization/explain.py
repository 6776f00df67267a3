"""The derivation step by step, as on the board."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import sympy as sp

from brunovsky.linearization.affine import AffineSystem
from brunovsky.linearization.board import Equation, Formula, Heading, Line, Sentence, name, rate
from brunovsky.linearization.board import latex as _latex
from brunovsky.linearization.disturbance import disturbance_map
from brunovsky.linearization.input_transformation import InputTransformation
from brunovsky.linearization.relative_degree import OutputDerivatives
from brunovsky.linearization.zero_dynamics import ZeroDynamics

if TYPE_CHECKING:
    from brunovsky.linearization.linearize import Linearization


def derivation(linearization: Linearization) -> Iterator[Line]:
    """Yield all lines of the derivation, in order."""
    system, steps = linearization.system, linearization.extension.steps
    yield from _system(system)
    for step in steps:
        yield from _derivatives(step.system, step.derivatives)
        combinations = step.transformation.combinations if step.transformation else {}
        through = tuple(combinations.get(one, one) for one in step.delayed)
        yield Sentence(
            "G has generic rank {}, not {}: outputs {} depend on each other through {} alone, so it is singular "
            "everywhere and static feedback does not decouple them. "
            + ("Elimination proves the rank." if step.is_confirmed else "The rank is that at random points."),
            (step.rank, len(system.outputs), tuple(i + 1 for i in step.outputs), through),
        )
        if step.transformation:
            yield from _transformation(step.transformation)
        yield Heading("Dynamic extension")
        yield Sentence("An integrator in front of {}: a state now, its derivative an input.", (step.delayed,))
        for old, new in zip(step.delayed, step.inputs, strict=True):
            yield Equation(rate(old), new)
    yield from _derivatives(linearization.extended_system, linearization.extension.derivatives)
    yield Equation(Formula("det G", r"\det G"), linearization.determinant)
    yield from _law(linearization)
    if linearization.zero_dynamics:
        yield from _zero_dynamics(linearization.zero_dynamics)
    if system.disturbances:
        yield from disturbance_map(linearization).lines()


def _system(system: AffineSystem) -> Iterator[Line]:
    yield Heading("System")
    yield Sentence("States: {}; inputs: {}; outputs:", (system.states, system.inputs))
    for index, output in enumerate(system.outputs):
        yield Equation(_lie(index, 0), output)
    yield Sentence("Dynamics:")
    for state, derivative in zip(system.states, system.dynamics, strict=True):
        yield Equation(rate(state), derivative)
    if system.disturbances:
        yield Sentence("In what follows {} = 0: the law does not know the disturbances.", (tuple(system.disturbances),))


def _derivatives(system: AffineSystem, derivatives: OutputDerivatives) -> Iterator[Line]:
    yield Heading("Differentiate the outputs until an input appears")
    for index, chain in enumerate(derivatives.chains):
        for order in range(1, len(chain) + 1):
            row = derivatives.decoupling_matrix.row(index) if order == len(chain) else [0] * len(system.inputs)
            for symbol, gain in zip(system.inputs, row, strict=True):
                yield Equation(_lie(index, order - 1, symbol), gain)
            yield Equation(_lie(index, order), (*chain, derivatives.drift_term[index])[order])
    yield Sentence("Relative degree: {}.", (derivatives.relative_degree,))
    highest = Formula("y^(r) = F + G u", "y^{(r)} = F + G u")
    inputs = "the input {}" if len(system.inputs) == 1 else "the inputs {} in that order"
    yield Sentence(f"The highest derivatives are {{}} with {inputs} and", (highest, system.inputs))
    yield Equation(Formula("F", "F"), derivatives.drift_term)
    yield Equation(Formula("G", "G"), derivatives.decoupling_matrix)


def _transformation(transformation: InputTransformation) -> Iterator[Line]:
    yield Heading("Transformation of the inputs")
    yield Sentence("The combinations become inputs, in the place of {}:", (tuple(transformation.replaced),))
    for symbol, expression in (*transformation.combinations.items(), *transformation.replaced.items()):
        yield Equation(name(symbol), expression)
    if transformation.determinant.free_symbols:
        yield Sentence("It is regular where {} is not zero.", (transformation.determinant,))


def _zero_dynamics(zero: ZeroDynamics) -> Iterator[Line]:
    yield Heading("Zero dynamics")
    free_of = "no input" if zero.input_free else "inputs"
    yield Sentence(f"The chains are completed to coordinates by functions whose derivatives contain {free_of}:")
    for symbol, expression in zero.coordinates.items():
        yield Equation(name(symbol), expression)
    if zero.field is None:
        reason = (
            "was not found in closed form"
            if zero.normal_form.inverse is None
            else "is not defined, as the coordinates are singular there"
        )
        yield Sentence(f"How these move while the outputs are constant {reason}.")
        return
    if zero.normal_form.branch:
        yield Sentence("On the branch where these are positive: {}.", (zero.normal_form.branch,))
    yield Sentence("With the outputs kept at the constants {} they obey", (zero.constants,))
    for symbol, slope in zip(zero.coordinates, zero.field, strict=True):
        yield Equation(rate(symbol), slope)
    yield Sentence("The linearised plant is minimum phase at an equilibrium where these are asymptotically stable.")


def _law(linearization: Linearization) -> Iterator[Line]:
    yield Heading("Linearising law")
    inverse = Formula("u = G^-1 (v - F)", "u = G^{-1} (v - F)")
    yield Sentence("{} with the outer inputs {}:", (inverse, linearization.outer_inputs))
    for symbol, expression in linearization.law.items():
        yield Equation(name(symbol), expression)
    moved = {symbol: u for symbol, u in linearization.input_map.items() if not u.is_Symbol}
    if moved:
        yield Sentence("The inputs of the plant that are none of the extended system's follow from these:")
    for symbol, expression in moved.items():
        yield Equation(name(symbol), expression)
    locus = linearization.singular_locus
    if locus == sp.false:
        yield Sentence("It exists wherever F and G do.")
    else:
        yield Sentence("It does not exist where {}.", (locus,))
    total, count = sum(linearization.relative_degree), len(linearization.extended_system.states)
    kind = "the linearisation is full" if linearization.is_full else "there are internal dynamics"
    yield Sentence(f"The total relative degree is {{}}, the number of states {{}}: {kind}.", (total, count))


def _lie(index: int, order: int, symbol: sp.Symbol | None = None) -> Formula:
    """L_g L_f^k h_i, with g the vector field of the input symbol; without it L_f^k h_i."""
    plain, latex = f"h{index + 1}", f"h_{{{index + 1}}}"
    if order:
        power = order > 1
        plain = f"L_f{f'^{order}' if power else ''} {plain}"
        latex = f"L_{{f}}{f'^{{{order}}}' if power else ''} {latex}"
    if symbol is not None:
        plain, latex = f"L_g({symbol}) {plain}", f"L_{{g({_latex(symbol)})}} {latex}"
    return Formula(plain, latex)
