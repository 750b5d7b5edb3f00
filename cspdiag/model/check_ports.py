"""Ports and bodies of definitions."""

from __future__ import annotations

import re

from cspdiag.diagnostics import Report
from cspdiag.model.diagnostics_arguments import UnknownOption
from cspdiag.model.diagnostics_constants import NotPositive
from cspdiag.model.diagnostics_ports import BadExternalBody, MisplacedPortOption, MissingBody
from cspdiag.model.evaluate import evaluate
from cspdiag.model.program import Program
from cspdiag.model.scopes import definition_text
from cspdiag.syntax import ast

_LANGUAGES: dict[type[ast.Definition], tuple[str, ...]] = {
    ast.ProcessDefinition: ("python", "c"),
    ast.SubmodelDefinition: ("python", "c", "fmu"),
    ast.DriverDefinition: ("python", "c"),
}
_PYTHON_TARGET = re.compile(r"(?:[^:\s]+\.py|[A-Za-z_][\w.]*):[A-Za-z_]\w*")
_METHODS = ("rk4", "euler", "tustin", "zoh", "backward")


def check_ports(program: Program, report: Report) -> None:
    """Check the options of ports and the bodies in other languages."""
    for definition in program.definitions.values():
        if isinstance(definition, ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition):
            for ports in definition.ports:
                _check_options(program, ports, report)
            _check_body(program, definition, report)


def _check_options(program: Program, ports: ast.Ports, report: Report) -> None:
    if ports.direction == "in" and ports.safe is not None:
        report.add(MisplacedPortOption(ports.safe.span, option="a safe value", wanted="an out port"))
    if ports.direction == "in" and ports.immediate:
        report.add(MisplacedPortOption(ports.span, option="`immediate`", wanted="an out port"))
    if ports.direction == "out" and ports.default is not None:
        report.add(MisplacedPortOption(ports.default.span, option="a default", wanted="an in port"))
    if ports.period is not None:
        check_duration(program, ports.period, "a sample period", report, zero_allowed=False)


def check_duration(
    program: Program, expression: ast.Expression, what: str, report: Report, *, zero_allowed: bool
) -> None:
    """Report a duration that is known and negative, or zero where that has no meaning."""
    value = evaluate(program, expression, {}, report)
    if not isinstance(value, int | float) or value > 0 or (zero_allowed and value == 0):
        return
    shown = _shown(value)
    report.add(NotPositive(expression.span, what=what, value=shown, zero_allowed=zero_allowed))
    program.poisoned.add(expression)


def _shown(nanoseconds: float) -> str:
    for unit, size in (("s", 10**9), ("ms", 10**6), ("us", 10**3)):
        if nanoseconds % size == 0:
            return f"{int(nanoseconds) // size} {unit}"
    return f"{nanoseconds} ns"


def _check_body(
    program: Program,
    definition: ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition,
    report: Report,
) -> None:
    owner = definition_text(definition)
    if definition.external is not None:
        _check_external(definition, definition.external, report)
    match definition:
        case ast.ProcessDefinition():
            has_diagram = definition.communication is not None or definition.composition is not None
            if definition.external is not None and has_diagram:
                _refuse_body(definition, owner, "has two bodies", "remove the diagrams or the external body", report)
            elif definition.external is None and definition.composition is None:
                _refuse_body(definition, owner, "has no composition", "write `composition { ... }`", report)
                program.poisoned.add(definition)
        case ast.DriverDefinition():
            if definition.external is None:
                name = definition.name.text
                advice = f'name its class: `driver {name} python "devices.py:{name}" {{ ... }}`'
                _refuse_body(definition, owner, "has no body", advice, report)
        case ast.SubmodelDefinition():
            if definition.external is not None and definition.items:
                _refuse_body(definition, owner, "has two bodies", "remove the equations or the external body", report)
            method = definition.method
            if method is not None and method.text not in _METHODS:
                report.add(
                    UnknownOption(
                        method.span,
                        owner="the method of a submodel",
                        option=method.text,
                        options=_METHODS,
                        suggestion=None,
                    )
                )
            if definition.step is not None:
                check_duration(program, definition.step, "the step", report, zero_allowed=False)
    if not isinstance(definition, ast.DriverDefinition) and definition.wcet is not None:
        check_duration(program, definition.wcet, "the worst-case execution time", report, zero_allowed=True)


def _refuse_body(definition: ast.Definition, owner: str, problem: str, advice: str, report: Report) -> None:
    report.add(MissingBody(definition.name.span, owner=owner, problem=problem, advice=advice))


def _check_external(definition: ast.Definition, external: ast.External, report: Report) -> None:
    language = external.language.text
    allowed = _LANGUAGES[type(definition)]
    if language not in allowed:
        advice = "choose among " + ", ".join(f"`{name}`" for name in allowed)
        problem = f"a {definition_text(definition).split()[1]} cannot have a body in `{language}`"
        report.add(BadExternalBody(external.language.span, problem=problem, advice=advice))
        return
    target = external.target
    if language == "python" and not _PYTHON_TARGET.fullmatch(target):
        advice = f'name the file and the class: `python "{target.partition(":")[0] or "module.py"}:Class"`'
        problem = f'"{target}" names no Python class'
        report.add(BadExternalBody(external.target_span, problem=problem, advice=advice))
    elif language in {"c", "fmu"} and not target.endswith(f".{language}"):
        report.add(
            BadExternalBody(
                external.target_span,
                problem=f'"{target}" is no .{language} file',
                advice=f'name the file: `{language} "model.{language}"`',
            )
        )
