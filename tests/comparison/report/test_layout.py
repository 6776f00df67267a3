"""How tables are set on a page."""

from brunovsky.comparison.protocol_section import Table
from brunovsky.comparison.report.layout import WIDEST, table_parts


def of_laws(count: int, heads: int = 2) -> Table:
    laws = [f"law {k}" for k in range(count)]
    return Table("metrics", ("metric", "unit", *laws), (("IAE", "m s", *map(float, range(count))),), "All", heads)


def test_a_table_of_many_laws_is_set_in_parts_that_fit_a_page_and_lose_nothing() -> None:
    whole = of_laws(13)
    parts = table_parts(whole)
    assert [len(one.columns) - 2 for one in parts] == [4, 5, 4]
    assert all(one.columns[:2] == ("metric", "unit") and one.rows[0][:2] == ("IAE", "m s") for one in parts)
    assert tuple(name for one in parts for name in one.columns[2:]) == whole.columns[2:]
    assert tuple(cell for one in parts for cell in one.rows[0][2:]) == whole.rows[0][2:]
    assert parts[-1].caption == "All (part 3 of 3)"


def test_a_table_that_fits_and_one_without_heads_stay_whole() -> None:
    assert table_parts(of_laws(WIDEST)) == (of_laws(WIDEST),)
    assert table_parts(of_laws(20, heads=0)) == (of_laws(20, heads=0),)
