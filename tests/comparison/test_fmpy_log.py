"""A comparison leaves fmpy as it was for whoever uses it next in the same process."""

import subprocess
import sys

AFTER_A_COMPARISON = """
import gc, sys
from pathlib import Path
import fmpy
import brunovsky as br
from brunovsky.comparison.engines import opened_fmus
from brunovsky.comparison.study import Loop, PlannedRun

loop = Path(sys.argv[1], "loop.fmu")
br.export_fmu(br.blocks.closed_loop(), loop)
with opened_fmus({Loop(): loop}) as engine:
    for start, status in ((0.0, "singular"), (0.5, "ok")):
        values = {"eta_min": 0.0, "eta_start[1]": start}
        outcome = engine.run(PlannedRun("a/b", "a", "b", 0.01, 1e-3, values, {}))
        assert outcome.status.state == status, outcome.status
        assert start or "singular at eta[1] = 0" in outcome.status.message, outcome.status
gc.collect()
for _ in range(20):
    try:
        fmpy.simulate_fmu(str(loop), fmi_type="ModelExchange", stop_time=0.01, start_values={"phi": 0.0})
    except fmpy.fmi1.FMICallException:
        continue
    raise SystemExit("model exchange was not refused")
print("still here")
"""


def test_a_later_instance_of_fmpy_can_log_an_error(tmp_path):
    """With fmpy's own way to a logger its proxy would call one that is gone, and end the process."""
    done = subprocess.run(
        [sys.executable, "-c", AFTER_A_COMPARISON, str(tmp_path)], capture_output=True, text=True, timeout=200
    )
    assert done.returncode == 0, (done.returncode, done.stderr[-2000:])
    assert done.stdout.endswith("still here\n")
