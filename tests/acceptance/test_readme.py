"""The README's Python runs as printed."""

import re
from pathlib import Path

import pytest

README = Path(__file__).parents[2] / "README.md"


def test_the_ten_lines_run_and_show_what_they_say(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (code,) = re.findall(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    assert len(code.splitlines()) == 10
    monkeypatch.chdir(tmp_path)
    exec(compile(code, "README.md", "exec"), {})
    derived, linear, sliding = capsys.readouterr().out.splitlines()
    assert derived == "<Linearization: relative degree (3, 3), det G = -eta_1, full>"
    errors = [float(re.findall(r": (\S+) m", line)[0]) for line in (linear, sliding)]
    assert errors[1] < errors[0] / 5
    assert (tmp_path / "build" / "linearized_robot.fmu").exists()
