"""Checks of the options of ports, and of durations in definitions."""

from __future__ import annotations

from cspdiag.base import Report
from cspdiag.model.constants.durations import duration
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.diagnostics.constants import NegativeDuration
from cspdiag.model.diagnostics.ports import MisplacedPortOption
from cspdiag.model.program import Program
from cspdiag.syntax import ast


def check_ports(program: Program, report: Report) -> None:
    """Check the options of the ports of all definitions."""
    for definition in program.definitions.values():
        if isinstance(definition, ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition):
            for ports in definition.ports:
                _check_options(ports, report)
        if isinstance(definition, ast.ProcessDefinition | ast.SubmodelDefinition) and definition.wcet is not None:
            check_duration(program, definition.wcet, "the worst-case execution time", report)


def _check_options(ports: ast.Ports, report: Report) -> None:
    if ports.direction == "in" and ports.safe is not None:
        report.add(MisplacedPortOption(ports.safe.span, option="a safe value", expected="an out port"))
    if ports.direction == "in" and ports.immediate:
        report.add(MisplacedPortOption(ports.span, option="`immediate`", expected="an out port"))
    if ports.direction == "out" and ports.default is not None:
        report.add(MisplacedPortOption(ports.default.span, option="a default", expected="an in port"))


def check_duration(program: Program, expression: ast.Expression, what: str, report: Report) -> None:
    """Report a duration that is known to be negative."""
    value = evaluate(program, expression, {}, Report())
    if isinstance(value, int) and value < 0:
        report.add(NegativeDuration(expression.span, what=what, value=duration(value)))
