"""Types as they are declared, with their sizes."""

from __future__ import annotations

from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.diagnostics.constants import BadSize
from cspdiag.model.diagnostics.types import UnusableValue
from cspdiag.model.expressions.coercion import Purpose
from cspdiag.model.expressions.numbers import Typer
from cspdiag.model.expressions.type_names import element_type, in_dimensions
from cspdiag.model.types import INT, TEXT, UNKNOWN, Type
from cspdiag.syntax import ast

LARGEST_SIZE = 100_000
"""The maximum size of an array of values, in each dimension."""


def declared_type(typer: Typer, name: ast.TypeName, *, allows_text: bool = False) -> Type:
    """The declared type, which is recorded for the type name."""
    context = typer.context
    found = element_type(context, name)
    if found is TEXT and not allows_text:
        advice = "texts are parameters of drivers and of bodies in other languages only"
        context.refuse(UnusableValue(name.span, what="a text", advice=advice), name)
        found = UNKNOWN
    sizes = [_array_size(typer, dimension) for dimension in name.dimensions]
    found = in_dimensions(found, sizes)
    context.program.types[name] = found
    return found


def _array_size(typer: Typer, expression: ast.Expression) -> int | None:
    size = size_of(typer, expression, "the size of an array")
    if size is not None and not 0 <= size <= LARGEST_SIZE:
        typer.context.refuse(BadSize(expression.span, size=size, most=LARGEST_SIZE), expression)
        size = typer.context.sizes[expression] = None
    return size


def size_of(typer: Typer, expression: ast.Expression, what: str) -> int | None:
    """A size or a count; None if it depends on parameters, or was reported.

    The limits for numbers of ports, instances and repetitions are checked when these are expanded.
    """
    context = typer.context
    typer.constant(expression, INT, Purpose(what=what))
    value = evaluate(context.program, expression, {}, context.report)
    size = value if isinstance(value, int) else None
    context.sizes[expression] = size
    return size


def array_sizes(typer: Typer, dimensions: tuple[ast.Expression, ...]) -> None:
    """Resolve the sizes of an array of ports."""
    for dimension in dimensions:
        size_of(typer, dimension, "the size of an array of ports")
