"""Where a message of a study file points: the key's own line, and no level that the file does not have."""

from pathlib import Path

import pytest

from brunovsky.comparison import load_study
from brunovsky.errors import StudyError

TEXT = """name = "six"
title = "Figure 6"
[[laws]]
name = "linear"
kind = "linear"
[[scenarios]]
name = "o"
title = "o"
duration_s = 0.1
[[protocols]]
kind = "monte_carlo"
scenario = "o"
metrics = ["rms_u2"]
cases = 3
[protocols.distributions]
x_start_m = { uniform = [1.3, 1.8] }
"""


@pytest.mark.parametrize(
    ("right", "wrong", "told"),
    [
        ("cases = 3", "cases = -3", "line 14: protocols[1].cases: "),
        ("1.8]", "'a']", "line 16: protocols[1].distributions.x_start_m.uniform[2]: "),
        ('["rms_u2"]', '["rms_u3"]', "line 13: protocols[1].metrics[1]: "),
        ("monte_carlo", "carlo", "line 10: protocols[1]: input tag 'carlo'"),
    ],
)
def test_a_message_on_a_protocol_points_at_its_key(tmp_path: Path, right: str, wrong: str, told: str) -> None:
    path = tmp_path / "six.toml"
    path.write_text(TEXT.replace(right, wrong), encoding="utf-8")
    with pytest.raises(StudyError) as caught:
        load_study(path)
    assert f"six.toml, {told}" in str(caught.value)
