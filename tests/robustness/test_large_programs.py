"""Programs larger than any written by hand get an answer, not a crash."""

from __future__ import annotations

import pytest

from cspdiag.cli.main import main

LINES = 100_000
DEPTH = 10_000

LEAF = """\
process Leaf {
  in x : int
  out y : int
  communication { var v : int = 0 }
  composition { x ? v ; y ! v }
}
"""


def composition(text: str) -> str:
    return f"process Top {{\n  composition {{\n{text}\n  }}\n}}\n"


def constant(text: str) -> str:
    return f"const c = {text}\n"


PROGRAMS = {
    "lines of comment": "// nothing\n" * LINES + LEAF,
    "lines of constants": "".join(f"const c{number} = {number}\n" for number in range(LINES)),
    "lines of rubbish": ") } ; what\n" * LINES,
    "lines of a composition": composition(" ;\n".join(["skip"] * LINES)),
    "one long line": composition(" ; ".join(["skip"] * DEPTH)),
    "nested parentheses of a composition": composition("(" * DEPTH + "skip" + ")" * DEPTH),
    "parentheses never closed": composition("(" * DEPTH),
    "nested parentheses of an expression": constant("(" * DEPTH + "1" + ")" * DEPTH),
    "nested brackets": constant("[" * DEPTH + "1" + "]" * DEPTH),
    "chain of a sum": constant(" + ".join(["1"] * DEPTH)),
    "chain of a power": constant(" ^ ".join(["1.0"] * DEPTH)),
    "chain of negations": constant("-" * DEPTH + "1"),
    "chain of not": constant("not " * DEPTH + "true"),
    "chain of if": constant("if true then 1 else " * DEPTH + "1"),
    "chain of guards": composition("skip -> " * DEPTH + "skip"),
    "chain of mu": composition("mu " * DEPTH + "skip"),
    "chain of labels": composition("a: " * DEPTH + "skip"),
    "chain of catch": composition("skip" + " catch Timeout -> skip" * DEPTH),
    "nested comments": "/*" * DEPTH,
    "chain of definitions": LEAF
    + "".join(
        f"process P{number} {{ communication {{ p : P{number + 1} }} composition {{ p }} }}\n" for number in range(2000)
    )
    + "process P2000 { composition { skip } }\n",
    "chain of constants": "".join(f"const c{number} = c{number + 1}\n" for number in range(DEPTH))
    + f"const c{DEPTH} = 1\n",
    "a large number of digits": constant("1" * 100_000),
    "a large exponent": constant("1e" + "9" * 10_000),
    "a name of many letters": constant("n" * 100_000),
    "an array without end": "process Top { in x[1000000000000] : int }\n",
    "a replicator without end": composition("par i < 1000000000000 : skip"),
    "a growing replicator": composition("".join(f"par i{n} < 1000 : " for n in range(20)) + "skip"),
    "doubling instances": "".join(
        f"process P{n} {{ communication {{ a : P{n + 1} b : P{n + 1} }} composition {{ a ; b }} }}\n" for n in range(60)
    )
    + "process P60 { composition { skip } }\n",
}


@pytest.mark.parametrize("name", PROGRAMS)
def test_an_answer_is_given(name: str, tmp_path: object, capsys: pytest.CaptureFixture[str]) -> None:
    path = f"{tmp_path}/large.csp"
    with open(path, "w") as file:
        file.write(PROGRAMS[name])
    assert main(["check", path]) in {0, 1}, capsys.readouterr().err[-2000:]
    assert main(["fmt", "--check", path]) in {0, 1}, capsys.readouterr().err[-2000:]
