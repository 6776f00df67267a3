"""libcosim by libcosimpy: python run_libcosim.py closed_loop.fmu, co-simulation of FMI 2."""

import sys

from libcosimpy.CosimEnums import CosimVariableType
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

log_output_level(CosimLogLevel.ERROR)
execution = CosimExecution.from_step_size(step_size=1e6)  # in ns
robot = execution.add_local_slave(CosimLocalSlave(fmu_path=sys.argv[1], instance_name="robot"))
observer = CosimObserver.create_last_value()
execution.add_observer(observer)
if not execution.step(step_count=1000):
    sys.exit("a step failed")
reals = [one for one in execution.slave_variables(robot) if one.type == CosimVariableType.REAL.value]
number = {one.name.decode(): one.reference for one in reals}
print(*observer.last_real_values(robot, [number["x"], number["y"]]))
