"""Run the coupling study; write comparisons/coupling.md and docs/_static/coupling.svg. It takes a minute or two."""

from __future__ import annotations

import math
from pathlib import Path

from matplotlib import pyplot

from brunovsky import analysis
from brunovsky.analysis import CouplingError
from brunovsky.fmi import robot_system, robot_variants

SUMMARY = Path(__file__).parents[1] / "comparisons" / "coupling.md"
FIGURE = Path(__file__).parent / "_static" / "coupling.svg"
STEPS = (1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 4e-3, 8e-3, 12e-3, 20e-3, 40e-3)
DURATION, STEP_SIZE, ORDERS = 1.0, 1e-4, (0, 1)
LAWS = {"pole placement (P = 0)": 0.0, "sliding mode (P = 2.5 m/s³, φ = 0.05 m/s²)": 2.5}
SCHEMES = {"jacobi": "all at once", "gauss_seidel": "in sequence"}
SMALL = 2e-3
"""Steps up to which the measured order is that of convergence, s."""


def main() -> None:
    """Measure, and write."""
    gains = [
        analysis.sliding_gain([500.0, 10.0, 1.0], 5.0),
        analysis.boundary_layer_gain([500.0, 10.0, 1.0], 5.0, 2.5, 0.05),
    ]
    lines = [
        "# Coupling error of the robot as three FMUs",
        "",
        f"Figure 6 of the paper from outside, {DURATION:g} s: `circle`, `sliding_mode`, `linearized_robot` coupled at",
        "communication points, against the same loop as one system (Dormand-Prince, tolerance 1e-11). The error is the",
        f"largest distance of the positions over all communication points; internal steps of {1e3 * STEP_SIZE:g} ms.",
        "Theory, bound and figures: the page on coupling in the documentation. Written by `docs/refresh_coupling.py`.",
        "",
        "## Limits of the communication step",
        "",
        "Where an eigenvalue of the coupled step of chain and outer loop reaches the unit circle, in ms.",
        "",
        "| scheme | derivatives | P = 0, and outside the layer | within the layer |",
        "| --- | ---: | ---: | ---: |",
    ]
    for scheme, title in SCHEMES.items():
        for order in range(4):
            limits = (1e3 * analysis.largest_communication_step(gain, scheme, order) for gain in gains)
            lines.append(f"| {title} | {order} | {' | '.join(f'{one:.2f}' for one in limits)} |")
    for law, gain in LAWS.items():
        errors = analysis.coupling_errors(
            robot_system(),
            DURATION,
            STEPS,
            orders=ORDERS,
            step_size=STEP_SIZE,
            parameters={**robot_variants()[0].parameters, "P": gain},
        )
        if gain == 0.0:
            _draw(errors, gains[0])
        lines += ["", f"## {law[0].upper()}{law[1:]}", "", *_table(errors)]
    SUMMARY.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _table(errors: tuple[CouplingError, ...]) -> list[str]:
    columns = [(scheme, order) for scheme in SCHEMES for order in ORDERS]
    groups = [[one for one in errors if (one.scheme, one.order) == column] for column in columns]
    titles = [f"{SCHEMES[scheme]}, {order} derivative{'s' * (order != 1)}" for scheme, order in columns]
    rows = [["step, ms", *titles], ["---:"] * (1 + len(columns))]
    rows += [[f"{1e3 * step:g}", *(_distance(group[row].error) for group in groups)] for row, step in enumerate(STEPS)]
    orders = (analysis.measured_order(group, SMALL) for group in groups)
    rows.append([f"order, to {1e3 * SMALL:g} ms", *(f"{one:.2f}" for one in orders)])
    return [f"| {' | '.join(row)} |" for row in rows]


def _distance(error: float) -> str:
    return f"{error:.3g} m" if math.isfinite(error) else "fails"


def _draw(errors: tuple[CouplingError, ...], gain: object) -> None:
    limits = {
        f"limit {title}, inputs held": analysis.largest_communication_step(gain, scheme)
        for scheme, title in SCHEMES.items()
    }
    stable = [one for one in errors if one.error < 1.0]
    with pyplot.rc_context(
        {"svg.hashsalt": "brunovsky", "svg.fonttype": "path", "axes.grid": True, "grid.alpha": 0.35}
    ):
        drawn = analysis.coupling_error_plot(stable, limits=limits)
        drawn.figure.savefig(FIGURE, metadata={"Date": None})


if __name__ == "__main__":
    main()
