"""Checks that submodels that are FMUs declare what their FMU has."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from cspdiag.base import Report, Span
from cspdiag.base.spelling import Speller
from cspdiag.fmu.description import FmuError, FmuVariable, read_description
from cspdiag.model.names.described import fmu_path, is_unit, language_type, unit_text
from cspdiag.model.program import PortSymbol, Program, Scope
from cspdiag.model.types import BoolType, IntType, RealType, Type, UnknownType
from cspdiag.network.diagnostics.external import FmuInProcess, UnusableFmu
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.fmu.description import FmuDescription


def check_fmu(program: Program, definition: ast.SubmodelDefinition, external: ast.External, report: Report) -> None:
    """Reports an FMU that cannot be read, that is used in a process, and ports that it does not have."""
    user = _process_with(program, definition)
    if user is not None:
        report.add(FmuInProcess(external.span, definition.name.text, user.name.text))
        return
    try:
        description = read_description(fmu_path(external))
    except FmuError as problem:
        report.add(UnusableFmu(external.target_span, problem.message, problem.advice))
        return
    if description.co_simulation is None and description.model_exchange is None:
        problem_text = f'"{external.target}" is made neither for co-simulation nor for model exchange'
        report.add(UnusableFmu(external.target_span, problem_text, "export it for co-simulation"))
    for interface, identifier in (
        ("CoSimulation", description.co_simulation),
        ("ModelExchange", description.model_exchange),
    ):
        if external.target.endswith(f":{interface}") and identifier is None:
            text = f'"{external.target}": the FMU has no {interface}'
            report.add(UnusableFmu(external.target_span, text, "leave the interface out"))
    for symbol in program.scopes.get(definition, Scope()).ports.values():
        _check_port(symbol, description, report)
    for parameter in definition.parameters:
        _check_parameter(parameter, program.types.get(parameter), description, report)


def _listed(name: str, names: list[str]) -> str:
    near = Speller().nearest(name, names)
    if near:
        return f"did you mean `{near}`?"
    return f"it has {', '.join(names[:8])}" if names else "it has none"


def _check_port(symbol: PortSymbol, description: FmuDescription, report: Report) -> None:
    variable, name, span = description.named(symbol.name), symbol.name, symbol.port.span
    wanted = "input" if symbol.declaration.direction == "in" else "output"
    if variable is None or (wanted == "input") != (variable.causality == "input"):
        causalities = ("input",) if wanted == "input" else ("output",)
        names = [item.identifier for item in description.variables if item.causality in causalities]
        report.add(UnusableFmu(span, f"the FMU has no {wanted} `{name}`", _listed(name, names)))
        return
    _check_value(name, symbol.type, span, variable, report)


def _check_parameter(parameter: ast.Parameter, type_: Type | None, description: FmuDescription, report: Report) -> None:
    name = parameter.name.text
    variable = description.named(name)
    if variable is None or variable.causality != "parameter":
        names = [item.identifier for item in description.variables if item.causality == "parameter"]
        report.add(UnusableFmu(parameter.span, f"the FMU has no parameter `{name}`", _listed(name, names)))
    elif type_ is not None and not isinstance(type_, UnknownType):
        _check_value(name, type_, parameter.span, variable, report)


def _check_value(name: str, own: Type, span: Span, variable: FmuVariable, report: Report) -> None:
    """Reports another type or unit than that of the variable of the FMU."""
    type_ = language_type(variable)
    if type_ is None or not _fits(own, variable):
        shown = f"{type_}" if type_ else f"{variable.type}, which the language does not have"
        text = f"`{name}` is a {own} here, and in the FMU a {shown}"
        report.add(UnusableFmu(span, text, f"write `{name} : {type_}`" if type_ else f"leave `{name}` out"))
        return
    if isinstance(own, RealType) and variable.unit is not None and not is_unit(own.unit, variable.unit):
        unit = unit_text(variable)
        text = f"`{name}` has the unit {own.unit} here, and {unit or variable.unit.name} in the FMU"
        advice = f"write `{name} : {type_}<{unit}>`" if unit else "convert it in a submodel of your own"
        report.add(UnusableFmu(span, text, advice))


def _fits(type_: Type, variable: FmuVariable) -> bool:
    if variable.type in ("Real", "Float64", "Float32"):
        return isinstance(type_, RealType)
    if variable.type == "Boolean":
        return isinstance(type_, BoolType)
    return isinstance(type_, IntType)


def _process_with(program: Program, definition: ast.SubmodelDefinition) -> ast.ProcessDefinition | None:
    """A process that the submodel is a part of, directly or in other submodels."""
    pending: list[ast.Node] = [definition]
    known = {definition.name.text}
    while pending:
        used = pending.pop()
        for other in program.definitions.values():
            if isinstance(other, ast.ProcessDefinition):
                declared = () if other.communication is None else other.communication.declarations
                if _uses(program, declared, used):
                    return other
            elif isinstance(other, ast.SubmodelDefinition) and other.name.text not in known:
                parts = other.items
                if _uses(program, parts, used):
                    known.add(other.name.text)
                    pending.append(other)
    return None


def _uses(program: Program, items: Iterable[ast.Node], definition: ast.Node) -> bool:
    instances = (item for item in items if isinstance(item, ast.Instance))
    return any(program.bindings.get(item.definition) is definition for item in instances)
