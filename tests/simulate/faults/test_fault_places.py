"""A fault in a control law or an environment names the line where its equation begins, on every target."""

from __future__ import annotations

import re
from itertools import product

import pytest

import cspdiag
from cspdiag.simulate.native.build import CompilerError, find_compiler
from tests.support.thorough import at_levels

LAW = """
submodel Law {{
  in  x : double
  out y : double

  {declared}

  {statement}
  {output}
}}
"""
PROGRAM = """
process Main {
  in  a : double @ 10 ms
  out b : double

  communication {
    law : Outer
    a -> law.x
    law.y -> b
  }

  composition {
    mu law
  }
}

environment Bench for Main step 10 ms {
  plant : Plant
  plant.y -> a
  b -> plant.x
}
"""
OUTER = """
submodel Outer {
  in  x : double
  out y : double

  law : Law
  law.x = x
  y = law.y
}
"""
STATEMENTS = {
    "next": ("state n : int = 0", "next n =\n    int(1 / int(x - 1))", "y = double(n)"),
    "next of an array": ("state n : int[2] = [0, 0]", "next n =\n    [n[0], int(1 / int(x - 1))]", "y = double(n[0])"),
    "derivative": ("state n : double = 0", "der n =\n    1<1/s> * double(int(1 / int(x - 1)))", "y = n"),
    "infinite next": ("state n : double = 1e300", "next n =\n    n * 1e12", "y = n"),
    "infinite state": ("state n : double = 1e300", "der n =\n    n * 1e12<1/s>", "y = n"),
    "infinite state among others": (
        "state m : double = 0\n  state n : double = 1e300\n  state o : double = 0",
        "der n =\n    n * 1e12<1/s>",
        "der m = 1<1/s>\n  der o = 2<1/s>\n  y = n + m + o",
    ),
    "infinite next among others": (
        "state m : double = 0\n  state n : double = 1e300\n  state o : double = 0",
        "next n =\n    n * 1e12",
        "next m = m + 1\n  next o = o + 2\n  y = n + m + o",
    ),
    "output after an infinite one": ("state n : double = 1e300", "next n =\n    n * 1e12", "y = 2.0 * n"),
    "infinite next among large values": (
        "state k : double = 1\n  state m : double = 1.7e308\n  state n : double = 1.7e308",
        "next n =\n    n * k",
        "next m = m * 1\n  next k = k + 0.02\n  y = k",
    ),
    "infinite state among large values": (
        "state m : double = 1.7e308\n  state n : double = 1.79e308",
        "der n =\n    n * 1<1/s>",
        "der m = m * 0<1/s>\n  y = n",
    ),
    "infinite next before another fault": (
        "state n : double = 1e300\n  state m : double = 0",
        "next n =\n    n * 1e12",
        "next m = double(int(1 / int(x - 1)))\n  y = n",
    ),
    "derivative among others": (
        "state m : double = 0\n  state n : double = 0\n  state o : double = 0",
        "der n =\n    1<1/s> * double(int(1 / int(x - 1)))",
        "der m = 1<1/s>\n  der o = 2<1/s>\n  y = n + m + o",
    ),
    "let": ("", "let n =\n    int(1 / int(x - 1))", "y = double(n)"),
    "output": ("", "y =\n    double(int(1 / int(x - 1)))", ""),
    "let of a let": ("", "let n =\n    int(1 / int(x - 1))\n  let m =\n    n + n", "y = double(m)"),
    "condition": ("", "y =\n    if x > 0 and\n    1 / int(x - 1) > 0 then 1 else 2", ""),
    "struct": ("", "let n = Pair(\n    a = 1,\n    b = int(1 / int(x - 1)))", "y = double(n.b)"),
    "element": ("let v = [1, 2]", "y =\n    1 +\n    double(v[\n    int(x + 5)])", ""),
    "derivative by a let": ("state n : double = 0", "let d =\n    1<1/s> / (x - 1)", "der n =\n    d\n  y = n"),
    "derivative of an array": (
        "state n : double[2] = [0, 0]",
        "der n = [\n    1<1/s>,\n    1<1/s> * double(int(1 / int(x - 1)))]",
        "y = n[0]",
    ),
    "held part of a let": (
        "state n : double = 0",
        "let d =\n    1<1/s> / (x - 1) - n * 1<1/s>",
        "der n =\n    d\n  y = n",
    ),
    "held part of a derivative": ("state n : double = 0", "der n =\n    1<1/s> / (x - 1) - n * 1<1/s>", "y = n"),
    "input of a submodel": ("inner : Inner", "inner.x =\n    1 +\n    1 / (x - 1)", "y = inner.y"),
    "output of a submodel": ("inner : Inner", "y =\n    inner.y /\n    (x - 1)", "inner.x =\n    x"),
    "operator": ("", "y = pre(\n    1 / (x - 1), 0)", ""),
}
INNER = """
struct Pair { a : int  b : int }
submodel Inner {
  in  x : double
  out y : double

  y = x + 0
}
"""
WHERE = {
    "law": "submodel Outer {\n  in x : double\n  out y : double\n  law : Law\n  law.x = x\n  y = law.y\n}\n"
    "submodel Plant {\n  in x : double\n  out y : double\n  y = 1\n}\n",
    "environment": "submodel Outer {\n  in x : double\n  out y : double\n  y = x\n}\n"
    "submodel Plant {\n  in x : double\n  out y : double\n  law : Law\n  law.x = 1\n"
    "  y = law.y\n}\n",
}


def program(kind: str, where: str) -> str:
    declared, statement, output = STATEMENTS[kind]
    law = LAW.format(declared=declared, statement=statement, output=output)
    return law + WHERE[where] + PROGRAM + INNER


def fault_of(kind: str, where: str, **how: object) -> str:
    """The first line of the summary: the instant of the fault, its text and its place."""
    run = cspdiag.parse(program(kind, where), "case.csp").run(until="50 ms", **how)  # type: ignore[arg-type]
    assert run.outcome.error is not None
    return run.summary().splitlines()[0]


def place_of(fault: str) -> str:
    return re.findall(r"case\.csp:\d+", fault)[-1]


def line_of(kind: str, where: str) -> str:
    _, statement, _ = STATEMENTS[kind]
    line = statement.splitlines()[0].strip()
    return f"case.csp:{1 + [line.strip() for line in program(kind, where).splitlines()].index(line)}"


@pytest.mark.parametrize("where", WHERE)
@pytest.mark.parametrize("kind", STATEMENTS)
def test_a_fault_names_its_statement(kind: str, where: str) -> None:
    faults = {level: fault_of(kind, where, level=level) for level in (0, 1, "reference")}
    assert faults == dict.fromkeys(faults, faults["reference"])
    assert place_of(faults["reference"]) == line_of(kind, where)


@pytest.mark.parametrize(
    ("kind", "where", "level"),
    [(*case, level) for case, level in at_levels(product(STATEMENTS, WHERE))],
)
def test_a_fault_in_c_names_its_statement(kind: str, where: str, level: int) -> None:
    try:
        find_compiler()
    except CompilerError as problem:
        pytest.skip(str(problem))
    fault = fault_of(kind, where, target="c", level=level)
    assert fault == fault_of(kind, where, level="reference")
    assert place_of(fault) == line_of(kind, where)
