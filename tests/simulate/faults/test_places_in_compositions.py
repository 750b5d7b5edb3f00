"""A fault in a composition names the line where its statement, condition or guard begins, on every target.

Each text has the comment `// here` in that line.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import cspdiag
from cspdiag.simulate.native.build import CompilerError, find_compiler
from tests.support.thorough import at_levels

PROGRAM = """struct Pair {{ a : int  b : int }}

process Inner(yes : bool, one : int) {{
  in  c : int
  out o : int
  out p : Pair
  communication {{
    var n : int = 0
    var m : int = 0
    var x : double = 0
    var v : int[2] = [0, 0]
    var q : Pair = Pair(a = 0, b = 0)
  }}
  composition {{
    wait 1 ms ; n := 0 ; m := n ; q := q ; x := x ; v[0] := 0 ;
{body}
  }}
}}

process Main {{
  in  c : int
  out o : int
  out p : Pair
  communication {{ inner : Inner(yes = true, one = 1)  c -> inner.c  inner.o -> o  inner.p -> p }}
  composition {{ inner }}
}}

submodel Counter {{ in i : int  in j : Pair  out y : int  state k : int = 0  next k = k + 1  y = k }}
environment Bench for Main step 1 ms {{ s : Counter  o -> s.i  p -> s.j  s.y -> c }}
"""
FUSED = """
process Inner {{
  in  d : int
  communication {{ var n : int = 0  var m : int = 0 }}
  composition {{
    wait 1 ms ; d ? n ; d ? m ;
{body} ;
    mu (d ? n)
  }}
}}

process Source {{ out d : int  composition {{ mu (d ! 0) }} }}

process Main {{
  out o : int
  communication {{ inner : Inner  source : Source  source.d -> inner.d }}
  composition {{ inner || source || (o ! 1) }}
}}

