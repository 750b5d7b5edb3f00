"""Programs of the tests, prepared for the interpreter."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

from cspdiag.base import Report, SourceFile
from cspdiag.model.checks.rules import check
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.names.imports import load
from cspdiag.model.names.resolve import resolve
from cspdiag.model.program import Program
from cspdiag.network.check import check as check_network
from cspdiag.network.ir.network import Environment, SubmodelClass
from cspdiag.network.lower import program as lower
from cspdiag.network.submodels.classes import LawUse, flatten
from cspdiag.semantics.equations.laws import Law
from cspdiag.syntax import ast

MS = 1_000_000


def read(path: str) -> SourceFile:
    raise OSError(path)


@cache
def program(text: str) -> Program:
    """A program without errors."""
    report = Report()
    trees = load(SourceFile(name="case.csp", text=text), read, report)
    assert not report.has_errors, [d.message for d in report.diagnostics]
    resolved = resolve(trees, {}, report)
    check(resolved, report)
    check_network(resolved, report)
    assert not report.has_errors, [(d.span.line, d.message) for d in report.diagnostics]
    return resolved


def submodel(
    text: str, name: str, arguments: Mapping[str, Any] | None = None, sample: int = MS, *, environment: bool = False
) -> tuple[SubmodelClass, dict[str, Any]]:
    """The class of a submodel and the values of all its parameters, including defaults."""
    model = program(text)
    definition = model.definitions[name]
    assert isinstance(definition, ast.SubmodelDefinition)
    report = Report()
    values: dict[ast.Node, Any] = {}
    for parameter in definition.parameters:
        value = (arguments or {}).get(parameter.name.text)
        if value is None:
            assert parameter.default is not None, parameter.name.text
            value = evaluate(model, parameter.default, values, report)
        values[parameter] = value
    given = {node.name.text: value for node, value in values.items() if isinstance(node, ast.Parameter)}
    flattened = flatten(model, LawUse(definition, given, sample, {}), report, environment=environment)
    assert flattened is not None
    assert not report.has_errors, [d.message for d in report.diagnostics]
    return flattened.cls, {**given, **flattened.derived}


def instance(text: str, name: str, sample: int = MS, *, environment: bool = False, **arguments: Any) -> Law:
    """An instance of a submodel, ready to run."""
    cls, parameters = submodel(text, name, arguments, sample, environment=environment)
    return Law(cls, parameters)


def environment(text: str, name: str | None = None, overrides: Mapping[str, Any] | None = None) -> Environment:
    """An environment of a program."""
    report = Report()
    network = lower.lower(program(text), None, name, overrides or {}, report)
    assert network is not None, [d.message for d in report.diagnostics]
    return network.environments[0]
