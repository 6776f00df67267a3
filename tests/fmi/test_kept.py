"""FMUs kept in the cache: found again for equal arguments alone, and never damaged or of other code."""

import dataclasses
import hashlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import sympy as sp

import brunovsky
from brunovsky._resources import resource
from brunovsky._sources import loaded_digest
from brunovsky.blocks import Block, Output, library, symbols
from brunovsky.blocks.digest import block_digest
from brunovsky.errors import BrunovskyError, ModelError
from brunovsky.fmi import archive, export_fmu, kept
from brunovsky.fmi.archive import export_fmus
from brunovsky.fmi.contents import fmu_files, portable_files
from brunovsky.native.compiler import cache_folder

LONG_AGO = 0.0
LATER = 4e9
"""Times before and after the files of any test, s."""


def fresh_cache(folder: Path) -> Path:
    """Cache in a folder with the object files of all tests, which take long to compile, and no FMUs."""
    objects = cache_folder() / "objects"
    objects.mkdir(parents=True, exist_ok=True)
    fresh = folder / "cache"
    fresh.mkdir()
    (fresh / "objects").symlink_to(objects)
    return fresh


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Folder of kept FMUs, empty; the sources count as those that run, however young they are."""
    monkeypatch.setenv("BRUNOVSKY_CACHE", str(fresh_cache(tmp_path)))
    digest = loaded_digest(Path(brunovsky.__file__).parent, LATER)
    monkeypatch.setattr(kept, "package_digest", lambda: digest)
    return tmp_path / "cache" / "fmus"


def test_equal_arguments_get_the_file_that_was_kept(cache, sampled_integrator, tmp_path):
    first = export_fmu(sampled_integrator, tmp_path / "first.fmu").read_bytes()
    (entry,) = cache.iterdir()
    assert entry.read_bytes().endswith(first)
    marked = first + b"marked"
    entry.write_bytes(hashlib.sha256(marked).digest() + marked)
    assert export_fmu(sampled_integrator, tmp_path / "second.fmu").read_bytes() == marked
    equal = dataclasses.replace(sampled_integrator)
    assert export_fmu(equal, tmp_path / "third.fmu").read_bytes() == marked


@pytest.mark.parametrize("damage", [lambda old: b"", lambda old: old[:-1], lambda old: old[:-9] + b"123456789"])
def test_a_damaged_file_is_made_again(cache, sampled_integrator, tmp_path, damage):
    first = export_fmu(sampled_integrator, tmp_path / "first.fmu").read_bytes()
    (entry,) = cache.iterdir()
    whole = entry.read_bytes()
    entry.write_bytes(damage(whole))
    for remembered in (fmu_files, portable_files):
        remembered.cache_clear()
    assert export_fmu(sampled_integrator, tmp_path / "second.fmu").read_bytes() == first
    assert entry.read_bytes() == whole


def test_a_changed_block_gets_a_file_of_its_own(cache, sampled_integrator, tmp_path):
    lag = sampled_integrator.states[0]
    faster = dataclasses.replace(sampled_integrator, states=(dataclasses.replace(lag, derivative=2 * lag.derivative),))
    files = [export_fmu(one, tmp_path / "one.fmu").read_bytes() for one in (sampled_integrator, faster)]
    assert files[0] != files[1]
    assert len(list(cache.iterdir())) == 2


def changed(block: Block) -> dict[str, Block]:
    """The block with each attribute of its first input, parameter, state, sample and output changed, one at a time."""
    found = {}
    for group in ("inputs", "parameters", "states", "samples", "outputs"):
        first, *rest = getattr(block, group)
        for one in dataclasses.fields(first):
            old = getattr(first, one.name)
            if one.name in ("name", "unit", "clock", "is_boolean") or not isinstance(old, bool | str | float | sp.Expr):
                continue
            new = not old if isinstance(old, bool) else old + " more" if isinstance(old, str) else old + 1
            if old == float("inf"):
                new = 5.0
            elif old == -float("inf"):
                new = -5.0
            try:
                other = dataclasses.replace(block, **{group: (dataclasses.replace(first, **{one.name: new}), *rest)})
            except BrunovskyError:
                continue
            found[f"{group}.{one.name}"] = other
    return found


def test_whatever_changes_in_a_block_changes_its_digest(sampled_integrator):
    others = changed(sampled_integrator)
    assert {"inputs.start", "parameters.value", "states.derivative", "samples.update", "outputs.nominal"} <= set(others)
    others |= {
        key: dataclasses.replace(sampled_integrator, **{key: value})
        for key, value in {"name": "other", "description": "other"}.items()
    }
    digests = [block_digest(one) for one in (sampled_integrator, *others.values())]
    assert None not in digests
    assert len(set(digests)) == len(digests)
    assert block_digest(dataclasses.replace(sampled_integrator)) == digests[0]


@pytest.mark.parametrize(
    "numbers",
    [(sp.Integer(2), sp.Float(2), sp.Float(2, 30)), (sp.Rational(1, 2), sp.Float(0.5)), (sp.pi, sp.Float(sp.pi))],
    ids=str,
)
def test_numbers_that_are_written_differently_are_told_apart(numbers):
    blocks = [Block("number", outputs=(Output("y", "1", "number", one),)) for one in numbers]
    assert len({block_digest(one) for one in blocks}) == len(numbers)


def test_the_digest_is_the_same_in_another_process():
    script = "from brunovsky.blocks import digest, library; print(digest.block_digest(library.closed_loop()))"
    environment = os.environ | {"PYTHONHASHSEED": "17", "PYTHONPATH": os.pathsep.join(sys.path)}
    run = subprocess.run([sys.executable, "-c", script], check=True, env=environment, capture_output=True, text=True)
    assert run.stdout.strip() == block_digest(library.closed_loop())


class half(sp.Function):
    """A function of the test's own, which C does not know by this name."""

    @classmethod
    def eval(cls, argument):
        """Stay as it is."""

    def fdiff(self, argindex=1):
        return sp.Rational(1, 2)

    def _ccode(self, printer):
        return f"({printer._print(self.args[0])})/2"


