"""Finding and running the C compiler, and the cache of what it made."""

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
    assert sorted(tmp_path.iterdir()) == sorted([first, other])


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
