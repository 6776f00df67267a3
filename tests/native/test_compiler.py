"""Finding and running the C compiler, and the cache of what it made."""

import ctypes
import dataclasses
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import brunovsky as br
from brunovsky.errors import CompilerError
from brunovsky.native import compile_library, compiler, find_compiler, library, model_source


def test_no_compiler_is_one_message_with_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(compiler.importlib.util, "find_spec", lambda name: None)
    with pytest.raises(CompilerError, match=r"no C compiler was found .*pip install ziglang"):
        find_compiler()


def test_ziglang_is_used_where_there_is_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(compiler.importlib.util, "find_spec", lambda name: object())
    assert find_compiler()[1:] == ("-m", "ziglang", "cc")


def test_unknown_compiler_named_by_cc(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler -O2")
    with pytest.raises(CompilerError, match=r"named by CC, 'no-such-compiler', was not found"):
        find_compiler()


def test_failing_compiler_shows_its_words_and_leaves_nothing(tmp_path: Path) -> None:
    source = tmp_path / "broken.c"
    source.write_text("int broken(void) { return undeclared; }\n")
    with pytest.raises(CompilerError, match=r"(?s)the C compiler failed: .*broken\.c.*undeclared"):
        compile_library([source], tmp_path / "broken.so")
    assert [path.name for path in tmp_path.iterdir()] == ["broken.c"]


def test_source_depends_on_the_block_alone() -> None:
    assert model_source(br.blocks.closed_loop()) == model_source(br.blocks.closed_loop())


def test_cache_is_used_again(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("BRUNOVSKY_CACHE", str(tmp_path))
    first = library.build_library(br.blocks.circle())
    stamp = first.stat().st_mtime_ns
    assert library.build_library(br.blocks.circle()) == first and first.stat().st_mtime_ns == stamp
    other = library.build_library(br.blocks.robot())
    assert sorted(tmp_path.iterdir()) == sorted([first, other, tmp_path / "objects"])
    stems = [path.stem.partition("-")[0] for path in (tmp_path / "objects").iterdir()]
    runtime = [Path(name).stem for name in library.ENGINE_SOURCES]
    assert sorted(stems) == sorted([*runtime, "model", "model"])  # the runtime once


def constant(folder: Path, **options: dict[str, str]) -> int:
    """What ``constant`` of a fresh library of ``constant.c`` in the folder returns."""
    output = folder / f"{len(list(folder.iterdir()))}{compiler.SUFFIX}"
    compile_library([folder / "constant.c"], output, include=[folder / "include"], **options)
    return int(ctypes.CDLL(str(output)).constant())


def test_objects_are_found_again_by_all_that_they_depend_on(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("BRUNOVSKY_CACHE", str(tmp_path / "cache"))
    folder = tmp_path / "source"
    (folder / "include").mkdir(parents=True)
    source, beside, included = folder / "constant.c", folder / "beside.h", folder / "include" / "included.h"
    export = '__attribute__((visibility("default")))'
    text = f'#include "beside.h"\n#include <included.h>\n{export} int constant(void) {{ return A + B + C; }}\n'
    source.write_text(text)
    beside.write_text("#define A 1\n")
    included.write_text("#define B 10\n")
    objects = tmp_path / "cache" / "objects"
    for expected, count in ((111, 1), (111, 1)):
        assert constant(folder, defines={"C": "100"}) == expected and len(list(objects.iterdir())) == count
    beside.write_text("#define A 2\n")
    assert constant(folder, defines={"C": "100"}) == 112
    included.write_text("#define B 20\n")
    assert constant(folder, defines={"C": "100"}) == 122
    assert constant(folder, defines={"C": "200"}) == 222
    source.write_text(text.replace("A + B", "A - B"))
    assert constant(folder, defines={"C": "200"}) == 182
    assert len(list(objects.iterdir())) == 5
    beside.write_text("#define A 1\n")
    included.write_text("#define B 10\n")
    source.write_text(text)
    assert constant(folder, defines={"C": "100"}) == 111 and len(list(objects.iterdir())) == 5


def test_a_cache_that_cannot_be_written_is_done_without(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    monkeypatch.setenv("BRUNOVSKY_CACHE", str(tmp_path / "file" / "cache"))
    block = dataclasses.replace(br.blocks.circle(), name="circle_without_cache")  # loaded nowhere before
    assert br.export_fmu(block, tmp_path / "circle.fmu").exists()
    assert br.simulate(block, 0.1)["Z1d[1]"][0] == pytest.approx(2**0.5)


def test_generated_code_has_no_warnings(tmp_path: Path) -> None:
    """Every shipped block, strictly compiled."""
    from brunovsky._resources import runtime_folder

    flags = "-Wall -Wextra -Wpedantic -Werror"
    for name in ("robot", "linearized_robot", "circle", "sliding_mode", "pole_placement", "closed_loop"):
        source = tmp_path / f"{name}.c"
        source.write_text(model_source(getattr(br.blocks, name)()))
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("CC", " ".join([*find_compiler(), *flags.split()]))
            compile_library([source], tmp_path / f"{name}.so", include=[runtime_folder()])
        assert (tmp_path / f"{name}.so").stat().st_size > 0


def test_text_from_descriptions_cannot_break_the_code(tmp_path: Path) -> None:
    block = br.Block("quotes", 'a "quoted" */ \\ text\nof two lines', checks=[_check('say "no" \\ é')])
    text = model_source(block)
    assert br.simulate(block, 0.1, step_size=0.1).sizes["time"] == 2
    assert '\\"no\\"' in text


def _check(message: str) -> br.blocks.Check:
    import sympy as sp

    return br.blocks.Check("text", sp.true, message)


@pytest.mark.skipif(sys.platform == "win32", reason="the compiler that counts is a shell script")
def test_libraries_compiled_at_once_compile_what_they_share_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    counting, log = tmp_path / "counting-cc", tmp_path / "log"
    counting.write_text(f'#!/bin/sh\ncase " $* " in *" -c "*) echo object >> {log};; esac\nexec cc "$@"\n')
    counting.chmod(0o755)
    monkeypatch.setenv("CC", str(counting))
    monkeypatch.setenv("BRUNOVSKY_CACHE", str(tmp_path / "cache"))
    source = tmp_path / "shared.c"
    source.write_text("int shared(void) { return 1; }\n")
    libraries = [tmp_path / f"{number}{compiler.SUFFIX}" for number in range(4)]
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda one: compiler.compile_library([source], one), libraries))
    assert log.read_text().split() == ["object"]
    assert all(one.is_file() for one in libraries)
