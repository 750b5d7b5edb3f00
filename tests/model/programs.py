"""Programs for the tests of the model."""

from __future__ import annotations

from cspdiag.base import Report, SourceFile
from cspdiag.model.checks.rules import check
from cspdiag.model.names.resolve import resolve
from cspdiag.model.program import Program, Value
from cspdiag.syntax import ast
from cspdiag.syntax.parser import parse


def resolved(text: str, overrides: dict[str, Value] | None = None) -> tuple[Program, Report]:
    """The program of a text after all checks of the model."""
    report = Report()
    tree = parse(SourceFile(name="case.csp", text=text), report)
    assert not report.has_errors, [found.message for found in report.diagnostics]
    program = resolve([tree], overrides or {}, report)
    check(program, report)
    return program, report


def correct(text: str, overrides: dict[str, Value] | None = None) -> Program:
    """A program without diagnostics."""
    program, report = resolved(text, overrides)
    assert not report.diagnostics, [(str(found.span), found.message) for found in report.diagnostics]
    return program


def constant(program: Program, name: str) -> Value:
    """The value of a constant."""
    definition = program.definitions[name]
    assert isinstance(definition, ast.Constant)
    return program.constants[definition]
