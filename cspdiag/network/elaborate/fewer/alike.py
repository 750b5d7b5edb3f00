"""Compares the neighbourhoods of two programs that differ in sizes alone."""

from __future__ import annotations

from cspdiag.model.program import Program
from cspdiag.network.elaborate.definitions import Definitions
from cspdiag.network.elaborate.fewer.neighbourhoods import Colours, Neighbourhoods, UnknownError
from cspdiag.network.elaborate.fewer.varying import Varying, varying
from cspdiag.network.shapes import Shape
from cspdiag.syntax import ast
from cspdiag.syntax.walk import declared_in


def alike(program: Program, few: Program, most: int) -> Varying | None:
    """What varies between two programs that differ in sizes alone, if all elements have the same neighbourhoods.

    None if they do not, if that is not known, or if the larger program has more than ``most`` instances.
    """
    found = varying(program, few)
    if found is None:
        return None
    definitions, colours = Definitions(program), Colours()
    many, fewer = (
        Neighbourhoods(program, definitions, found, colours),
        Neighbourhoods(few, Definitions(few), found, colours),
    )
    try:
        if _instances(many, definitions) > most:
            return None
        return found if all(many.of(one) == fewer.of(one) for one in found.definitions) else None
    except UnknownError:
        return None


def keeps_values(shape: Shape) -> bool:
    """Whether a relationship between instances of a process is a variable, which is written before it is read only if
    elements run in an order that neighbourhoods do not show.
    """
    return any(
        isinstance(channel.declaration, ast.Connection) and channel.declaration.sinks and channel.kind == "var"
        for channel in shape.channels.values()
    )


def _instances(many: Neighbourhoods, definitions: Definitions) -> int:
    """The number of instances in the largest process, at all levels. Raises UnknownError."""
    inside: dict[ast.ProcessDefinition, int] = {}
    for definition in definitions.order:
        inside[definition] = 1
        for item in declared_in(definition):
            if isinstance(item, ast.RepeatedDeclarations) and any(
                isinstance(inner, ast.Instance) for inner in item.declarations
            ):
                raise UnknownError
            if isinstance(item, ast.Instance):
                count = item.size.count if isinstance(item.size, ast.Replicator) else item.size
                number = 1 if count is None else many.size((count,))
                inside[definition] += number * inside[many.callee(item)]
    return max(inside.values())
