"""C99 text of a block: its expressions as the functions that the runtime calls.

Common subexpressions are taken out per function. The text depends on the block alone, so equal blocks give equal
text, which the cache of compiled code and the tokens of FMUs rest on.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache

import sympy as sp
from sympy.printing.c import C99CodePrinter

from brunovsky.blocks import TIME, Block, Relation, Variable

_ARGUMENTS = "ARGUMENTS"
_RELATION_ARGUMENTS = (
    "double t, const double *x, const double *u, const double *p, const double *q, const int *m, int *r"
)
_PARAMETER_ARGUMENTS = "const double *p"


class _Printer(C99CodePrinter):  # type: ignore[misc]
    """C99 with the block's symbols as array elements, and whole powers up to 4 as products."""

    def __init__(self, names: dict[sp.Symbol, str], missing: str = "") -> None:
        super().__init__({"precision": 17, "math_macros": {}})  # C99 has no M_PI
        self._names, self._missing = names, missing

    def _print_Symbol(self, expr: sp.Symbol) -> str:
        return self._names.get(expr, str(expr.name))

    def _print_Pow(self, expr: sp.Pow) -> str:
        base, exponent = expr.args
        if exponent.is_Integer and 1 < abs(exponent) <= 4:
            product = "*".join([self.parenthesize(base, sp.printing.precedence.PRECEDENCE["Pow"])] * abs(exponent))
            return f"({product})" if exponent > 0 else f"(1.0/({product}))"
        return str(super()._print_Pow(expr))

    def _print_not_supported(self, expr: sp.Basic) -> str:
        return self._missing or str(super()._print_not_supported(expr))

    def _print_NumberSymbol(self, expr: sp.NumberSymbol) -> str:
        return repr(float(expr))

    _print_Pi = _print_Exp1 = _print_GoldenRatio = _print_EulerGamma = _print_Catalan = _print_NumberSymbol

    def _print_Or(self, expr: sp.Or) -> str:
        return " || ".join(f"({self._print(one)})" for one in sp.ordered(expr.args))

    def _print_BooleanTrue(self, expr: sp.Basic) -> str:
        return "1"

    def _print_BooleanFalse(self, expr: sp.Basic) -> str:
        return "0"


