"""What was checked and found to be right is checked again as soon as anything changes on which that depends."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag.lsp.session import Session
from tests.syntax.test_incremental import shown

PROGRAM = """\
const limit_of_gain = 4.0
const unused = 1
parameter gain = 2.0

submodel Inner(n: int = 1) {
  in  x : double
  out y : double
  y = delay(x, n, 0)
}

submodel Law(k: double, n: int = 2) {
  in  x : double
  out y : double
  inner : Inner(n = n)
  inner.x = x
  y = k * inner.y
}

process Main {
  in  x : double @ 1 ms
  out y : double @ 1 ms
  communication {
    law : Law(k = gain)
    x -> law.x
    law.y -> y
  }
  composition { mu law }
}

submodel Plant {
  in  u : double
  out v : double
  state s : double = 0
  der s = u * limit_of_gain / 1<s>
  v = s
}

environment Bench for Main step 1 ms {
  plant : Plant
  sum : Sum
  y -> plant.u
  plant.v -> sum.a
  sum.total -> sum.b
  sum.total -> x
}

submodel Sum {
  in  a, b : double
  out total : double
  state held : double = 0
  next held = b
  total = a + held
}
"""
CHANGES = {
    "a loop through a submodel of the environment": ("total = a + held", "total = a + b"),
    "the argument of an instance in another definition": ("Law(k = gain)", "Law(k = gain, n = -1)"),
    "the argument of an instance inside": ("Inner(n = n)", "Inner(n = n - 2)"),
    "a default": ("n: int = 2", "n: int = 0"),
    "a default inside, which nothing uses": ("n: int = 1", "n: int = 0"),
    "an equation that does not use its input": ("inner.x = x", "inner.x = 1.0"),
    "a constant that follows a parameter": ("const limit_of_gain = 4.0", "const limit_of_gain = gain"),
    "a period": ("out y : double @ 1 ms", "out y : double @ 2 ms"),
    "a fixed value": ("delay(x, n, 0)", "delay(x, int(gain), 0)"),
    "a division by zero": ("u * limit_of_gain / 1<s>", "u * limit_of_gain / 0<s>"),
    "a division that a constant makes one by zero": ("k * inner.y", "k * inner.y / (limit_of_gain - 4.0)"),
    "a port": ("in  u : double\n", "in  u, w : double\n"),
    "a name that is not there": ("plant : Plant", "plant : Plan"),
}


def diagnostics(session: Session, path: Path, text: str) -> list[object]:
    return shown(session.diagnostics(session.documents.open(path.as_uri(), text, None)))


@pytest.mark.parametrize("change", CHANGES)
def test_a_change_is_seen_wherever_it_matters(change: str, tmp_path: Path) -> None:
    path, session = tmp_path / "main.csp", Session()
    changed = PROGRAM.replace(*CHANGES[change])
    assert changed != PROGRAM
    assert diagnostics(session, path, PROGRAM) == []
    for text in (changed, "// Moved.\n" + changed, changed.replace("gain = 2.0", "gain = 3.0"), PROGRAM, changed):
        assert diagnostics(session, path, text) == diagnostics(Session(), path, text)


HARMLESS = {"a default inside, which nothing uses", "a constant that follows a parameter"}


@pytest.mark.parametrize("change", sorted(CHANGES.keys() - HARMLESS))
def test_the_other_changes_are_mistakes(change: str, tmp_path: Path) -> None:
    assert diagnostics(Session(), tmp_path / "main.csp", PROGRAM.replace(*CHANGES[change])) != []


def test_what_nothing_has_changed_for_is_not_checked_again(tmp_path: Path) -> None:
    path, session = tmp_path / "main.csp", Session()
    diagnostics(session, path, PROGRAM)
    (checks,) = session._checks.values()
    made = checks.made
    diagnostics(session, path, PROGRAM.replace("unused = 1", "unused = 2"))
    assert checks.made - made == 2
    for number in range(20):
        diagnostics(session, path, PROGRAM.replace("gain = 2.0", f"gain = {number}.5"))
        assert len(checks._known) < 60
