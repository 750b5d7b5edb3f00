"""Names and types in instances: their definitions, sizes and arguments."""

from __future__ import annotations

from cspdiag.model.diagnostics.names import UnknownName
from cspdiag.model.expressions.arguments import matched, report_missing
from cspdiag.model.expressions.coercion import Purpose
from cspdiag.model.expressions.declared_types import size_of
from cspdiag.model.expressions.numbers import Typer
from cspdiag.model.names.scopes import check_replicator
from cspdiag.model.types import UNKNOWN
from cspdiag.syntax import ast

Definitions = tuple[type[ast.Definition], ...]


def bind_definition(typer: Typer, name: ast.Identifier, kinds: Definitions, expected: str) -> ast.Definition | None:
    """Bind the name of a definition of the expected kinds; anything else is reported and gives None."""
    context = typer.context
    definition = context.program.definitions.get(name.text)
    if isinstance(definition, kinds):
        context.program.bindings[name] = definition
        return definition
    context.program.poisoned.add(name)
    if definition is not None:
        advice = None
        if isinstance(definition, ast.EnumDefinition | ast.StructDefinition | ast.TypeAliasDefinition):
            advice = "a variable is declared by `var name : type`"
        elif isinstance(definition, ast.DriverDefinition):
            advice = "drivers belong in environments"
        context.refuse_kind(name.span, name.text, definition, expected, advice, name)
    elif not context.excuses_unknown_names:
        definitions = context.program.definitions
        suggestion = context.speller.nearest(
            name.text, (other for other, found in definitions.items() if isinstance(found, kinds))
        )
        declared = definitions[suggestion].name.span if suggestion else None
        _article, kind = expected.split(" ", 1)
        missing = UnknownName(
            name.span,
            name=name.text,
            expected=kind.replace(" or a ", " or "),
            suggestion=suggestion,
            declared=declared,
            advice=_library(name.text),
        )
        context.refuse(missing, name)
    return None


def _library(name: str) -> str | None:
    from cspdiag.base.files.resources import library_source

    text = library_source("std.control") or ""
    return (
        "write `import std.control` before it" if f"submodel {name}(" in text or f"submodel {name} " in text else None
    )


def resolve_instance(typer: Typer, instance: ast.Instance, kinds: Definitions, expected: str) -> None:
    """Bind the definition; type the size and the arguments."""
    inner = typer
    match instance.size:
        case None:
            pass
        case ast.Replicator():
            check_replicator(typer, instance.size)
            size_of(typer, instance.size.count, "the size of an array of instances")
            inner = typer.within(instance.size)
        case size:  # A size, as an expression.
            size_of(typer, size, "the size of an array of instances")
    definition = bind_definition(typer, instance.definition, kinds, expected)
    if not isinstance(definition, ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition):
        typer.context.program.poisoned.add(instance)
        for argument in instance.arguments:
            inner.before_running().infer(argument.value)
        return
    example = f"{instance.name.text} : {instance.definition.text}"
    resolve_arguments(inner, definition, instance.arguments, instance, instance.definition, example)


def resolve_arguments(
    typer: Typer,
    definition: ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition,
    arguments: tuple[ast.Argument, ...],
    place: ast.Node,
    name: ast.Identifier,
    example: str,
) -> None:
    """Match arguments with the parameters and type them; missing arguments are reported at ``name``."""
    context = typer.context
    declared = definition.name.span
    matches = matched(context, definition.name.text, definition.parameters, arguments, declared)
    needed = [parameter.name.text for parameter in definition.parameters if parameter.default is None]
    given = [argument.span.text for argument in matches.values.values()]
    missing = [f"{other} = ..." for other in needed if other not in matches.values]
    written = f"{example}({', '.join([*given, *missing])})"
    report_missing(context, definition.name.text, matches, needed, name, written, declared)
    if not matches.complete or any(other not in matches.values for other in needed):
        context.program.poisoned.add(place)
    for parameter in definition.parameters:
        argument = matches.values.get(parameter.name.text)
        if argument is not None:
            what = f"the parameter `{parameter.name.text}`"
            purpose = Purpose(what=what, declared=parameter.type.span, declared_text="its type")
            typer.constant(argument.value, context.program.types.get(parameter, UNKNOWN), purpose)
    used = set(matches.values.values())
    for argument in arguments:
        if argument not in used:
            typer.before_running().infer(argument.value)
