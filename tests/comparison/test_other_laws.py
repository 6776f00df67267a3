"""What a report says of laws that are not of the paper's form: read from their blocks."""

import pytest

from brunovsky.blocks.library import closed_loop
from brunovsky.comparison import load_study, run_study, summary_markdown
from brunovsky.comparison.other_laws import other_laws, source_of
from brunovsky.comparison.report import render_report
from brunovsky.comparison.study.loops import FAMILY, KINDS, loop_of

RELATIVE = """
[[laws]]
name = "faster"
title = "a faster observer"
kind = "disturbance_observer"
parameters = { bandwidth_per_s = 30.0 }
"""


@pytest.mark.parametrize("kind", [kind for kind in KINDS if kind not in FAMILY])
def test_the_block_of_every_kind_says_its_source_with_a_year(kind) -> None:
    source = source_of(loop_of(kind).maker)
    assert any(str(year) in source for year in range(1960, 2030)) and len(source) > 60
    assert not {"`", "*", "\n"} & set(source) and source[0].isupper()


def test_a_block_without_a_source_is_this_project_s() -> None:
    assert source_of(lambda: None) == "This project"
    assert source_of(closed_loop)


def test_a_law_is_told_as_it_was_run(small) -> None:
    small.write_text(f'figures = ["path"]\n{small.read_text(encoding="utf-8")}{RELATIVE}', encoding="utf-8")
    comparison = run_study(load_study(small))
    (one,) = other_laws(comparison)
    assert (one.name, one.title, one.description) == (
        "faster",
        "a faster observer",
        "linear law with a disturbance observer",
    )
    assert one.parameters == "K₁ = 2500 1/s³, K₂ = 550 1/s², K₃ = 15 1/s, bandwidth = 30 1/s"
    assert one.source.startswith("W.-H. Chen") and one.source.endswith("doi:10.1109/41.857974")
    page, summary = render_report(comparison), summary_markdown(comparison)
    assert one.parameters in page and "another law" not in page
    assert one.source.partition(",")[0] in summary and "doi:10.1109/41.857974" in page
