"""The interface of a definition: its parameters and its ports."""

from __future__ import annotations

from cspdiag.model.context import Context, Place, Surroundings
from cspdiag.model.expressions.coercion import Purpose
from cspdiag.model.expressions.declared_types import array_sizes, declared_type
from cspdiag.model.expressions.numbers import Typer
from cspdiag.model.names.scopes import declare, definition_text
from cspdiag.model.program import PortSymbol, Scope
from cspdiag.model.types import TIME, Type
from cspdiag.syntax import ast

WithPorts = ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition


def resolve_header(context: Context, definition: WithPorts) -> None:
    """Type parameters and ports, and enter their names into the scope of the definition."""
    scope = context.program.scopes[definition] = Scope()
    place: Place = "submodel" if isinstance(definition, ast.SubmodelDefinition) else "process"
    typer = Typer(context, Surroundings(place=place, owner=definition, scope=scope, replicators={}, constant=True))
    where = definition_text(definition)
    for parameter in definition.parameters:
        found = declared_type(typer, parameter.type, allows_text=definition.external is not None)
        context.program.types[parameter] = found
        if parameter.default is not None:
            typer.constant(parameter.default, found, _purpose("parameter", parameter.name, parameter.type))
        declare(context, scope, parameter.name, parameter, where)
    for ports in definition.ports:
        _resolve_ports(context, typer, scope, ports, where)
    if not isinstance(definition, ast.DriverDefinition) and definition.wcet is not None:
        typer.constant(definition.wcet, TIME, Purpose(what="a worst-case execution time"))
    if isinstance(definition, ast.SubmodelDefinition) and definition.step is not None:
        typer.constant(definition.step, TIME, Purpose(what="the step of the integration"))


def _resolve_ports(context: Context, typer: Typer, scope: Scope, ports: ast.Ports, where: str) -> None:
    found: Type = declared_type(typer, ports.type)
    if ports.default is not None:
        typer.constant(ports.default, found, _purpose("port", ports.names[0].name, ports.type))
    if ports.safe is not None:
        typer.constant(ports.safe, found, _purpose("port", ports.names[0].name, ports.type))
    if ports.sampling is not None:
        typer.constant(ports.sampling.period, TIME, Purpose(what="a sample period"))
        if ports.sampling.offset is not None:
            typer.constant(ports.sampling.offset, TIME, Purpose(what="the offset of samples"))
    for port in ports.names:
        array_sizes(typer, port.dimensions)
        declare(context, scope, port.name, PortSymbol(declaration=ports, port=port, type=found), where)


def _purpose(kind: str, name: ast.Identifier, type_name: ast.TypeName) -> Purpose:
    return Purpose(what=f"the {kind} `{name.text}`", declared=type_name.span, declared_text="its type")
