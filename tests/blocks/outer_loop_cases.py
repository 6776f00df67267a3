"""Every outer loop, for the robot and for one chain of three integrators, and the chain with its reference."""

from collections.abc import Callable
from functools import cache

import numpy as np
import sympy as sp

import brunovsky as br
from brunovsky import analysis
from brunovsky.blocks import TIME, Chains, Parameter

B = br.blocks
SURFACE = analysis.surface_from_poles([-5.0, -5.0])

LOOPS: dict[str, Callable[[br.Block], br.Block]] = {
    "poles": lambda plant: B.pole_placement(plant, analysis.place([-4.0, -5.0, -6.0])),
    "poles, integral": lambda plant: B.pole_placement(plant, analysis.place([-4.0, -5.0, -6.0, -7.0]), integral=True),
    "LQR": lambda plant: B.pole_placement(plant, analysis.lqr_gain(3, [1e5, 1e3, 1.0])),
    "LQR, integral": lambda plant: B.pole_placement(
        plant, analysis.lqr_gain(3, [1e6, 1e5, 1e3, 1.0], integral=True), integral=True
    ),
    "sliding mode": lambda plant: B.sliding_mode(plant, SURFACE),
    "surface from cost": lambda plant: B.sliding_mode(plant, analysis.surface_from_cost([400.0, 20.0, 1.0])),
    "sign": lambda plant: B.sliding_mode(plant, SURFACE, switching="sign"),
    "tanh": lambda plant: B.sliding_mode(plant, SURFACE, switching="tanh"),
    "constant rate": lambda plant: B.sliding_mode(plant, SURFACE, reaching="constant rate", P=97.0, phi=0.5),
    "power rate": lambda plant: B.sliding_mode(plant, SURFACE, reaching="power rate", P=40.0),
    "power rate, sign": lambda plant: B.sliding_mode(plant, SURFACE, reaching="power rate", P=40.0, switching="sign"),
    "relay": lambda plant: B.sliding_mode_relay(plant, SURFACE, dwell=0.002),
    "integral sliding mode": lambda plant: B.integral_sliding_mode(plant, analysis.place([-4.0, -5.0, -6.0])),
    "disturbance observer": lambda plant: B.disturbance_observer(plant, analysis.place([-4.0, -5.0, -6.0])),
    "sampled, implicit": lambda plant: B.sliding_mode_sampled(plant, SURFACE),
    "sampled, explicit": lambda plant: B.sliding_mode_sampled(plant, SURFACE, scheme="explicit", surface_map="exact"),
    "sampled, on a clock": lambda plant: B.sliding_mode_clocked(plant, SURFACE),
    "super-twisting": lambda plant: B.super_twisting(plant, SURFACE),
    "super-twisting, sampled": lambda plant: B.super_twisting_sampled(plant, SURFACE),
}


@cache
def chain_plant() -> br.Block:
    """z''' = v + d in m/s3, with the disturbance as an input."""
    z, u, d = sp.symbols("z:3", real=True), sp.Symbol("u", real=True), sp.Symbol("d", real=True)
    system = br.AffineSystem(z, (u,), [z[1], z[2], 0], [0, 0, 1], (z[0],), disturbances={d: (0, 0, 1)})
    labels = {one: B.Variable(f"z{k}", unit) for k, (one, unit) in enumerate(zip(z, ("m", "m/s", "m/s2"), strict=True))}
    labels |= {u: B.Variable("u", "m/s3"), d: B.Variable("d", "m/s3")}
    return br.linearized_block(br.linearize(system), "chain", labels=labels)


@cache
def chain_reference() -> br.Block:
    """z_d = offset + amplitude sin(2 t), a set point for amplitude 0."""
    parameters = (Parameter("offset", "m", "offset", 1.0), Parameter("amplitude", "m", "amplitude", 0.0))
    offset, amplitude = (one.symbol for one in parameters)
    return br.Block(
        "wave", parameters=parameters, outputs=Chains((3,), ("m",)).reference([offset + amplitude * sp.sin(2 * TIME)])
    )


def chain_loop(law: br.Block) -> br.Diagram:
    return B.closed_loop(law, plant=chain_plant(), reference=chain_reference())


REGULATION = {
    "radius": 0.0, "center[1]": 5.0, "center[2]": 3.0, "x_start": 8.5, "y_start": 7.5, "theta_start": -3 * np.pi / 4,
    "eta_start[1]": 1.0,
}  # fmt: skip
"""Figure 5 of the paper, for the closed loop of the robot."""
