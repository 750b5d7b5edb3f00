"""Sample periods from outside the text (``--set``) that are not positive."""

from __future__ import annotations

import pytest

from cspdiag import pipeline
from cspdiag.base import Report, SourceFile
from cspdiag.network.lower.program import lower
from tests.literate import MAIN, describe
from tests.network.programs import checked

PROGRAM = """\
const Ts = 1 ms
process Joint(T: time, half: time = T) {
  in angle, more : double @ half
  communication { var last : double = 0 }
  composition { mu (angle ? last ; more ? last) }
}
process Main {
  in angle : double @ Ts
  communication {
    one : Joint(Ts)
    two : Joint(T = Ts)
    angle -> one.angle, two.angle, one.more, two.more
  }
  composition { one || two }
}
"""


def _read(path: str) -> SourceFile:
    raise FileNotFoundError(path)


def test_constant_that_was_set_is_reported_once() -> None:
    found = pipeline.check(SourceFile(name=MAIN, text=PROGRAM), _read, {"Ts": -5})
    (refused,) = found.report.diagnostics
    assert (refused.code, refused.label) == ("E0701", "set to -5 ns")
    assert describe([refused]).startswith("1:7 ")
    assert [PROGRAM[label.span.start : label.span.end] for label in refused.labels] == ["Ts"]


@pytest.mark.parametrize(("path", "place"), [("two.T", "2:15 "), ("two.half", "2:24 ")])
def test_parameter_that_was_set_is_reported_once(path: str, place: str) -> None:
    report = Report()
    assert lower(checked(PROGRAM), None, None, {path: 0}, report) is None
    (refused,) = report.diagnostics
    assert (refused.code, refused.label) == ("E0701", "set to 0 s")
    assert describe([refused]).startswith(place)
