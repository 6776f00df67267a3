"""What ``brunovsky build`` writes, twice: with other hashes, and a folder and an empty cache of its own each time."""

import io
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from brunovsky.fmi import shipped_fmus
from brunovsky.native import compiler

pytestmark = pytest.mark.slow
needs_zig = pytest.mark.skipif(not compiler.has_ziglang(), reason="ziglang is not installed (extra zig)")


def contents(path: Path) -> dict[str, bytes]:
    """Every file in an archive by its path, those of archives within it too."""
    found = {}
    with zipfile.ZipFile(path) as archive:
        for name in archive.namelist():
            data = archive.read(name)
            found[name] = data
            if name.endswith(".fmu"):
                with zipfile.ZipFile(io.BytesIO(data)) as inner:
                    found |= {f"{name}/{one}": inner.read(one) for one in inner.namelist()}
    return found


@pytest.mark.parametrize("ssp", ["1", "2"])
@pytest.mark.parametrize("platform", ["host", pytest.param("all", marks=needs_zig)])
def test_every_file_is_the_same_on_a_second_build(platform: str, ssp: str, tmp_path: Path) -> None:
    built = []
    for seed in ("1", "2"):
        folder = tmp_path / seed
        folder.mkdir()
        environment = {"PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(sys.path)}
        environment |= {"BRUNOVSKY_CACHE": str(folder / "cache")}  # compiled again
        command = [sys.executable, "-m", "brunovsky", "build", "-o", "built", "--platform", platform, "--ssp", ssp]
        subprocess.run(command, check=True, env=os.environ | environment, cwd=folder, capture_output=True)
        built.append({path.relative_to(folder): path for path in (folder / "built").rglob("*") if path.is_file()})
    first, second = built
    assert len(first) == 1 + sum(len(shipped_fmus(version)) for version in (2, 3))
    assert set(first) == set(second)
    for name, path in first.items():
        one, other = contents(path), contents(second[name])
        assert [entry for entry in one if one[entry] != other.get(entry)] == [], name
        assert list(one) == list(other)
        assert path.read_bytes() == second[name].read_bytes()
