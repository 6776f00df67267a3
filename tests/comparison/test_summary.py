"""The short summary that is kept beside a study."""

from brunovsky.comparison import ProtocolSection, Table, load_study, run_study, sections_markdown, summary_markdown
from brunovsky.comparison.summary import LONGEST


def section(rows: int, *findings: str) -> ProtocolSection:
    columns = ("law", "case", "P_m_per_s3", "iae [m s]", "failure")
    table = Table("t", columns, tuple((f"law {k}", 0, 2.5, 0.5, "") for k in range(rows)))
    return ProtocolSection("Swept", "A long explanation.", table=table, findings=("Found one.", *findings))


def test_a_protocol_is_told_by_its_findings_and_a_table_without_what_says_nothing() -> None:
    lines = sections_markdown([section(2)])
    assert lines[:3] == ["", "## Swept", ""] and "- Found one." in lines and "explanation" not in " ".join(lines)
    assert lines[-4] == "| law | P, m/s³ | IAE, m s |" and lines[-1] == "| law 1 | 2.50 | 0.500 |"
    assert not any(line.startswith("|") for line in sections_markdown([section(LONGEST + 1)]))


def test_long_items_are_split() -> None:
    long = " ".join(f"Sentence {k} of many words that make the item long to read in one go." for k in range(6))
    lines = sections_markdown([section(1, long)])
    assert "- Found one." in lines
    assert sum(line.startswith("  - Sentence") for line in lines) == 5


def test_all_runs_stand_in_one_table(small) -> None:
    text = summary_markdown(run_study(load_study(small)))
    rows = [line.split(" | ") for line in text.partition("## All runs")[2].splitlines() if line.startswith("|")]
    assert [row[:2] for row in rows[2:]] == [["| Circle", "linear"], ["| ", "relay"]]
    assert "ended" not in rows[0] and text.count("along a circle of radius") == 1