environment Bench for Main {{ o -> _ }}
"""
STATEMENTS = {
    "an assignment": "n := // here\n  1 +\n  6 / m",
    "an assignment in parentheses": "(\n  n := 1 ;\n  (\n    n := // here\n      6 / m\n  )\n)",
    "an operand in parentheses": "n := ( // here\n  6 / m\n)",
    "an element": "v[ // here\n  0\n] :=\n  6 / m",
    "an index": "v[ // here\n  n +\n  m - 1] := 3",
    "a struct": "q := Pair( // here\n  a = 1,\n  b = 6 / m)",
    "an array": "v := [ // here\n  1,\n  6 / m]",
    "a choice of values": "n := // here\n  if yes\n  and 6 / m > one\n  then 1 else 2",
    "a conversion": "n := // here\n  int(\n    1e30 * double(n + 1))",
    "an overflow": "n := // here\n  9223372036854775807\n  + (n + 1)",
    "an infinity": "x := // here\n  1e300 *\n  (1e300 + x)",
    "a function": "x := // here\n  1.0 +\n  sqrt(x -\n  1.0)",
    "a write": "o ! // here\n  1 +\n  6 / m",
    "a write of a struct": "p ! Pair( // here\n  a = 1,\n  b = 6 / m)",
    "a read": "c ? // here\n  v[n +\n  m - 1]",
    "a wait": "wait // here\n  1 ms *\n  (6 / m)",
    "a wait until": "wait until // here\n  now +\n  1 ms * (6 / m)",
    "a label": "here:\n  n := // here\n  6 / m",
    "a branch of a parallel": "(n := 1\n  ||\n  x := // here\n  double(6\n  / m))",
    "a write in a parallel": "(n := 1\n  ||\n  o ! // here\n  (6\n  / m))",
    "a replicated statement": "(seq i < 3 :\n  n := // here\n  6\n  / (i - 1))",
    "one of many statements alike": " ;\n".join(
        f"n := {'// here' * (index == 3)}\n  6 / ({index} - (m + 3))" for index in range(6)
    ),
    "a handler": "(n :=\n  6 / m) catch Fault ->\n  n := // here\n  5 +\n  7 % m",
}
CONDITIONS = {
    "until": "mu (\n  n := 1 ; wait 1 ms\n) until\n  n == 1 // here\n  and 6 / m > 1",
    "until on the line": "mu (\n  n := 1 ; wait 1 ms\n) until n == 1 and // here\n  6 / m > 1",
    "until in parentheses": "mu (\n  n := 1 ; wait 1 ms\n) until ( // here\n  6 / m > 1)",
    "until what the compiler knows": "mu (\n  n := 1 ; wait 1 ms\n) until\n  yes // here\n  and\n  6 / m > one",
    "until not": "mu (\n  n := 1 ; wait 1 ms\n) until\n  not // here\n  (not (\n  6 / m > one))",
    "until if": "mu (\n  n := 1 ; wait 1 ms\n) until\n  (if yes // here\n  then\n  6 / m > one else false)",
    "while": "while\n  n == 1 // here\n  or\n  6 / m > 1\ndo (n := 0 ; wait 1 ms)",
    "while what the compiler knows": "while\n  yes // here\n  and\n  6 / m > one\ndo (n := 0 ; wait 1 ms)",
    "if": "if\n  n == 0 // here\n  and\n  6 / m > 1\nthen n := 1 else n := 2",
    "if on the line": "if n == 1 or // here\n  6 / m > 1\nthen n := 1 else n := 2",
    "if what the compiler knows": "if\n  not yes // here\n  or not (\n  6 / m > one)\nthen skip else n := 1",
    "else if": "if n == 4\nthen n := 1\nelse if\n  n == 0 and // here\n  6 / m > one\nthen n := 4 else n := 5",
}
GUARDS = {
    "when": "(when\n  n == 0 // here\n  and\n  6 / m > 1\n  & o ! 1 -> skip\n  []\n  after 1 ms -> skip)",
    "when what the compiler knows": "(after 1 ms -> skip\n  []\n  when yes and // here\n  6 / m > one & o ! 1 -> skip)",
    "when of a guard alone": "(when\n  n == 0 // here\n  and 6 / m > 1\n  &\n  after 1 ms -> skip)",
    "a replicated when": "(alt i < 9 :\n  when\n  n == 0 // here\n  and\n  6 / m > i\n  & o ! 1 -> skip)",
    "a value": "(after 1 ms -> skip\n  []\n  when\n  n == 0\n  &\n  o ! // here\n  6 / m -> skip)",
    "a value of a guard alone": "(\n  o ! // here\n  6 / m -> skip)",
    "a duration": "(o ! 1 -> skip\n  []\n  after // here\n  1 ms *\n  (6 / m) -> skip)",
    "a duration of a guard alone": "(when\n  yes &\n  after // here\n  1 ms *\n  (6 / m) -> skip)",
    "an instant": "(at // here\n  now +\n  1 ms * (6 / m) -> skip)",
    "a read of a guard": "(after 9 ms -> skip\n  []\n  c ? // here\n  v[n +\n  m - 1] -> skip)",
    "a read of a guard alone": "(\n  c ? // here\n  v[n +\n  m - 1] -> skip)",
    "a statement after a guard": "(\n  after 1 ms -> (\n\n  n := // here\n  6 / m))",
    "when of an interrupt": "(skip ; wait 5 ms) interrupt\n  when\n  n == 0 // here\n  and 6 / m > 1 & o ! 1 -> skip",
    "a duration of an interrupt": "(skip ; wait 5 ms) interrupt\n  after // here\n  1 ms *\n  (6 / m) -> skip",
    "a value of an interrupt": "(skip ; wait 5 ms) interrupt\n  o ! // here\n  (6\n  / m) -> skip",
    "a read of an interrupt": "(skip ; wait 9 ms) interrupt\n  c ? // here\n  v[n +\n  m - 1] -> skip",
}
IN_FUSION = {
    "an assignment": STATEMENTS["an assignment"],
    "until": CONDITIONS["until"],
    "if": CONDITIONS["if"],
    "while": CONDITIONS["while"],
}
PROGRAMS = {
    **{name: PROGRAM.format(body=body) for name, body in (STATEMENTS | CONDITIONS | GUARDS).items()},
    **{f"{name}, fused": FUSED.format(body=body) for name, body in IN_FUSION.items()},
    "many guards alike": (
        "process Main {\n  in a[9] : int\n  communication { var m : int = 0  var x : int = 0 }\n  composition {\n"
        "    wait 1 ms ; m := 0 ;\n    ("
        + "\n    []\n".join(
            f"    when 6 / (m + {index} - 3) < 9{' // here' * (index == 3)}\n    & a[{index}] ? x -> skip"
            for index in range(9)
        )
        + ")\n  }\n}\nsubmodel Source { out y : int  y = 1 }\n"
        "environment Bench for Main { s : Source  " + "  ".join(f"s.y -> a[{index}]" for index in range(9)) + " }\n"
    ),
}


def place_of(program: str, **how: object) -> str:
    run = cspdiag.parse(program, "case.csp").run(until="20 ms", **how)  # type: ignore[arg-type]
    assert run.outcome.error is not None
    return re.findall(r"case\.csp:\d+", run.summary().splitlines()[0])[-1]


def line_of(program: str) -> str:
    return f"case.csp:{1 + next(number for number, line in enumerate(program.splitlines()) if '// here' in line)}"


@pytest.mark.parametrize("kind", PROGRAMS)
def test_a_fault_names_where_its_statement_condition_or_guard_begins(kind: str) -> None:
    program = PROGRAMS[kind]
    places = {level: place_of(program, level=level) for level in (0, 1, "reference")}
    assert places == dict.fromkeys(places, line_of(program))


@pytest.mark.parametrize(("kind", "level"), at_levels(PROGRAMS))
def test_a_fault_in_c_names_where_its_statement_condition_or_guard_begins(kind: str, level: int) -> None:
    try:
        find_compiler()
    except CompilerError as problem:
        pytest.skip(str(problem))
    program = PROGRAMS[kind]
    assert place_of(program, target="c", level=level) == line_of(program)


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("name", ["a b", "a,b", "two  spaces", "it's (new)", "50% #1"])
def test_any_name_of_a_file_is_shown_in_places(name: str, level: int, tmp_path: Path) -> None:
    file = tmp_path / f"{name}.csp"
    file.write_text(
        "process Main {\n  communication { var n : int = 3 }\n"
        "  composition {\n    mu (wait 1 ms ; n := 6 / n - 2)\n  }\n}\n"
    )
    run = cspdiag.load(str(file)).run(until="10 ms", level=level)
    assert run.outcome.error is not None
    assert str(run.outcome.error.place) == f"Main ({name}.csp:4)"
