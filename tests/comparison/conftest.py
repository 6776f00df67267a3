"""The paper's study, run once natively for all tests of this folder."""

from pathlib import Path

import pytest

from brunovsky._resources import resource
from brunovsky.comparison import (
    Analysis,
    Comparison,
    ReportFiles,
    Study,
    analyze_study,
    load_study,
    run_study,
    write_report,
)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests of the paper's runs and report go to one worker, so that these are made once (``--dist loadgroup``)."""
    for one in items:
        if {"paper_runs", "written"} & set(getattr(one, "fixturenames", ())):
            one.add_marker(pytest.mark.xdist_group("paper"))


@pytest.fixture(scope="session")
def paper() -> Study:
    return load_study(resource("comparisons", "paper.toml"))


@pytest.fixture(scope="session")
def paper_runs(paper: Study) -> Comparison:
    return run_study(paper, engine="native")


@pytest.fixture(scope="session")
def written(paper_runs: Comparison, tmp_path_factory: pytest.TempPathFactory) -> ReportFiles:
    return write_report(paper_runs, tmp_path_factory.mktemp("paper"))


SMALL = """
name = "small"
title = "A small study"
engine = "native"

[parameters]
eta_min_m_per_s = 0.05

[[laws]]
name = "linear"
kind = "linear"

[[laws]]
name = "relay"
kind = "sign"
parameters = { P_m_per_s3 = 2.5 }

[[scenarios]]
name = "circle"
title = "Circle"
duration_s = 3.0
[scenarios.parameters]
x_start_m = 1.0
eta_start_1_m_per_s = 0.5
"""


@pytest.fixture
def small(tmp_path: Path) -> Path:
    path = tmp_path / "small.toml"
    path.write_text(SMALL, encoding="utf-8")
    return path


@pytest.fixture
def failing() -> str:
    """Scenarios for the small study that fail: from rest at the singularity, and by gains that do not stabilise."""
    return FAILING


FAILING = """
[[scenarios]]
name = "rest"
title = "From rest, under the printed law"
duration_s = 1.0
[scenarios.parameters]
eta_min_m_per_s = 0.0
eta_start_1_m_per_s = 0.0

[[scenarios]]
name = "away"
title = "Under gains that do not stabilise"
duration_s = 100.0
laws = ["linear"]
[scenarios.parameters]
Q_per_s = -20.0
"""

CHATTER = """
name = "mine"
title = "A study with chatter"
engine = "native"

[[laws]]
name = "relay"
kind = "sign"
parameters = { P_m_per_s3 = 2.5 }

[[laws]]
name = "layer"
kind = "saturation"
parameters = { P_m_per_s3 = 2.5, phi_m_per_s2 = 0.05 }

[[scenarios]]
name = "circle"
title = "Circle"
duration_s = 3.0

[[chatter]]
title = "two lags"
lags_s = [[0.005, 0.005], [0.009, 0.009], [0.02, 0.02]]

[[chatter]]
title = "others"
law = "layer"
lags_s = [[], [0.005], [0.003, 0.007]]
delay_s = [0.0, 0.002]
parameters = { Q_per_s = [2.0, 5], phi_m_per_s2 = 0.0 }
"""


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    path = tmp_path / "mine.toml"
    path.write_text(CHATTER, encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def chatter_analysis(tmp_path_factory: pytest.TempPathFactory) -> Analysis:
    path = tmp_path_factory.mktemp("study") / "mine.toml"
    path.write_text(CHATTER, encoding="utf-8")
    return analyze_study(path)
