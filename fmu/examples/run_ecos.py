"""Ecos by ecospy: python run_ecos.py closed_loop.fmu, co-simulation of FMI 2 or 3."""

import sys

from ecospy import EcosSimulation, EcosSimulationStructure

with EcosSimulationStructure() as structure:
    structure.add_model("robot", sys.argv[1])
    with EcosSimulation(structure=structure, step_size=1e-3) as simulation:
        simulation.init()
        simulation.step(1000)
        print(simulation.get_real("robot::x"), simulation.get_real("robot::y"))
        simulation.terminate()
