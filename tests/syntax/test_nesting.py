"""Programs with the deepest nesting that the parser accepts go through every pass."""

from __future__ import annotations

import pytest

from cspdiag import pipeline
from cspdiag.base import Report, SourceFile
from cspdiag.syntax import ast
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parse.nesting import MAX_DEPTH
from cspdiag.syntax.parser import parse

LEVELS = MAX_DEPTH - 1
EXPRESSIONS = {
    "parentheses": "(" * LEVELS + "x" + ")" * LEVELS,
    "operators": "(x + " * LEVELS + "x" + ")" * LEVELS,
    "chain": "x" + " + x" * LEVELS,
    "calls": "abs(" * LEVELS + "x" + ")" * LEVELS,
    "choices": "if true then x else " * LEVELS + "x",
    "signs": "-" * LEVELS + "x",
}
COMPOSITIONS = {
    "sequences": "(skip ; " * LEVELS + "skip" + ")" * LEVELS,
    "labels": "a: " * LEVELS + "skip",
    "handlers": "skip" + " catch Timeout -> skip" * LEVELS,
    "loops": "mu (" * LEVELS + "skip" + ")" * LEVELS,
    "choices": "if true then (skip) else " * LEVELS + "skip",
}


def law(expression: str) -> str:
    return (
        f"submodel S {{ in x : double out y : double y = {expression} }}\n"
        "process P { in x : double @ 1 ms out y : double @ 1 ms\n"
        "communication { s : S x -> s.x s.y -> y } composition { mu s } }\n"
    )


PROGRAMS = {f"expression of {name}": law(text) for name, text in EXPRESSIONS.items()} | {
    f"composition of {name}": f"process P {{ composition {{ {text} }} }}" for name, text in COMPOSITIONS.items()
}


@pytest.mark.parametrize("text", PROGRAMS.values(), ids=PROGRAMS.keys())
def test_deep_programs_are_read_formatted_and_checked(text: str) -> None:
    report = Report()
    tree = parse(SourceFile(name="case.csp", text=text), report)
    assert not report.diagnostics
    assert ast.same_tree(tree, parse(SourceFile(name="case.csp", text=format_tree(tree)), report))
    pipeline.check(SourceFile(name="case.csp", text=text), lambda path: SourceFile(name=path, text=""))
