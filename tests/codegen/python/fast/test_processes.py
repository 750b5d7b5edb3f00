"""What the generator decides about a process: where its variables are kept, and whether it checks for cancellation."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.render.text import render
from cspdiag.codegen.python.fast.cancellation import checked_classes
from cspdiag.codegen.python.fast.storage import local_variables, rerun_classes
from cspdiag.codegen.python.text.statements import Remark, lines, try_
from cspdiag.network.ir.network import Network, ProcessClass
from cspdiag.optimize import lower_for_targets


def network(text: str) -> Network:
    built = pipeline.build(SourceFile(name="p.csp", text=text), no_file)
    assert built.network is not None, render(built.checked.report.diagnostics)
    return lower_for_targets(built.network)


def no_file(path: str) -> SourceFile:
    raise FileNotFoundError(path)


def process(text: str, name: str = "P") -> ProcessClass:
    found = network(text).class_named(name)
    assert isinstance(found, ProcessClass)
    return found


PROCESS = """
process Source { out o : int  composition { mu o ! 1 } }
process P {
  in c : int
  communication { var x : int%s  var y : int = 0 }
  composition { %s }
}
process Top {
  communication { p : P  source : Source  source.o -> p.c }
  composition { p || source }
}
"""


@pytest.mark.parametrize(
    ("initial", "composition", "local"),
    [
        ("", "c ? x ; y := x", True),
        (" = 1", "y := x ; c ? x", True),
        ("", "if y > 0 then (c ? x) else (x := 1) ; y := x", True),
        ("", "(mu (c ? x) until y == 0) ; y := x", True),
        ("", "if y > 0 then (c ? x) else stop ; y := x", True),
        ("", "((c ? x) interrupt after 1 ms -> skip) ; y := x", False),
        ("", "((c ? x) catch Timeout -> x := 0) ; y := x", True),
    ],
)
def test_variables_are_local_where_every_read_comes_after_a_write(initial: str, composition: str, local: bool) -> None:
    assert ("x" in local_variables(process(PROCESS % (initial, composition)), runs_again=False, probed=False)) == local


def test_what_is_run_again_finds_its_variables_as_they_were() -> None:
    program = """
    process Counter {
      communication { var n : int = 0  var fresh : int }
      composition { n := n + 1 ; fresh := n ; wait fresh * 1 ms }
    }
    process Top {
      communication { one : Counter  two : Counter }
      composition { mu (one || two) }
    }
    """
    lowered = network(program)
    assert rerun_classes(lowered) == {"Counter"}
    assert local_variables(process(program, "Counter"), runs_again=True, probed=False) == {"fresh"}


RACE = """
exception Late
process Writer { out o : int  composition { mu o ! 1 } }
process Reader {
  in i : int
  communication { var n : int = 0 }
  composition { i ? n ; i ? n ; raise Late }
}
process Top {
  communication { writer : Writer  reader : Reader  writer.o -> reader.i  var done : bool = false }
  composition { %s }
}
"""


@pytest.mark.parametrize(
    ("composition", "checked"),
    [
        ("writer || reader", set()),
        ("(writer || reader) catch Late -> skip", set()),
        ("(writer || reader || done := true) catch Late -> skip", {"Top", "Writer", "Reader"}),
        ("(writer || reader) interrupt after 1 ms -> skip", {"Top", "Writer", "Reader"}),
        ("mu ((writer || reader) catch Late -> skip)", {"Writer", "Reader"}),
    ],
)
def test_only_processes_visible_after_a_cancellation_check_for_it(composition: str, checked: set[str]) -> None:
    assert checked_classes(network(RACE % composition)) == checked


def test_a_block_of_which_only_a_comment_is_left_passes() -> None:
    """A value that has no reader leaves nothing but its place."""
    assert lines([try_(Remark("p.csp:3  o ! 1"))]) == [
        "try:",
        "    # p.csp:3  o ! 1",
        "    pass",
    ]


RUNS = Path(__file__).parents[3] / "conformance" / "programs" / "branches_in_runs.csp"


def text_of(program: str, path: str) -> str:
    built = pipeline.build(SourceFile(name="p.csp", text=program), no_file)
    assert built.network is not None, render(built.checked.report.diagnostics)
    files = pipeline.generate(built.network, no_file, "python", 1)
    return next(text for name, text in files.items() if name.endswith(f"/{path}"))


def test_branches_of_an_alternative_share_code_with_those_beside_them_that_count() -> None:
    server = text_of(RUNS.read_text(encoding="utf-8"), "server.py")
    assert "if k == 0:" in server  # nothing is added to the answer of the first
    assert "elif k < 6:" in server
    assert "Alternative(*(Input(self.request[i]) for i in range(20)))" in server


def test_no_chain_of_tests_is_longer_than_a_few_branches() -> None:
    branches = "".join(f" [] input[{i}] ? x -> output ! {i * i + 2} * x % 1000" for i in range(100))
    head = "in input[100] : int  out output : int  communication { var x : int }"
    written = text_of(f"process P {{ {head} composition {{ mu ({branches[4:]}) }} }}", "p.py").splitlines()
    tests = [line.strip() for line in written if " k == " in line or " k < " in line or line.strip().startswith("else")]
    chains = "".join("e" if test.startswith("elif") else "," for test in tests).split(",")
    assert max(map(len, chains)) < 16
    assert sum(map(len, chains)) > 50
