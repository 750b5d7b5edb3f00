"""Processes and submodels that contain themselves."""

from __future__ import annotations

from typing import assert_never

from cspdiag.base.graphs import is_circular, shortest_circle, strong_components
from cspdiag.model.context import Context
from cspdiag.model.diagnostics.names import Recursion
from cspdiag.model.symbols import described
from cspdiag.syntax import ast

Composed = ast.ProcessDefinition | ast.SubmodelDefinition


def instances_of(definition: ast.Definition) -> list[ast.Instance]:
    """The instances inside a definition, those in repeated declarations included."""
    found: list[ast.Instance] = []
    pending: list[object] = []
    match definition:
        case ast.ProcessDefinition():
            pending = list(definition.communication.declarations) if definition.communication else []
        case ast.SubmodelDefinition():
            pending = list(definition.items)
        case ast.EnvironmentDefinition():
            pending = list(definition.declarations)
        case (
            ast.Constant() | ast.TypeAliasDefinition() | ast.EnumDefinition() | ast.StructDefinition()
            | ast.ExceptionDefinition() | ast.DriverDefinition()
        ):  # fmt: skip
            pass
        case _:
            assert_never(definition)
    while pending:
        item = pending.pop()
        if isinstance(item, ast.Instance):
            found.append(item)
        elif isinstance(item, ast.RepeatedDeclarations):
            pending += item.declarations
    return found[::-1]


def refuse_recursion(context: Context) -> None:
    """Report each circle of definitions once, and poison the instances that close it."""
    program = context.program
    composed = [item for item in program.definitions.values() if isinstance(item, Composed)]
    instances = {item: instances_of(item) for item in composed}
    needs: dict[Composed, list[Composed]] = {}
    for item in composed:
        inner = [program.bindings.get(instance.definition) for instance in instances[item]]
        needs[item] = [found for found in inner if isinstance(found, Composed)]
    for component in strong_components(composed, needs.__getitem__):
        if not is_circular(component, needs.__getitem__):
            continue
        members = sorted(component, key=lambda item: (item.span.file, item.span.start))
        path = shortest_circle(members, needs.__getitem__)
        inside = set(component)
        closing = [
            instance
            for item in members
            for instance in instances[item]
            if program.bindings.get(instance.definition) in inside
        ]
        cycle = tuple((item.name.text, item.name.span) for item in path)
        kind = described(members[0]).split(" ", 1)[1]
        first = members[0].name
        context.refuse(Recursion(first.span, name=first.text, kind=kind, cycle=cycle), *closing)
