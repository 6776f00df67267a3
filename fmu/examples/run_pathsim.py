"""pathsim-fmi: python run_pathsim.py closed_loop.fmu, model exchange of FMI 2 or 3.

It reads every output as a Real, which the standard forbids for the Boolean `singular`, so that it is told what to read.
"""

import sys

from pathsim import Connection, Simulation
from pathsim.blocks import Scope
from pathsim.solvers import RKDP54
from pathsim_fmi import ModelExchangeFMU

robot = ModelExchangeFMU(sys.argv[1])
wrapper = robot.fmu_wrapper
wrapper.output_refs = {name: wrapper.output_refs[name] for name in ("x", "y")}
robot.inputs, robot.outputs = wrapper.create_port_registers()
scope = Scope(labels=["x", "y"])
wires = [Connection(robot["x"], scope[0]), Connection(robot["y"], scope[1])]
accuracy = {"Solver": RKDP54, "tolerance_lte_abs": 1e-10, "tolerance_lte_rel": 1e-10}
Simulation([robot, scope], wires, dt=1e-3, log=False, **accuracy).run(1.0)
print(*(float(one[-1]) for one in scope.read()[1]))