def test_a_block_with_a_function_of_ones_own_is_not_kept(cache, tmp_path):
    (t,) = symbols("t")
    block = Block("own_function", outputs=(Output("y", "s", "half of the time", half(t)),))
    assert block_digest(block) is None
    assert export_fmu(block, tmp_path / "one.fmu").is_file()
    assert not cache.exists()


def test_options_and_compiler_are_told_apart(cache, monkeypatch, tmp_path):
    block = library.circle()
    keys = [kept.fmu_key(block, version, ("host",), arrays) for version, arrays in ((2, False), (3, False), (3, True))]
    compiler = tmp_path / "other-cc"
    compiler.write_text("#!/bin/sh\necho another compiler 1.0\n")
    compiler.chmod(0o755)
    monkeypatch.setenv("CC", str(compiler))
    keys.append(kept.fmu_key(block, 2, ("host",), False))
    compiler.write_text("#!/bin/sh\necho another compiler 1.1\n")
    kept.compiler_version.cache_clear()
    keys.append(kept.fmu_key(block, 2, ("host",), False))
    kept.compiler_version.cache_clear()
    assert None not in keys
    assert len(set(keys)) == len(keys)


@pytest.mark.parametrize("place", ["engine.c", "fmu.h", "license"])
def test_another_runtime_is_told_apart(cache, place, monkeypatch, tmp_path):
    before = kept.fmu_key(library.circle(), 2, ("host",), False)
    runtime, licence = tmp_path / "runtime", tmp_path / "LICENSE"
    shutil.copytree(resource("fmu", "runtime"), runtime)
    shutil.copy(resource("LICENSE"), licence)
    monkeypatch.setattr(kept, "runtime_folder", lambda: runtime)
    monkeypatch.setattr(kept, "resource", lambda name: licence)
    assert kept.fmu_key(library.circle(), 2, ("host",), False) == before
    changing = licence if place == "license" else runtime / place
    changing.write_text(changing.read_text() + "\n")
    assert kept.fmu_key(library.circle(), 2, ("host",), False) != before


def test_what_changes_while_an_fmu_is_built_is_not_kept(cache, sampled_integrator, monkeypatch, tmp_path):
    keys = iter(["before", "after"])
    monkeypatch.setattr(archive, "fmu_key", lambda *arguments: next(keys))
    export_fmu(sampled_integrator, tmp_path / "one.fmu")
    assert not cache.exists()


