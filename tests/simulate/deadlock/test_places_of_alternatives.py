"""An alternative waits where it begins, also if guards of it were computed in lines of their own."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.simulate.deadlock.levels import LEVELS, report

ALTERNATIVE = """process A {{
  in l : int
  out r : int
  communication {{
    var v : int = 1
    var n : int = 0
  }}
  composition {{
    mu (
      l ? v -> n := n + 1
      []
      {branch}
    )
  }}
}}
process Main {{
  communication {{
    a : A
    b : A
    a.r -> b.l
    b.r -> a.l
  }}
  composition {{ a || b }}
}}
"""


@pytest.mark.parametrize(
    "branch",
    ["when n < 1 - v & r ! v + 1 -> n := n + 1", "when n + v > 9 & l ? v -> (n := 10 / v ; r ! v)"],
)
def test_the_place_is_that_of_the_alternative(branch: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    reports = [report(ALTERNATIVE.format(branch=branch), level, tmp_path, capsys) for level in LEVELS]
    assert "case.csp:10)" in "".join(reports[0])
    assert all(other == reports[0] for other in reports)
