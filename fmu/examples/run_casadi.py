"""CasADi: python run_casadi.py closed_loop.fmu, model exchange of FMI 2 or 3.

It handles no events, so P = 0 takes out the law's switching; and it does not know the initial state.
"""

import sys
import tempfile
from zipfile import ZipFile

import casadi as ca

with tempfile.TemporaryDirectory() as folder:
    ZipFile(sys.argv[1]).extractall(folder)
    dae = ca.DaeBuilder("loop", folder)
    dae.set("P", 0.0)
    rates = dae.create("rates", ["t", "x", "u"], ["ode"])
    t, x, u = rates.mx_in()
    problem = {"t": t, "x": x, "u": u, "ode": rates(t, x, u)}
    solve = ca.integrator("solve", "cvodes", problem, 0.0, 1.0, {"abstol": 1e-10, "reltol": 1e-10})
    initial = {"x": 2.5, "eta[1]": 0.5}
    end = solve(x0=[initial.get(name, 0.0) for name in dae.x()])["xf"]
    print(*(float(end[dae.x().index(name)]) for name in ("x", "y")))
