"""Names of the symbols that a linearisation adds: inputs of integrators (w), transformed (mu), outer inputs (v)."""

import itertools
import re
from collections.abc import Collection, Iterable

import sympy as sp


def integrator_input(delayed: sp.Symbol, taken: Collection[str]) -> sp.Symbol:
    """Symbol of the integrator's input: w with the delayed input's suffix (u1: w1, u_1: w_1, thrust: w).

    A name that is taken gets a counter: w1_2, w1_3, … The symbol is real if the delayed input is; a sign that is
    assumed of the delayed input is not assumed of its derivative.
    """
    stem = "w" + re.sub(r"^[^\W\d_]+", "", delayed.name)
    counted = re.fullmatch(r"(.+)_\d+", stem)
    if counted and counted[1] in taken:  # w1_2 is followed by w1_3
        stem = counted[1]
    names = itertools.chain((stem,), (f"{stem}_{count}" for count in itertools.count(2)))
    return _like((delayed,), next(name for name in names if name not in taken))


def outer_inputs(inputs: tuple[sp.Symbol, ...], count: int, taken: Collection[str]) -> tuple[sp.Symbol, ...]:
    """Symbols v1, …, v_count; nu1, … or nu2_1, … where one of those names is taken; real if all inputs are."""
    return numbered(
        itertools.chain(("v", "nu"), (f"nu{number}_" for number in itertools.count(2))), inputs, count, taken
    )


def transformed_inputs(inputs: tuple[sp.Symbol, ...], count: int, taken: Collection[str]) -> tuple[sp.Symbol, ...]:
    """Symbols mu1, …, mu_count; mu2_1, … where one of those names is taken; real if all inputs are."""
    return numbered(itertools.chain(("mu",), (f"mu{number}_" for number in itertools.count(2))), inputs, count, taken)


def numbered(
    stems: Iterable[str], like: tuple[sp.Symbol, ...], count: int, taken: Collection[str]
) -> tuple[sp.Symbol, ...]:
    """Symbols STEM1, …, STEM_count with the first stem of which no name is taken; real if all of `like` are."""
    candidates = ([f"{stem}{index}" for index in range(1, count + 1)] for stem in stems)
    names = next(names for names in candidates if not set(names) & set(taken))
    return tuple(_like(like, name) for name in names)


def rate(symbol: sp.Symbol, taken: Collection[str], order: int = 1) -> sp.Symbol:
    """Symbol of a derivative: d1_dot, d1_ddot, …, d1_dot_2 where that name is taken."""
    stem = f"{symbol.name}_{'d' * order}ot"
    names = itertools.chain((stem,), (f"{stem}_{count}" for count in itertools.count(2)))
    return _like((symbol,), next(name for name in names if name not in taken))


def _like(symbols: tuple[sp.Symbol, ...], name: str) -> sp.Symbol:
    return sp.Symbol(name, real=True) if all(symbol.is_real for symbol in symbols) else sp.Symbol(name)
