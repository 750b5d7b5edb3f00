"""Ports and bodies of definitions."""

from __future__ import annotations

from cspdiag.diagnostics import Report
from cspdiag.model.diagnostics_constants import NotPositive
from cspdiag.model.diagnostics_ports import MisplacedPortOption, MissingComposition
from cspdiag.model.evaluate import evaluate
from cspdiag.model.program import Program
from cspdiag.syntax import ast


def check_ports(program: Program, report: Report) -> None:
    """Check the options of ports, and that a process says what it does."""
    for definition in program.definitions.values():
        if not isinstance(definition, ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition):
            continue
        for ports in definition.ports:
            _check_options(ports, report)
        if isinstance(definition, ast.DriverDefinition):
            continue
        if definition.wcet is not None:
            check_duration(program, definition.wcet, "the worst-case execution time", report)
        if isinstance(definition, ast.ProcessDefinition):
            _check_composition(program, definition, report)


def _check_options(ports: ast.Ports, report: Report) -> None:
    if ports.direction == "in" and ports.safe is not None:
        report.add(MisplacedPortOption(ports.safe.span, option="a safe value", wanted="an out port"))
    if ports.direction == "in" and ports.immediate:
        report.add(MisplacedPortOption(ports.span, option="`immediate`", wanted="an out port"))
    if ports.direction == "out" and ports.default is not None:
        report.add(MisplacedPortOption(ports.default.span, option="a default", wanted="an in port"))


def _check_composition(program: Program, definition: ast.ProcessDefinition, report: Report) -> None:
    if definition.external is None and definition.composition is None:
        report.add(MissingComposition(definition.name.span, name=definition.name.text))
        program.poisoned.add(definition)


def check_duration(program: Program, expression: ast.Expression, what: str, report: Report) -> None:
    """Report a duration that is known and negative."""
    value = evaluate(program, expression, {}, report)
    if isinstance(value, int) and value < 0:
        report.add(NotPositive(expression.span, what=what, value=_shown(value), zero_allowed=True))
        program.poisoned.add(expression)


def _shown(nanoseconds: int) -> str:
    for unit, size in (("s", 10**9), ("ms", 10**6), ("us", 10**3)):
        if nanoseconds % size == 0:
            return f"{nanoseconds // size} {unit}"
    return f"{nanoseconds} ns"
