"""The motion that a chain would have without disturbances, as a state: what is compared with it starts at zero."""

from __future__ import annotations

from collections.abc import Mapping

import sympy as sp

from brunovsky.blocks.library.chains import Chains
from brunovsky.blocks.variables import Mode, State, Transition, symbol


def nominal_states(chains: Chains, law: Mapping[int, sp.Expr]) -> tuple[State, ...]:
    """States ``nominal[i]`` with nominal_i' = v_i of the law without disturbances."""
    return tuple(
        State(
            f"nominal[{i}]",
            chains.unit(i, chains.orders[i - 1] - 1),
            f"last element of chain {i} as it would be without disturbances",
            one,
        )
        for i, one in law.items()
    )


def deviations(chains: Chains) -> dict[int, sp.Expr]:
    """Last element of each chain less what it would be without disturbances: its derivative is v - nominal' + d."""
    return {i: symbol(f"Z{i}[{order}]") - symbol(f"nominal[{i}]") for i, order in enumerate(chains.orders, 1)}


STARTED = Mode("started", "1", "1 once the nominal motion has taken its start from the chains", start=0)


def start_transition(chains: Chains) -> Transition:
    """At the first event, that of initialisation, the nominal motion starts where the chains are."""
    elements = {symbol(f"nominal[{i}]"): symbol(f"Z{i}[{order}]") for i, order in enumerate(chains.orders, 1)}
    return Transition("start", sp.Eq(STARTED.symbol, 0), {**elements, STARTED.symbol: sp.S.One})