def test_a_cache_that_cannot_be_written_is_done_without(cache, sampled_integrator, monkeypatch, tmp_path):
    (tmp_path / "file").touch()
    monkeypatch.setenv("BRUNOVSKY_CACHE", str(tmp_path / "file" / "cache"))
    assert export_fmu(sampled_integrator, tmp_path / "one.fmu").is_file()


def test_python_files_are_told_apart_by_name_and_content(tmp_path):
    (tmp_path / "part").mkdir()
    source = tmp_path / "part" / "one.py"
    source.write_text("a = 1\n")
    first = loaded_digest(tmp_path, LATER)
    source.write_text("a = 2\n")
    second = loaded_digest(tmp_path, LATER)
    source = source.rename(source.with_name("two.py"))
    third = loaded_digest(tmp_path, LATER)
    (tmp_path / "three.py").touch()
    assert len({None, first, second, third, loaded_digest(tmp_path, LATER)}) == 5


def test_python_files_that_changed_since_they_were_loaded_say_nothing(tmp_path):
    assert loaded_digest(tmp_path, LATER) is None  # there are none
    source = tmp_path / "one.py"
    source.touch()
    assert loaded_digest(tmp_path, LATER)
    assert loaded_digest(tmp_path, LONG_AGO) is None
    os.utime(source, (1e9, 1e9))  # as a copy with its times: the file itself is young
    assert loaded_digest(tmp_path, source.stat().st_ctime) is None


def test_a_changed_package_does_not_get_the_file_of_the_old_one(tmp_path):
    """Two processes with one cache; between them a source of the package is edited."""
    package = tmp_path / "src" / "brunovsky"
    shutil.copytree(Path(brunovsky.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
    for part in ("fmu", "LICENSE"):
        (tmp_path / part).symlink_to(resource(part))
    script = f"""
import sys
from brunovsky import _sources
_sources._LOADED = {LATER}  # however young the copy is
from brunovsky.blocks import Block, Output, TIME
from brunovsky.fmi import export_fmu
export_fmu(Block("watch", outputs=(Output("y", "s", "time", TIME),)), sys.argv[1])
"""
    paths = [str(tmp_path / "src"), *(one for one in sys.path if not Path(one, "brunovsky").exists())]
    environment = os.environ | {"BRUNOVSKY_CACHE": str(fresh_cache(tmp_path)), "PYTHONPATH": os.pathsep.join(paths)}
    environment["PYTHONDONTWRITEBYTECODE"] = "1"

    def exported(name: str) -> bytes:
        subprocess.run([sys.executable, "-c", script, name], check=True, env=environment, cwd=tmp_path)
        return (tmp_path / name).read_bytes()

    first = exported("first.fmu")
    assert len(list((tmp_path / "cache" / "fmus").iterdir())) == 1
    page = package / "fmi" / "documentation.py"
    page.write_text(page.read_text().replace("Licence of the runtime", "Licence of the C code"))
    second = exported("second.fmu")
    assert first != second
    assert len(list((tmp_path / "cache" / "fmus").iterdir())) == 2


def test_several_fmus_are_written_in_order_up_to_the_first_that_cannot(cache, sampled_integrator, tmp_path):
    wrong = dataclasses.replace(
        sampled_integrator, outputs=(Output("solver", "1", "a name that every FMU has", sp.Integer(1)),)
    )
    paths = [tmp_path / f"{number}.fmu" for number in range(4)]
    blocks = [sampled_integrator, library.circle(), wrong, library.circle()]
    written = export_fmus(zip(blocks, paths, [2, 3, 2, 2], strict=True))
    found = []
    with pytest.raises(ModelError, match="solver"):
        found.extend(written)
    assert found == paths[: len(found)]
    assert not any(path.exists() for path in paths[2:])
    assert list(export_fmus(zip(blocks[:2], paths, [2, 3], strict=False))) == paths[:2]


def test_nothing_is_left_half_written_by_ctrl_c(cache, sampled_integrator, tmp_path):
    def stopped():
        yield sampled_integrator, tmp_path / "fmus" / "one.fmu", 2
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(export_fmus(stopped()))
    folder = tmp_path / "fmus"
    assert not folder.exists() or set(os.listdir(folder)) <= {"one.fmu"}
