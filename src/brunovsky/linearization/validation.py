"""What an affine system is checked for when it is made."""

import warnings
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.functions.elementary.hyperbolic import HyperbolicFunction, InverseHyperbolicFunction
from sympy.functions.elementary.trigonometric import InverseTrigonometricFunction, TrigonometricFunction

from brunovsky.errors import ModelError, ParameterError

_NOT_SMOOTH = (
    *(sp.sign, sp.Abs, sp.Heaviside, sp.DiracDelta, sp.SingularityFunction),
    *(sp.Piecewise, sp.Min, sp.Max, sp.floor, sp.ceiling, sp.frac, sp.Mod),
)
_NOT_EXPLICIT = (AppliedUndef, sp.Derivative, sp.Integral, sp.Sum, sp.Product, sp.Limit, sp.Subs)
_ELEMENTARY = (
    *(sp.Symbol, sp.Number, sp.NumberSymbol, sp.Add, sp.Mul, sp.Pow, sp.exp, sp.log, sp.erf, sp.erfc, sp.sinc),
    *(TrigonometricFunction, InverseTrigonometricFunction, HyperbolicFunction, InverseHyperbolicFunction),
)
_NOT_FINITE = (sp.nan, sp.zoo, sp.oo, -sp.oo, sp.I)


def as_symbols(items: Any, what: str) -> tuple[sp.Symbol, ...]:
    """Return a tuple of the symbols, or say which of them is none."""
    symbols = _as_tuple(items, what, "symbols")
    for item in symbols:
        if not isinstance(item, sp.Symbol):
            raise ModelError(f"{what}: {item!r} is not a SymPy Symbol; create it with sympy.Symbol or sympy.symbols")
    return symbols


def as_matrix(entries: Any, shape: tuple[int, int], what: str, meaning: str) -> sp.ImmutableDenseMatrix:
    """Return the matrix of exact expressions, or say why there is none of that shape."""
    if isinstance(entries, str):
        raise ModelError(f"{what}: {entries!r} is a string; give SymPy expressions")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)  # how SymPy refuses relations and lists as entries
            matrix = sp.ImmutableDenseMatrix(entries)
    except (TypeError, ValueError) as error:
        raise ModelError(f"{what}: not a matrix of SymPy expressions ({error}); give {meaning}") from error
    except DeprecationWarning:
        raise ModelError(f"{what}: an entry of {entries} is not a scalar expression; give {meaning}") from None
    if matrix.shape != shape:
        raise ModelError(f"{what}: shape {matrix.shape} where {shape} is needed; give {meaning}")
    return matrix.applyfunc(_exact)


def as_expressions(items: Any, what: str) -> tuple[sp.Expr, ...]:
    """Return a tuple of exact expressions."""
    entries = _as_tuple(items, what, "expressions")
    return tuple(as_matrix(entries, (len(entries), 1), what, "scalar expressions")) if entries else ()


def _as_tuple(items: Any, what: str, kind: str) -> tuple[Any, ...]:
    try:
        if not isinstance(items, str):
            return tuple(items)
    except TypeError:
        pass
    raise ModelError(f"{what}: {items!r} is not a sequence of SymPy {kind}; give a tuple of them")


def resolve(values: Mapping[Any, Any], symbols: Sequence[sp.Symbol], what: str) -> dict[sp.Symbol, sp.Expr]:
    """Exact values by symbol, from values by symbol or by name."""
    by_name = {symbol.name: symbol for symbol in symbols}
    resolved = {}
    for key, value in values.items():
        symbol = by_name.get(str(key))
        if symbol is None:
            known = ", ".join(by_name) or "none"
            raise ParameterError(f"{key} is not a {what} of the system; known: {known}")
        try:
            expression = sp.sympify(value, strict=True)
        except sp.SympifyError as error:
            raise ParameterError(f"{key}: {value!r} is not a number or a SymPy expression") from error
        if not isinstance(expression, sp.Expr) or expression.has(*_NOT_FINITE):
            raise ParameterError(f"{key}: {value!r} is not a finite real value; give one")
        resolved[symbol] = _exact(expression)
    return resolved


def _exact(entry: Any) -> Any:
    """Floats become the rationals they print as: zero and rank tests then are exact."""
    if entry.has(*_NOT_FINITE):
        return entry
    return entry.xreplace({one: sp.Rational(_printed(one)) for one in entry.atoms(sp.Float)})


def _printed(number: sp.Float) -> str:
    double = float(number)
    return repr(double) if sp.Float(double, precision=number._prec) == number else str(number)


def check_distinct(groups: Sequence[tuple[str, Sequence[sp.Symbol]]]) -> None:
    """Refuse a name that is used twice, within one group of symbols or in two, whatever its assumptions."""
    owner: dict[str, str] = {}
    for group, symbols in groups:
        for symbol in symbols:
            if symbol.name in owner:
                raise ModelError(
                    f"the symbol {symbol.name} stands twice, in {owner[symbol.name]} and in {group}; "
                    "give every symbol one role and one name"
                )
            owner[symbol.name] = group


def check_expression(
    expression: sp.Expr,
    where: str,
    allowed: Iterable[sp.Symbol],
    inputs: Iterable[sp.Symbol],
    disturbances: Iterable[sp.Symbol],
) -> None:
    """Refuse an expression that is not a smooth function of the allowed symbols."""
    for value in _NOT_FINITE:
        if expression.has(value):
            raise ModelError(f"{where}: {expression} contains {value}; give a finite real expression")
    for term in sorted(expression.atoms(*_NOT_SMOOTH), key=str):
        raise ModelError(
            f"{where}: {term} is not smooth, so it has no Lie derivatives; "
            "use a smooth approximation, or keep the switching outside the system"
        )
    for term in sorted(expression.atoms(*_NOT_EXPLICIT), key=str):
        raise ModelError(f"{where}: {term} is not an explicit function of symbols; write it out with sympy.Symbol")
    _check_symbols(expression, where, set(allowed), set(inputs), set(disturbances))
    real = expression.xreplace(
        {one: sp.Dummy(one.name, real=True) for one in expression.free_symbols if not one.is_real}
    )
    for term in sp.preorder_traversal(real):
        if not isinstance(term, _ELEMENTARY):
            raise ModelError(
                f"{where}: {term} is not an elementary function that is smooth in real variables; write it with exp, "
                "log, powers, trigonometric and hyperbolic functions"
            )
        if term.is_real is False:
            raise ModelError(f"{where}: {term} is not real for real values of its symbols; check its sign")


def _check_symbols(
    expression: sp.Expr, where: str, allowed: set[sp.Symbol], inputs: set[sp.Symbol], disturbances: set[sp.Symbol]
) -> None:
    known = {symbol.name for symbol in allowed}
    for symbol in sorted(expression.free_symbols - allowed, key=str):
        if symbol in inputs:
            remedy = (
                "the system must be affine in its inputs: x' = drift + input_matrix u, y = h(x); "
                "move the coefficient into input_matrix, or make the input a state driven by a new input"
            )
            raise ModelError(f"{where}: the input {symbol} occurs in {expression}; {remedy}")
        if symbol in disturbances:
            raise ModelError(
                f"{where}: the disturbance {symbol} occurs in {expression}; "
                "disturbances enter only through their vector fields: disturbances={symbol: field}"
            )
        if symbol.name in known:
            raise ModelError(
                f"{where}: {symbol} in {expression} has other assumptions than the declared {symbol.name}; "
                "use one and the same Symbol object"
            )
        raise ModelError(
            f"{where}: the symbol {symbol} in {expression} is unknown; declare it as a state or a parameter"
        )
