"""The message of a fault is the same wherever the program runs, in the reference semantics, too."""

from __future__ import annotations

import pytest

import cspdiag
from cspdiag.simulate.native.build import CompilerError, find_compiler

FAULTS = {
    "narrow + narrow": "200 is outside int8 (-128 .. 127)",
    "-low": "128 is outside int8 (-128 .. 127)",
    "int8(x)": "200.75 is outside int8 (-128 .. 127)",
    "int8(n)": "3000000000 is outside int8 (-128 .. 127)",
    "uint8(-n)": "-3000000000 is outside uint8 (0 .. 255)",
    "int(x / tiny)": "is outside int (-9223372036854775808 .. 9223372036854775807)",
    "n * n * n": "27000000000000000000000000000 is outside int (-9223372036854775808 .. 9223372036854775807)",
    "n ^ 3": "27000000000000000000000000000 is outside int (-9223372036854775808 .. 9223372036854775807)",
    "n ^ 64": "3000000000 ^ 64 is outside int",
    "n ^ (zero - 1)": "negative exponent -1 of an integer",
    "n / zero": "division by zero",
    "n % zero": "division by zero",
    "table[n]": "index 3000000000 is outside 0 .. 1",
    "int(sqrt(-x))": "a real value is infinite or not a number",
    "int(x / double(zero))": "division by zero",
}
LIMITS = "is outside time (-9223372036.854775808 s .. 9223372036.854775807 s)"
TIMES = {
    "late + late": f"18000000000 s {LIMITS}",
    "soon - late - late": f"-17999999999.999 s {LIMITS}",
    "late * n": f"27000000000000000000 s {LIMITS}",
    "n * late": f"27000000000000000000 s {LIMITS}",
    "-first": f"9223372036.854775808 s {LIMITS}",
    "abs(first)": f"9223372036.854775808 s {LIMITS}",
    "first / (zero - 1)": f"9223372036.854775808 s {LIMITS}",
    "now + late + late": f"18000000000 s {LIMITS}",
    "min(late + late, soon)": f"18000000000 s {LIMITS}",
    "late / zero": "division by zero",
    "late % (soon - soon)": "division by zero",
}
PROGRAM = """process Main {
  out y : int

  communication {
    var narrow : int8 = 100
    var low    : int8 = -128
    var n      : int = 3000000000
    var zero   : int = 0
    var x      : double = 200.75
    var tiny   : double = 1e-30
    var table  : int[2] = [1, 2]
    var late   : time = 9000000000 s
    var soon   : time = 1 ms
    var first  : time = -9223372036854775807 ns
    var kept   : time = 0 s
  }

  composition {
    narrow := narrow ; low := low ; n := n ; zero := zero ; x := x ; tiny := tiny ; table[0] := 1 ;
    late := late ; soon := soon ; first := first - 1 ns ; kept := kept ;
    %s
  }
}

environment Bench for Main {
  y -> _
}
"""


def text_of(expression: str, **how: object) -> str:
    statement = f"kept := {expression}" if expression in TIMES else f"y ! int({expression})"
    run = cspdiag.parse(PROGRAM % statement, "case.csp").run(**how)  # type: ignore[arg-type]
    assert run.outcome.error is not None
    return run.summary().splitlines()[0]


@pytest.mark.parametrize(("expression", "reported"), (FAULTS | TIMES).items(), ids=FAULTS | TIMES)
def test_a_fault_says_the_same_in_python_and_on_the_meaning_of_the_language(expression: str, reported: str) -> None:
    texts = {text_of(expression, level=level) for level in (0, 1, "reference")}
    assert len(texts) == 1
    (text,) = texts
    assert reported in text
    assert text.endswith("in Main (case.csp:21)")


@pytest.mark.parametrize("expression", ["narrow + narrow", "int8(x)", "n ^ 64", "table[n]", *TIMES])
def test_a_fault_says_the_same_in_c(expression: str) -> None:
    try:
        find_compiler()
    except CompilerError as problem:
        pytest.skip(str(problem))
    texts = {text_of(expression, target="c", level=level) for level in (0, 1)}
    assert texts == {text_of(expression, level="reference")}
