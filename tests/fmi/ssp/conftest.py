"""The package that ships, in both versions."""

from pathlib import Path

import pytest

from brunovsky.fmi.ssp import export_ssp, robot_system, robot_variants


@pytest.fixture(scope="session", params=[1, 2])
def robot_ssp(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("ssp") / f"robot{request.param}.ssp"
    return export_ssp(
        robot_system(), path, ssp_version=request.param, variants=robot_variants(), system_connectors=False
    )
