"""fmu-manipulation-toolbox: python run_container.py robot.ssp figure6.fmu makes one FMU of three.

The container, FMI 2 co-simulation, leaves out the parameter sets, so that it is told the start of figure 6.
"""

import json
import subprocess
import sys
from pathlib import Path

ssp, fmu = (Path(one).resolve() for one in sys.argv[1:])
make = [sys.executable, "-m", "fmu_manipulation_toolbox.cli.fmucontainer", "-fmu-directory", ".", "-container"]
subprocess.run([*make, f"{ssp.name}:0.001", "-dump-json"], cwd=ssp.parent, check=True)
description = json.loads((ssp.parent / f"{ssp.stem}-dump.json").read_text())
robot = next(one for one in description["fmu"] if one.endswith("linearized_robot.fmu"))
description |= {"name": fmu.name, "start": [[robot, "x_start", 2.5], [robot, "eta_start[1]", 0.5]]}
(ssp.parent / "container.json").write_text(json.dumps(description))
subprocess.run([*make, "container.json"], cwd=ssp.parent, check=True)
