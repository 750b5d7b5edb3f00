"""Checks that processes and submodels do not contain themselves."""

from __future__ import annotations

from cspdiag.base.graphs import is_circular, shortest_circle, strong_components
from cspdiag.model.context import Context
from cspdiag.model.diagnostics.names import Recursion
from cspdiag.model.symbols import described
from cspdiag.syntax import ast
from cspdiag.syntax.walk import instances_in

Composed = ast.ProcessDefinition | ast.SubmodelDefinition


def refuse_recursion(context: Context) -> None:
    """Report each cycle of definitions once, and poison the instances that close it."""
    program = context.program
    composed = [item for item in program.definitions.values() if isinstance(item, Composed)]
    instances = {item: list(instances_in(item)) for item in composed}
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
