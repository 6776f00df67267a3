"""When a sliding surface is reached, and how a relay with hysteresis cycles about it: closed forms for one chain."""

from dataclasses import dataclass

import numpy as np

from brunovsky.analysis._checks import finite_scalar
from brunovsky.errors import ParameterError

_TINY = 1e-16  # below, ln(1 + x)/x is 1 to rounding


def reaching_time(initial: float, reaching_rate: float, switching_gain: float, exponent: float = 0.0) -> float:
    """Time in which S' = -Q S - P abs(S)^a sign(S) brings S from S0 to zero: ln(1 + Q abs(S0)^(1-a)/P) / (Q (1-a)).

    a = 0 is the exponential reaching law of the paper, with Q = 0 the constant rate. With a matched disturbance
    abs(d) <= D < P/abs(cn) and a = 0, the same with P - abs(cn) D in place of P is an upper bound.

    Parameters
    ----------
    initial : float
        S0 (m/s2 for n = 3), of either sign.
    reaching_rate, switching_gain : float
        Q >= 0 (1/s) and P >= 0 (m/s3 for n = 3). Q = 0 gives abs(S0)^(1-a)/(P (1-a)); P = 0 gives inf (S only tends to
        zero).
    exponent : float
        a of the power rate, 0 <= a < 1, with abs(S) in its unit.

    Returns
    -------
    float
        Reaching time (s); 0 for S0 = 0.

    Raises
    ------
    ParameterError
        If a number is not finite or out of its range.

    References
    ----------
    The paper's eq. (22); W. Gao and J. C. Hung, "Variable structure control of nonlinear systems: a new approach",
    IEEE Trans. Ind. Electron. 40(1), 45-55, 1993, doi:10.1109/41.184820.
    """
    where = "reaching_time"
    S0 = abs(finite_scalar(initial, "initial", where))
    Q = finite_scalar(reaching_rate, "Q", where, minimum=0.0)
    P = finite_scalar(switching_gain, "P", where, minimum=0.0)
    a = finite_scalar(exponent, "exponent", where, minimum=0.0)
    if a >= 1.0:
        raise ParameterError(f"{where}: exponent = {a:g}; from 1 on S only tends to zero, pass 0 <= exponent < 1")
    if S0 == 0.0:
        return 0.0
    if P == 0.0:
        return float("inf")
    powered = S0 ** (1.0 - a) / P
    slowed = Q * powered
    return float(powered * (np.log1p(slowed) / slowed if slowed > _TINY else 1.0) / (1.0 - a))


@dataclass(frozen=True)
class RelayCycle:
    """Cycle of S under a relay; see `relay_cycle`.

    Attributes
    ----------
    amplitude : float
        Half of the distance between the extremes of S, in its unit.
    period : float
        Period, s.
    """

    amplitude: float
    period: float


def relay_cycle(
    switching_gain: float, hysteresis: float, *, reaching_rate: float = 0.0, dwell: float = 0.0
) -> RelayCycle:
    """Cycle of S' = -Q S - P relay without disturbance, the relay with hysteresis h and minimum dwell time.

    From h to -h S takes ln((P + Q h)/(P - Q h))/Q, for Q = 0 2 h/P. Where that is shorter than the dwell time, this is
    the half-period, and the amplitude (P/Q) tanh(Q dwell/2), for Q = 0 P dwell/2. For Q = 0 the cycle keeps the offset
    with which it began, else it becomes symmetric at the rate Q.

    Parameters
    ----------
    switching_gain : float
        P > 0 (unit of S per s).
    hysteresis : float
        h >= 0, the half-width (unit of S).
    reaching_rate : float
        Q >= 0 (1/s).
    dwell : float
        Minimum dwell time (s), >= 0; one of `hysteresis` and `dwell` is positive.

    Returns
    -------
    RelayCycle
        Amplitude and period. With fixed steps each switch is seen up to a step late.

    Raises
    ------
    ParameterError
        If a number is not finite or out of its range; if P <= Q h, where S comes to rest within the hysteresis.

    References
    ----------
    The paper's eq. (22) with a relay; Y. Z. Tsypkin, *Relay Control Systems*, Cambridge University Press, 1984.
    """
    where = "relay_cycle"
    P = finite_scalar(switching_gain, "P", where, minimum=0.0, strict=True)
    h = finite_scalar(hysteresis, "hysteresis", where, minimum=0.0)
    Q = finite_scalar(reaching_rate, "Q", where, minimum=0.0)
    rest = finite_scalar(dwell, "dwell", where, minimum=0.0)
    if h == 0.0 and rest == 0.0:
        raise ParameterError(f"{where}: without hysteresis and dwell time the period is zero; pass one of them > 0")
    if Q * h >= P:
        raise ParameterError(
            f"{where}: P = {P:g} does not exceed Q hysteresis = {Q * h:g}, so that S comes to rest before the relay "
            "switches: there is no cycle; pass a larger P or a smaller hysteresis"
        )
    slowed = Q * h / P
    free = 2.0 * h / P * (np.arctanh(slowed) / slowed if slowed > _TINY else 1.0)
    if free >= rest:
        return RelayCycle(h, float(2.0 * free))
    slowed = Q * rest / 2.0
    return RelayCycle(float(P * rest / 2.0 * (np.tanh(slowed) / slowed if slowed > _TINY else 1.0)), 2.0 * rest)
