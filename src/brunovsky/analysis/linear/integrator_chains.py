"""Brunovsky chains, the linear plants that exact linearisation leaves, as python-control systems."""

from collections.abc import Sequence

import control
import numpy as np
from numpy.typing import ArrayLike

from brunovsky.analysis._checks import finite_vector
from brunovsky.errors import ParameterError


def chain(order: int = 3, *, name: str = "chain") -> control.StateSpace:
    """Brunovsky chain z^(n) = v, an n-fold integrator with its whole state as output.

    Parameters
    ----------
    order : int
        Number of integrators n >= 1.
    name : str
        Name of the system, as `control.interconnect` sees it.

    Returns
    -------
    control.StateSpace
        Input ``v`` (m/s3 for n = 3); states and outputs ``Z[1]``, ..., ``Z[n]``, where ``Z[k]`` is the
        (k-1)-th derivative of z (m, m/s, m/s2). A and the output matrix have shape (n, n), B (n, 1).

    Raises
    ------
    ParameterError
        If `order` is not a positive integer.

    References
    ----------
    The paper's eq. (17); P. Brunovský, "A classification of linear controllable systems", Kybernetika 6(3),
    173-188, 1970.
    """
    n = _order(order, "chain")
    labels = _labels("Z", n)
    return control.ss(
        np.eye(n, k=1), np.eye(n)[:, -1:], np.eye(n), 0, inputs=["v"], outputs=labels, states=labels, name=name
    )


def chains(orders: Sequence[int] = (3, 3), *, name: str = "chains") -> control.StateSpace:
    """Decoupled Brunovsky chains in one block-diagonal system.

    Parameters
    ----------
    orders : sequence of int, shape (m,)
        Order n_i >= 1 of each chain; ``(3, 3)`` is the flagship robot.
    name : str
        Name of the system.

    Returns
    -------
    control.StateSpace
        Inputs ``v[1]``, ..., ``v[m]``; states and outputs ``Zi[1]``, ..., ``Zi[n_i]`` of chain i = 1, ..., m,
        the variable names of the FMUs. A has shape (sum n_i, sum n_i), B (sum n_i, m).

    Raises
    ------
    ParameterError
        If there is no chain, or an order is not a positive integer.

    References
    ----------
    The paper's eq. (17), for both axes.
    """
    sizes = [_order(order, "chains") for order in orders]
    if not sizes:
        raise ParameterError("chains: orders is empty; give the order of each chain, such as (3, 3)")
    system = control.append(*(chain(n) for n in sizes))
    labels = [label for i, n in enumerate(sizes, start=1) for label in _labels(f"Z{i}", n)]
    return control.ss(system, inputs=_labels("v", len(sizes)), outputs=labels, states=labels, name=name)


def error_dynamics(gain: ArrayLike, *, name: str = "error_dynamics") -> control.StateSpace:
    """Error dynamics of one chain under linear feedback: e' = (A - b K) e + b w, from v = -K e + z_d^(n).

    Parameters
    ----------
    gain : array_like, shape (n,)
        K = [k1, ..., kn], in ascending order of derivative (1/s3, 1/s2, 1/s for n = 3).
    name : str
        Name of the system.

    Returns
    -------
    control.StateSpace
        Input ``w``, a matched disturbance at the level of v (m/s3 for n = 3); states and outputs
        ``e[1]``, ..., ``e[n]``, the tracking error z - z_d and its derivatives (m, m/s, m/s2).

    Raises
    ------
    ParameterError
        If `gain` is not a flat list of finite real numbers.

    References
    ----------
    The paper's eq. (19), with its pole-placement outer loop.
    """
    K = finite_vector(gain, "K", "error_dynamics")
    plant = chain(K.size)
    labels = _labels("e", K.size)
    return control.ss(
        plant.A - plant.B * K, plant.B, np.eye(K.size), 0, inputs=["w"], outputs=labels, states=labels, name=name
    )


def _labels(base: str, count: int) -> list[str]:
    return [f"{base}[{k}]" for k in range(1, count + 1)]


def _order(order: int, where: str) -> int:
    if isinstance(order, bool) or not isinstance(order, int | np.integer) or order < 1:
        raise ParameterError(f"{where}: order {order!r} of a chain is not a positive integer; pass 1, 2, 3, ...")
    return int(order)
