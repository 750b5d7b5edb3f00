"""Definitions that were parsed completely are checked although others were not."""

from __future__ import annotations

from tests.literate import check_files, describe

PROGRAM = """
process Reader {
  in x : int
  composition { x ! true }
}

process Broken {
  in x : int
  communication { var y : int = 0 }
  composition { mu x ? y

process Writer {
  out x : int
  composition { x ! true }
}

process Whole {
  communication { a : Broken  b : Writer }
  composition { a || b }
}
"""


def test_errors_next_to_a_syntax_error_are_reported_without_consequences() -> None:
    shown = describe(check_files({"case.csp": PROGRAM}).report.diagnostics)
    codes = [line.split("[")[1].split("]")[0] for line in shown.splitlines() if "error[" in line]
    assert codes == ["E0233", "E0301", "E0109", "E0301"]
