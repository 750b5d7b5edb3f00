"""Faults in computing what guards need when their alternative begins: guard by guard in the order of the text, on every
target.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cspdiag.cli.main import main

PROGRAM = """process Main {
  out a : int @ 1 ms
  communication { var n : int = 0  var z : int = 0 }
  composition {
    wait 1 ms ;
    (
%s
    )
  }
}
submodel Sink { in x : int  out y : double  y = 1 }
environment Bench for Main { s : Sink  a -> s.x }
"""
ALTERNATIVE = """      when %s
        & a ! %s -> skip
      []
      when %s
        & a ! %s -> skip
      []
      when %s
        & after (%s) -> skip"""
SHAPES = {
    "a value before a later condition": (ALTERNATIVE % ("n == 0", "6 / n", "8 / z > 0", "1", "n == 1", "1 ms"), 8),
    "a condition before its value": (ALTERNATIVE % ("n == 0", "1", "8 / z > 0", "7 % n", "n == 1", "1 ms"), 10),
    "values where conditions do not hold": (
        ALTERNATIVE % ("n > 0", "6 / n", "n == 0", "7 % n", "3 / n == 1", "1 ms"),
        11,
    ),
    "a delay": (ALTERNATIVE % ("n == 0", "1", "n == 0", "1", "n == 0", "(2 / n) * 1 ms"), 14),
    "a delay before a later value": (
        "      after ((2 / n) * 1 ms) -> skip\n      []\n      a ! 9223372036854775807 + (n + 1) -> skip",
        7,
    ),
    "an interrupt": (
        "      (skip ; wait 5 ms) interrupt\n        when 1 / (n + 1) == 1\n          & after ((2 / n) * 1 ms) -> skip",
        9,
    ),
    "the condition of an interrupt": (
        "      (skip ; wait 5 ms) interrupt\n        when 1 / n == 1\n          & after ((2 / z) * 1 ms) -> skip",
        8,
    ),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_the_first_fault_in_the_order_of_the_text_is_reported_at_its_line(
    shape: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, line = SHAPES[shape]
    program = tmp_path / "guards.csp"
    program.write_text(PROGRAM % text)
    reported = set()
    for options in (["-O0"], ["-O1"], ["-O0", "--target", "c"]):
        assert main(["run", str(program), *options]) == 1
        reported.update(re.findall(r"Fault: .*", capsys.readouterr().err))
    assert reported == {f"Fault: division by zero, in Main (guards.csp:{line})"}


def test_many_guards_alike_are_reported_at_the_line_of_their_conditions(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program = tmp_path / "guards.csp"
    program.write_text(
        "process Main {\n  in a[9] : int\n  communication { var n : int = 0  var v : int = 0 }\n"
        "  composition {\n    wait 1 ms ;\n    (alt i < 9 :\n"
        "      when i / n == 1\n        & a[i] ? v -> skip)\n  }\n}\n"
        "submodel Source { out y : int  y = 1 }\n"
        "environment Bench for Main { s : Source  " + "  ".join(f"s.y -> a[{i}]" for i in range(9)) + " }\n"
    )
    for options in (["-O0"], ["-O1"], ["-O0", "--target", "c"]):
        assert main(["run", str(program), *options]) == 1
        assert "Fault: division by zero, in Main (guards.csp:7)\n" in capsys.readouterr().err
