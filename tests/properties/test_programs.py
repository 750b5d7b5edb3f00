"""Every well-typed program checks, compiles, and runs the same way twice."""

from __future__ import annotations

from hypothesis import HealthCheck, given, note, settings

from cspdiag import pipeline
from cspdiag.base import Report, SourceFile
from cspdiag.base.render.text import render
from cspdiag.simulate.record.files import plain_trace_text
from cspdiag.simulate.run.execute import simulate
from cspdiag.syntax import ast
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parser import parse
from tests.properties.programs import programs


def read(path: str) -> SourceFile:
    raise FileNotFoundError(path)


def parsed(text: str) -> ast.SourceTree:
    tree = parse(SourceFile(name="random.csp", text=text), Report())
    assert tree is not None
    return tree


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(programs())
def test_well_typed_program_runs_the_same_twice(text: str) -> None:
    note(text)
    built = pipeline.build(SourceFile(name="random.csp", text=text), read)
    assert built.network is not None, render(built.checked.report.diagnostics)
    files = pipeline.generate(built.network, read)
    first, second = (simulate(built.network, files, until=60_000_000) for _ in range(2))
    assert first.outcome.ended == second.outcome.ended
    assert first.outcome.time == second.outcome.time
    assert plain_trace_text(first) == plain_trace_text(second)


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(programs())
def test_formatting_keeps_the_meaning(text: str) -> None:
    tree = parsed(text)
    formatted = format_tree(tree)
    again = parsed(formatted)
    assert ast.same_tree(tree, again)
    assert format_tree(again) == formatted
