"""Sliding-mode outer loop of the paper, (20)-(23), with its reaching laws and switching functions."""

from __future__ import annotations

from collections.abc import Sequence

from numpy.typing import ArrayLike

from brunovsky.blocks.block import Block
from brunovsky.blocks.library.chains import ROBOT_CHAINS, Chains
from brunovsky.blocks.library.outer_loops.reaching import Reaching, ReachingLaw
from brunovsky.blocks.library.outer_loops.surface import (
    sliding_outputs,
    sliding_variables,
    surface_checks,
    surface_gains,
    surface_law,
)
from brunovsky.blocks.library.outer_loops.switching import (
    Switching,
    SwitchingFunction,
    bound_checks,
    bound_of,
    with_sound_defaults,
)
from brunovsky.errors import ModelError


def sliding_mode(
    chains: Chains | Block = ROBOT_CHAINS,
    surface: Sequence[ArrayLike] | None = None,
    *,
    Q: ArrayLike | None = None,
    P: ArrayLike = 2.5,
    phi: ArrayLike | None = None,
    reaching: ReachingLaw = "exponential",
    switching: SwitchingFunction = "saturation",
    exponent: ArrayLike | None = None,
    disturbance: ArrayLike | None = None,
) -> Block:
    """Sliding-mode law v_i = (S_i' - c_1 e_i2 - ... - c_(r-1) e_ir)/c_r + y_d^(r), S_i = C e_i, S_i' as wanted.

    With f(S) = sat(S/phi), sign(S) or tanh(S/phi), S' is, by the *reaching law*,

    * -Q S - P f(S), ``"exponential"``: (22) of the paper with sign replaced by a saturation. ``P = 0`` leaves pole
      placement at the roots of c_r s^(r-1) + ... + c_1 and at -Q;
    * -P f(S), ``"constant rate"``: far from the surface no faster than P;
    * -Q S - P abs(S)^a f(S), 0 < a < 1, ``"power rate"``, abs(S) in the unit of S: slower as S vanishes, so that there
      is little chatter, but a matched disturbance D moves S to (c_r D/P)^(1/a), less what phi adds, instead of being
      rejected. Near zero abs(S)^a is (S^2 + phi^2 + 1e-24)^(a/2), without phi under ``"sign"``: the rate is right
      within the factor (1 + (phi/S)^2)^(a/2) for abs(S) > phi, and P phi^(a-1) S to 2^(a/2) P phi^(a-1) S within.

    Conditions: motion on the surface is stable (the roots above in the left half plane; chains of one integrator have
    none), c_r != 0, and P above abs(c_r) times the disturbance at the level of v (``disturbance``), which is checked
    where one is stated. Disturbances below that level, unmatched, leave
    :func:`brunovsky.analysis.unmatched_residual`. The sign function (``"sign"``, or saturation with ``phi = 0``) is
    sampled once a step in co-simulation and refused in model exchange, where it has no end of events. A layer is stiff:
    within it S decays at Q + P/phi, and fixed steps must stay below 2.5 over that; beyond, results are wrong, and
    without an error where a disturbance keeps S in motion.

    Parameters
    ----------
    chains : Chains or Block
        The chains, or the linearised plant that has them; the robot's by default.
    surface : sequence of float, or one sequence per chain
        C = (c_1, ..., c_r) in 1/s^(r-1), ..., 1: :func:`brunovsky.analysis.surface_from_poles` gives it for poles,
        :func:`brunovsky.analysis.surface_from_cost` for a quadratic cost. The default, for the robot's chains alone,
        is the paper's.
    Q, P, phi : float, or one per chain
        Gain of the exponential part (1/s; by default 5, with the power rate 0, with the constant rate there is none),
        gain of the switching part (unit of S per s), half-width of the boundary layer (unit of S, that of the output's
        derivative r - 1; by default 0.05, under ``"sign"`` there is none).
    reaching : {"exponential", "constant rate", "power rate"}
        The reaching law.
    switching : {"saturation", "sign", "tanh"}
        f.
    exponent : float, or one per chain, optional
        a of the power rate, by default 0.5.
    disturbance : float, or one per chain, optional
        Stated bound D of the disturbance at the level of v (unit of v).

    Returns
    -------
    Block
        Inputs those of :class:`Chains`, outputs ``v[i]`` and ``S[i]``; parameters ``C[k]``, ``Q``, ``P``, ``phi``,
        ``exponent``, ``D``, those that there are, or ``Ci[k]``, ``Q[i]``, ... where chains differ.

    Raises
    ------
    ModelError
        If the numbers do not fit the chains, an option is unknown, or options exclude each other.
    ParameterError
        If a condition does not hold; the message names poles or gains, and the remedy.

    References
    ----------
    The paper's (20)-(23); reaching laws: W. Gao and J. C. Hung, "Variable structure control of nonlinear systems: a new
    approach", IEEE Trans. Ind. Electron. 40(1), 45-55, 1993, doi:10.1109/41.184820; boundary layer: J.-J. E. Slotine
    and S. S. Sastry, "Tracking control of non-linear systems using sliding surfaces, with application to robot
    manipulators", Int. J. Control 38(2), 465-492, 1983, doi:10.1080/00207178308933088.
    """
    chains = Chains.of(chains)
    if reaching == "power rate" and disturbance is not None:
        raise ModelError(
            "sliding_mode: no P makes the power rate reject a disturbance, its rate vanishes with S; leave "
            "`disturbance` out, or choose reaching='exponential' or 'constant rate'"
        )
    c = surface_gains(chains, surface, "sliding_mode")
    part = Switching.of(chains, switching, P, phi)
    wanted = Reaching.of(chains, reaching, Q, exponent, part)
    bound = bound_of(chains, disturbance)
    variables = sliding_variables(chains, c)
    law = {i: surface_law(chains, i, c[i], wanted.rate(i, s)) for i, s in variables.items()}
    usual = (reaching, switching) == ("exponential", "saturation")
    return with_sound_defaults(
        Block(
            "sliding_mode",
            "sliding-mode outer loop with " + ("a boundary layer" if usual else f"{reaching} reaching and {switching}"),
            inputs=chains.inputs,
            parameters=(*c.parameters, *wanted.parameters, *(bound.parameters if bound else ())),
            outputs=(*chains.outer_inputs(law), *sliding_outputs(chains, variables)),
            checks=(
                *surface_checks(c),
                *wanted.checks,
                *bound_checks(part.gain, bound, {i: c.rows[i - 1][-1] for i in chains.numbers}),
            ),
        )
    )