class BlockText:
    """Prints the functions of one block; ``missing`` stands for what C has no function for, an error without it."""

    def __init__(self, block: Block, missing: str = "") -> None:
        names = {TIME: "t"}
        groups: tuple[tuple[str, Sequence[Variable | Relation]], ...] = (
            ("x", block.states),
            ("u", block.inputs),
            ("p", block.parameters),
            ("q", block.samples),
            ("m", block.modes),
            ("r", block.relations),
        )
        for letter, group in groups:
            names |= {one.symbol: f"{letter}[{index}]" for index, one in enumerate(group)}
        self._printer = _Printer(names, missing)

    def assignments(self, targets: Sequence[str], expressions: Sequence[sp.Basic]) -> list[str]:
        """Statements that compute the expressions, common subexpressions first."""
        common, reduced = sp.cse(list(expressions), symbols=sp.numbered_symbols("c"))
        return self._constants(common) + [
            f"{target} = {self._printer.doprint(value)};" for target, value in zip(targets, reduced, strict=True)
        ]

    def _constants(self, common: Iterable[tuple[sp.Symbol, sp.Basic]]) -> list[str]:
        return [f"const double {name} = {self._printer.doprint(value)};" for name, value in common]

    def function(self, name: str, out: str, expressions: Sequence[sp.Basic], arguments: str = _ARGUMENTS) -> str:
        """Pure function that writes the expressions to the array ``out``."""
        targets = [f"{out}[{index}]" for index in range(len(expressions))]
        return _function(f"void {name}({arguments}, double *{out})", self.assignments(targets, expressions))

    def program(self, header: str, statements: Iterable[tuple[sp.Symbol | str, sp.Basic]]) -> str:
        """Function that makes assignments one after the other: symbols are declared, texts assigned to."""
        lines = [
            f"{'const double ' if isinstance(target, sp.Symbol) else ''}{target} = {self._printer.doprint(value)};"
            for target, value in statements
        ]
        return _function(header, lines)

    def checks(self, name: str, conditions: Sequence[tuple[int, str, sp.Basic]], arguments: str) -> str:
        """Function that returns the index of the first condition that does not hold, or -1."""
        lines = [
            f"if ({prefix}!({self._printer.doprint(condition)}))\n        return {index};"
            for index, prefix, condition in conditions
        ]
        return _function(f"int {name}({arguments})", [*lines, "return -1;"])

    def relations(self, block: Block) -> str:
        """Function that evaluates the relations in order, each after those it depends on."""
        lines = []
        for index, one in enumerate(block.relations):
            common, (reduced,) = sp.cse([one.expression], symbols=sp.numbered_symbols(f"c{index}_"))
            lines += self._constants(common)
            lines.append(f"r[{index}] = {self._printer.doprint(reduced)} > 0;")
        return _function(f"void relations({_RELATION_ARGUMENTS})", lines)

    def transitions(self, block: Block) -> str:
        """Function that makes the assignments of all transitions whose guard holds, the first declared last."""
        targets = {
            one.symbol: f"{letter}_new[{index}]"
            for letter, group in (("x", block.states), ("q", block.samples), ("m", block.modes))
            for index, one in enumerate(group)
        }
        lines = ["int fired = 0;"]
        for one in reversed(block.transitions):
            common, reduced = sp.cse(list(one.assign.values()), symbols=sp.numbered_symbols("c"))
            values = [
                f"{targets[key]} = {self._cast(targets[key], value)};"
                for key, value in zip(one.assign, reduced, strict=True)
            ]
            body = "\n    ".join(f"    {line}" for line in (*self._constants(common), *values, "fired = 1;"))
            lines.append(f"if ({self._printer.doprint(one.guard)}) {{\n    {body}\n    }}")
        header = f"int fire({_ARGUMENTS}, double *x_new, double *q_new, int *m_new)"
        return _function(header, [*lines, "return fired;"])

    def _cast(self, target: str, value: sp.Expr) -> str:
        text = self._printer.doprint(value)
        return f"(int)({text})" if target.startswith("m") else text


@lru_cache(maxsize=64)
def model_source(block: Block) -> str:
    """C99 source of a block, to be compiled with the runtime's ``engine.c``.

    Parameters
    ----------
    block : Block
        Any block or diagram.

    Returns
    -------
    str
        Defines ``const Model brunovsky_model`` of ``model.h``.
    """
    text = BlockText(block)
    starts = [one.start for one in block.states]
    start = _function(
        "void start(const double *p, double *x, double *q)",
        text.assignments(
            [*(f"x[{i}]" for i in range(len(starts))), *(f"q[{i}]" for i in range(len(block.samples)))],
            [*starts, *(one.start for one in block.samples)],
        ),
    )
    periods = [sp.S.One if one.is_held else one.period for one in block.samples]
    checks = list(enumerate(block.checks))
    exchange = {"start": "", "model exchange": "model_exchange && "}
    functions = [
        start,
        text.function("periods", "period", periods, _PARAMETER_ARGUMENTS),
        text.function("derivatives", "dx", [one.derivative for one in block.states]),
        text.function("outputs", "y", [one.expression for one in block.outputs]),
        text.function("indicators", "z", block.indicators),
        text.relations(block),
        text.function("updates", "q_new", [one.update for one in block.samples]),
        text.transitions(block),
        text.checks(
            "start_check",
            [(index, exchange[one.when], one.condition) for index, one in checks if one.when in exchange],
            f"{_PARAMETER_ARGUMENTS}, int model_exchange",
        ),
        text.checks(
            "failure_check", [(index, "", one.condition) for index, one in checks if one.when == "failure"], _ARGUMENTS
        ),
    ]
    return "\n".join(
        [
            f'/* Generated from the block "{block.name}": {_comment(block.description)}. Do not edit. */',
            "#include <math.h>",
            '#include "model.h"',
            "",
            *_tables(block),
            "",
            *functions,
            _model(block),
        ]
    )


