"""fmuloader: python run_fmuloader.py closed_loop.fmu, co-simulation of FMI 2 or 3 by the calls of the standard."""

import sys
from xml.etree import ElementTree
from zipfile import ZipFile

from fmuloader.fmi2 import Fmi2Slave, Fmi2Type
from fmuloader.fmi3 import Fmi3Slave

root = ElementTree.fromstring(ZipFile(sys.argv[1]).read("modelDescription.xml"))
name = root.find("CoSimulation").get("modelIdentifier")
number = {one.get("name"): int(one.get("valueReference")) for one in root.find("ModelVariables")}
if root.get("fmiVersion").startswith("2"):
    robot = Fmi2Slave(sys.argv[1], model_identifier=name)
    robot.instantiate("robot", Fmi2Type.CO_SIMULATION, guid=root.get("guid"))
    robot.setup_experiment(start_time=0.0)
    robot.enter_initialization_mode()
else:
    robot = Fmi3Slave(sys.argv[1], model_identifier=name)
    robot.instantiate_co_simulation("robot", instantiation_token=root.get("instantiationToken"))
    robot.enter_initialization_mode(start_time=0.0)
robot.exit_initialization_mode()
for step in range(1000):
    robot.do_step(step * 1e-3, 1e-3)
read = robot.get_real if isinstance(robot, Fmi2Slave) else robot.get_float64
print(*read([number["x"], number["y"]]))
robot.terminate()
robot.free_instance()
