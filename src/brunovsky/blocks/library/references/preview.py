"""A reference that is known one sampling period ahead."""

from __future__ import annotations

import re

import sympy as sp

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.outer_loops.sampled_law import sampling_period
from brunovsky.blocks.variables import TIME, Output, Relation
from brunovsky.errors import ModelError

_ELEMENT = re.compile(r"(Z[1-9]\d*d)(\[[1-9]\d*\])")


def preview(reference: Block, period: float = 0.01) -> Block:
    """The same reference with outputs ``Zid_next[k]`` beside its ``Zid[k]``: their values one sampling period ahead.

    For sampled outer loops made with ``preview=True``; :func:`closed_loop` gives the two blocks one
    ``sampling_period``. It works where the reference is a function of time and parameters, known in advance.

    Parameters
    ----------
    reference : Block
        A reference without inputs, states, samples and modes, as :func:`circle` and :func:`set_point` are.
    period : float
        Default of the fixed parameter ``sampling_period``, s, the one of the outer loop.

    Returns
    -------
    Block
        With the outputs of the reference and ``Zid_next[k]``, and the additional parameter ``sampling_period``.

    Raises
    ------
    ModelError
        If the reference is not a function of time, or has no ``Zid[k]``.
    ParameterError
        If the period is not positive.
    """
    check_timed(reference, "preview")
    parameter = sampling_period(period, "preview")
    later: dict[sp.Basic, sp.Basic] = {TIME: TIME + parameter.symbol}
    shifted = []
    for one in reference.relations:
        shifted.append(Relation(f"{one.name}_next", one.expression.xreplace(later)))
        later[one.symbol] = shifted[-1].symbol
    ahead = [
        Output(f"{match[1]}_next{match[2]}", one.unit, f"{one.description}, one sampling period ahead",
               one.expression.xreplace(later))
        for one in reference.outputs
        if (match := _ELEMENT.fullmatch(one.name))
    ]  # fmt: skip
    if not ahead:
        raise ModelError(f"{reference.name} has no outputs Z1d[1], …; give a reference such as circle()")
    return Block(
        reference.name,
        f"{reference.description}, known one sampling period ahead",
        parameters=(*reference.parameters, parameter),
        outputs=(*reference.outputs, *ahead),
        relations=(*reference.relations, *shifted),
        checks=reference.checks,
    )


def check_timed(reference: Block, taker: str) -> None:
    """Refuse what is no reference known in advance.

    Raises
    ------
    ModelError
        If it is no block, or has inputs, states, samples or modes.
    """
    if not isinstance(reference, Block):
        raise ModelError(f"{taker} takes a Block, not {reference!r}; give a reference such as circle()")
    memory = [kind for kind in ("inputs", "states", "samples", "modes") if getattr(reference, kind)]
    if memory:
        raise ModelError(
            f"{reference.name} has {' and '.join(memory)}, so that its values to come are not known; {taker} takes "
            "references that are functions of time"
        )