def _function(header: str, lines: Iterable[str]) -> str:
    body = [*_unused(header), *lines]
    return f"static {header}\n{{\n" + "".join(f"    {line}\n" for line in body) + "}\n"


def _unused(header: str) -> list[str]:
    inside = header[header.index("(") + 1 : -1].replace(_ARGUMENTS, f"{_RELATION_ARGUMENTS}")
    names = [one.split()[-1].lstrip("*") for one in inside.split(",")]
    return [" ".join(f"(void){name};" for name in names)]


def _comment(text: str) -> str:
    return text.replace("*/", "* /").replace("\n", " ")


def quoted(text: str) -> str:
    """Text as a string literal of C."""
    escaped = text.encode("unicode_escape").decode("ascii").replace('"', '\\"') if not text.isascii() else text
    if text.isascii():
        escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def _tables(block: Block) -> list[str]:
    def strings(name: str, items: Iterable[str]) -> str:
        return f"static const char *const {name}[] = {{{', '.join([*map(quoted, items), '0'])}}};"

    def numbers(kind: str, name: str, items: Iterable[float]) -> str:
        return f"static const {kind} {name}[] = {{{', '.join([*map(_number, items), '0'])}}};"

    fixed = {one.symbol: index for index, one in enumerate(block.parameters)}
    values = {one.symbol: sp.Float(one.value) for one in block.parameters}
    clocks = {one.name: index for index, one in enumerate(block.clocks)}
    return [
        strings("p_names", (one.name for one in block.parameters)),
        strings("u_names", (one.name for one in block.inputs)),
        strings("x_names", (one.name for one in block.states)),
        strings("q_names", (one.name for one in block.samples)),
        strings("y_names", (one.name for one in block.outputs)),
        strings("check_names", (one.name for one in block.checks)),
        strings("check_messages", (one.message for one in block.checks)),
        numbers("double", "p_default", (one.value for one in block.parameters)),
        numbers("double", "p_min", (one.minimum for one in block.parameters)),
        numbers("double", "p_max", (one.maximum for one in block.parameters)),
        numbers("double", "u_default", (one.start for one in block.inputs)),
        numbers("int", "m_start", (one.start for one in block.modes)),
        numbers("int", "q_rank", (-1 if one.is_held else one.rank for one in block.samples)),
        strings("k_names", (one.name for one in block.clocks)),
        numbers("int", "k_parameter", (fixed.get(one.period, -1) for one in block.clocks)),
        numbers("double", "k_period", (float(one.period.xreplace(values)) for one in block.clocks)),
        numbers("int", "q_clock", (clocks.get(one.clock, -1) for one in block.samples)),
        numbers("double", "x_nominal", (one.nominal for one in block.states)),
    ]


def _number(value: float) -> str:
    infinities = {float("inf"): "HUGE_VAL", -float("inf"): "-HUGE_VAL"}
    return infinities.get(value, repr(value))


def _model(block: Block) -> str:
    counts = {
        "np": block.parameters,
        "nu": block.inputs,
        "nx": block.states,
        "nq": block.samples,
        "nm": block.modes,
        "nr": block.relations,
        "ny": block.outputs,
        "nz": block.indicators,
        "transitions": block.transitions,
        "nk": block.clocks,
        "acting": block.acting_relations,
    }
    tables = "p_names u_names x_names q_names y_names p_default p_min p_max u_default m_start q_rank check_names"
    tables += " k_names k_parameter k_period q_clock x_nominal"
    functions = "start periods derivatives outputs indicators relations updates fire start_check failure_check"
    names = f"{tables} check_messages {functions}".split()
    fields = [f".name = {quoted(block.name)}"]
    fields += [f".{key} = {len(group)}" for key, group in counts.items()]
    fields += [f".ranks = {max((one.rank for one in block.samples), default=-1) + 1}"]
    fields += [f".{name} = {name}" for name in names]
    return "const Model brunovsky_model = {\n" + "".join(f"    {one},\n" for one in fields) + "};\n"
