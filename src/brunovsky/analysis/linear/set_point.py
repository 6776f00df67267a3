"""Closed-loop transfer functions of one chain under v = -K e: sensitivities, set-point response, gang of four."""

from typing import Any

import control
import numpy as np
from numpy.typing import ArrayLike, NDArray

from brunovsky.analysis._checks import finite_vector, stable_gain
from brunovsky.analysis.linear.robustness import loop_transfer


def sensitivity(gain: ArrayLike) -> control.TransferFunction:
    """Sensitivity of one chain, S = 1/(1 + L) = s^n / (s^n + kn s^(n-1) + ... + k1), cut at v.

    Parameters
    ----------
    gain : array_like, shape (n,)
        K = [k1, ..., kn] of v = -K e.

    Returns
    -------
    control.TransferFunction
        S, without unit: from an addition to v to what reaches the chain. Its peak Ms is `Margins.max_sensitivity`.

    Raises
    ------
    ParameterError
        If `gain` is not a flat list of finite real numbers, or all of it is zero.

    References
    ----------
    K. J. Åström and R. M. Murray, *Feedback Systems*, Princeton University Press, 2008, doi:10.1515/9781400828739.
    """
    loop = loop_transfer(gain)
    return control.tf(loop.den[0][0], _characteristic(gain), inputs=["v"], outputs=["v_total"], name="S")


def complementary_sensitivity(gain: ArrayLike) -> control.TransferFunction:
    """Complementary sensitivity of one chain, T = L/(1 + L), cut at v.

    Parameters
    ----------
    gain : array_like, shape (n,)
        K = [k1, ..., kn] of v = -K e.

    Returns
    -------
    control.TransferFunction
        T, without unit: from an addition to v to minus what the outer loop answers. The position follows a reference
        so, without feedforward of its n-th derivative but with the lower ones; `set_point_transfer` has none.

    Raises
    ------
    ParameterError
        If `gain` is not a flat list of finite real numbers, or all of it is zero.

    References
    ----------
    K. J. Åström and R. M. Murray, *Feedback Systems*, Princeton University Press, 2008, doi:10.1515/9781400828739.
    """
    loop = loop_transfer(gain)
    return control.tf(loop.num[0][0], _characteristic(gain), inputs=["v"], outputs=["v_return"], name="T")


def set_point_transfer(gain: ArrayLike) -> control.TransferFunction:
    """Position set point to position, k1 / (s^n + kn s^(n-1) + ... + k1).

    The outer loop acts on e = Z - [z_d, 0, ..., 0], as with the reference `circle` of radius 0: a set point has no
    derivatives to feed forward, and there is no zero that a step would excite.

    Parameters
    ----------
    gain : array_like, shape (n,)
        K = [k1, ..., kn] of v = -K e.

    Returns
    -------
    control.TransferFunction
        Input ``z_d``, output ``z`` (m each), for `control.step_response`, `control.bode_plot` and so on.

    Raises
    ------
    ParameterError
        If `gain` is not a flat list of finite real numbers, or all of it is zero.

    References
    ----------
    The paper's eq. (19) with v = -K e.
    """
    loop = loop_transfer(gain)
    return control.tf(loop.num[0][0][-1:], _characteristic(gain), inputs=["z_d"], outputs=["z"], name="set_point")


def bandwidth(gain: ArrayLike) -> float:
    """Bandwidth of `set_point_transfer`: the first frequency at which its gain is 3 dB below that of rest.

    Parameters
    ----------
    gain : array_like, shape (n,)
        K = [k1, ..., kn] of v = -K e.

    Returns
    -------
    float
        From `control.bandwidth`, in rad/s.

    Raises
    ------
    ParameterError
        If `gain` is not a flat list of finite real numbers or the closed loop is not stable.

    References
    ----------
    K. J. Åström and R. M. Murray, *Feedback Systems*, Princeton University Press, 2008, doi:10.1515/9781400828739.
    """
    return float(control.bandwidth(set_point_transfer(stable_gain(gain, "bandwidth"))))


def step_information(gain: ArrayLike) -> dict[str, Any]:
    """Rise time, overshoot, settling time and so on of the response to a step of the position set point.

    Parameters
    ----------
    gain : array_like, shape (n,)
        K = [k1, ..., kn] of v = -K e.

    Returns
    -------
    dict
        That of `control.step_info` for `set_point_transfer`: times in s (rise from 10 to 90 %, settling within 2 %),
        ``Overshoot`` and ``Undershoot`` in %, peaks and the steady state in units of the step. The times are found on a
        grid of 20,001 instants over ten time constants of the slowest pole.

    Raises
    ------
    ParameterError
        If `gain` is not a flat list of finite real numbers or the closed loop is not stable.

    References
    ----------
    K. J. Åström and R. M. Murray, *Feedback Systems*, Princeton University Press, 2008, doi:10.1515/9781400828739.
    """
    system = set_point_transfer(stable_gain(gain, "step_information"))
    slowest = float(np.min(-system.poles().real))
    found: dict[str, Any] = control.step_info(system, np.linspace(0.0, 10.0 / slowest, 20001))
    return found


def gang_of_four(gain: ArrayLike, **options: Any) -> control.FrequencyResponseData:
    """Frequency responses S, P S, C S and T of one chain, with P = 1/s^n and C = kn s^(n-1) + ... + k1.

    P S takes an addition to v to the position, T and C S an error of the position measurement to position and v. C is
    the state feedback as one that differentiates a position: C S grows as s^(n-1), which is what noise on a position
    costs whose derivatives are taken from it. Where the chain is computed from the model, each element has its own
    noise.

    Parameters
    ----------
    gain : array_like, shape (n,)
        K = [k1, ..., kn] of v = -K e.
    **options
        ``omega``, ``omega_limits``, ``omega_num``, ``Hz`` of `control.gangof4_response`.

    Returns
    -------
    control.FrequencyResponseData
        From `control.gangof4_response`: [[T, P S], [C S, S]]; its ``plot()`` draws the four gains over frequency.

    Raises
    ------
    ParameterError
        If `gain` is not a flat list of finite real numbers or the closed loop is not stable.

    References
    ----------
    K. J. Åström and R. M. Murray, *Feedback Systems*, Princeton University Press, 2008, doi:10.1515/9781400828739.
    """
    K = stable_gain(gain, "gang_of_four")
    plant = control.tf([1.0], np.concatenate(([1.0], np.zeros(K.size))), name="chain")
    return control.gangof4_response(plant, control.tf(K[::-1], [1.0], name="K"), **options)


def _characteristic(gain: ArrayLike) -> NDArray[np.float64]:
    return np.concatenate(([1.0], finite_vector(gain, "K", "loop_transfer")[::-1]))
