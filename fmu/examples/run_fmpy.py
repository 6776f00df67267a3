"""fmpy: python run_fmpy.py closed_loop.fmu [ModelExchange], FMI 2 or 3."""

import sys

import fmpy

fmu, *interface = sys.argv[1:]
result = fmpy.simulate_fmu(
    fmu,
    fmi_type=interface[0] if interface else "CoSimulation",
    stop_time=1.0,
    output_interval=1e-3,
    relative_tolerance=1e-10,  # of the master's solver, in model exchange
    output=["x", "y"],
)
print(*map(float, result[["x", "y"]][-1]))
