"""Steps of a ``seq`` in which a process waits are a loop in optimized Python, as they are in readable Python."""

from __future__ import annotations

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source

PROGRAM = """
process Scan {
  in  low[16]  : int
  in  high[16] : int
  out sum      : int

  communication {
    var w     : int = 0
    var total : int = 0
  }

  composition {
    mu (BODY ; sum ! total)
  }
}
"""


def scan(body: str) -> str:
    built = pipeline.build(SourceFile(name="main.csp", text=PROGRAM.replace("BODY", body)), read_source)
    assert built.network is not None, [found.message for found in built.checked.report.diagnostics]
    return pipeline.generate(built.network, read_source, "python", 1)["main/scan.py"]


@pytest.mark.parametrize(
    ("body", "waits"),
    [
        ("(seq i < 16 : (low[i] ? w))", 1),
        ("(seq i < 16 : (low[i] ? w ; total := total + w))", 1),
        ("(seq i < 3 : (low[i + 2] ? w ; high[i] ? w))", 2),
        ("(seq i < 4 : (low[i] ? w ; (seq j < 4 : (high[j] ? w ; total := total + w))))", 2),
        ("(seq i < 4 : (seq j < 4 : (low[i] ? w ; high[j] ? w)))", 2),
        ("(seq i < 4 : (low[i] ? w ; if w > 3 then high[i] ? w))", 2),
        ("(seq i < 2 : (low[i] ? w))", 2),  # too few
        ("(seq i < 4 : (low[2 * i] ? w))", 4),  # elements do not count by one
        ("low[0] ? w ; low[1] ? w ; low[2] ? w", 3),  # each has its own text
    ],
)
def test_a_process_waits_at_as_many_places_as_its_text_has(body: str, waits: int) -> None:
    assert scan(body).count("yield") == waits


def test_the_turn_is_a_local_variable() -> None:
    text = scan("(seq i < 4 : (low[i] ? w ; (seq j < 4 : (high[j] ? w ; total := total + w))))")
    assert "for j in range(4):" in text
    assert "for i in range(4):" in text
    assert "low[j]" in text
    assert "high[i]" in text


def test_steps_that_do_not_wait_are_not_repeated_by_a_loop() -> None:
    assert "range" not in scan("low[0] ? w ; (seq i < 4 : total := total + w * i)")
