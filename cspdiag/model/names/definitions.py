"""The definitions of a program: collected from all files, with constants and types resolved in the order of their
dependencies.
"""

from __future__ import annotations

from cspdiag.base.graphs import is_circular, shortest_circle, strong_components
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.constants.values import parse_value, with_part
from cspdiag.model.context import Context, Surroundings
from cspdiag.model.diagnostics.names import DuplicateDefinition, DuplicateName, Recursion, ReservedName
from cspdiag.model.diagnostics.types import UnusableValue
from cspdiag.model.expressions.coercion import Purpose
from cspdiag.model.expressions.declared_types import declared_type
from cspdiag.model.expressions.functions import FUNCTIONS
from cspdiag.model.expressions.numbers import Typer
from cspdiag.model.program import Scope, Value
from cspdiag.model.symbols import BUILTIN_EXCEPTIONS, RESERVED_VALUES, TYPE_NAMES, described
from cspdiag.model.types import TEXT, UNKNOWN, EnumType, StructType, Type
from cspdiag.syntax import ast
from cspdiag.syntax.walk import names, nodes

ConstantOrType = ast.Constant | ast.TypeAliasDefinition | ast.StructDefinition


def collect(context: Context) -> None:
    """Enter every definition under its name; imported definitions come first, so a clash is reported in the importing
    file.
    """
    program = context.program
    for tree in reversed(program.trees):
        for item in tree.items:
            if isinstance(item, ast.Import):
                continue
            if isinstance(item, ast.Assertion):
                program.assertions.append(item)
                continue
            name = item.name.text
            first = program.definitions.get(name)
            if first is not None:
                library = first.span.file.removesuffix(".csp").replace("/", ".")
                refused = DuplicateDefinition(
                    item.name.span,
                    name=name,
                    first=first.name.span,
                    library=library if library.startswith("std.") else None,
                )
                context.refuse(refused, item)
                continue
            meaning = _reserved_meaning(item)
            if meaning:
                context.refuse(ReservedName(item.name.span, name=name, meaning=meaning))
            program.definitions[name] = item


def _reserved_meaning(item: ast.Definition) -> str | None:
    name = item.name.text
    match item:
        case ast.Constant() if name in RESERVED_VALUES:
            return reserved_value(name)
        case ast.EnumDefinition() | ast.StructDefinition() | ast.TypeAliasDefinition() if name in TYPE_NAMES:
            return "a type of the language"
        case ast.StructDefinition() if name in FUNCTIONS:
            return "a function of the language"
        case ast.ExceptionDefinition() if name in BUILTIN_EXCEPTIONS:
            return "an exception of the language"
        case _:  # Other names, and kinds of which the language has no definitions of its own.
            return None


def reserved_value(name: str) -> str | None:
    """The meaning of a name that is reserved for a value; None if the name is not reserved."""
    return {
        "time": "the present instant in equations",
        "sample": "the sample period in equations",
        "pi": "the number 3.14159…",
    }.get(name)


def resolve_constants_and_types(context: Context) -> None:
    """Determine types and values of constants, aliases, enums and structs."""
    program = context.program
    for definition in program.definitions.values():
        if isinstance(definition, ast.EnumDefinition):
            names = tuple(literal.text for literal in definition.literals)
            program.types[definition] = EnumType(definition.name.text, names)
            _refuse_duplicates(context, definition.literals, f"the enum `{definition.name.text}`", "a literal")
    settled = [item for item in program.definitions.values() if isinstance(item, ConstantOrType)]
    needs = {item: _needed(context, item) for item in settled}
    for component in strong_components(settled, needs.__getitem__):
        if is_circular(component, needs.__getitem__):
            _refuse_cycle(context, component, needs)
        else:
            _resolve_item(context, component[0])


def _needed(context: Context, item: ConstantOrType) -> list[ConstantOrType]:
    found: list[ConstantOrType] = []
    for part in nodes(item):
        match part:
            case ast.Name():
                name = part.name
            case ast.TypeName():
                name = part.name.text
            case ast.Call():
                name = part.function.text
            case _:  # Any other node.
                continue
        needed = context.program.definitions.get(name)
        if isinstance(needed, ConstantOrType):
            found.append(needed)
    return found


def _refuse_cycle(
    context: Context, component: list[ConstantOrType], needs: dict[ConstantOrType, list[ConstantOrType]]
) -> None:
    members = sorted(component, key=lambda item: (item.span.file, item.span.start))
    cycle = shortest_circle(members, needs.__getitem__)
    first = members[0]
    kind = described(first).removeprefix("a ")
    refused = Recursion(
        first.name.span,
        name=first.name.text,
        kind=kind,
        cycle=tuple((item.name.text, item.name.span) for item in cycle),
    )
    context.refuse(refused, *members)
    for item in members:
        context.program.types[item] = UNKNOWN


def _resolve_item(context: Context, item: ConstantOrType) -> None:
    surroundings = Surroundings(place="constant", owner=item, scope=Scope(), replicators={}, constant=True)
    typer = Typer(context, surroundings)
    match item:
        case ast.Constant():
            _resolve_constant(context, typer, item)
        case ast.TypeAliasDefinition():
            context.program.types[item] = declared_type(typer, item.type)
        case ast.StructDefinition():
            _refuse_duplicates(
                context, tuple(field.name for field in item.fields), f"the struct `{item.name.text}`", "a field"
            )
            fields: dict[str, Type] = {}
            for field in item.fields:
                found = context.program.types[field] = declared_type(typer, field.type)
                fields.setdefault(field.name.text, found)
            context.program.types[item] = StructType(item.name.text, tuple(fields.items()))


def _resolve_constant(context: Context, typer: Typer, item: ast.Constant) -> None:
    program, name = context.program, item.name.text
    if item.type is not None:
        expected = declared_type(typer, item.type)
        purpose = Purpose(what=f"the constant `{name}`", declared=item.type.span, declared_text="its type")
        typer.require(item.value, expected, purpose)
        # The size of an array may be that of the value.
        found = expected
    else:
        found = typer.infer(item.value)
    if found is TEXT:
        advice = "texts are arguments of drivers and of bodies in other languages only"
        context.refuse(UnusableValue(item.value.span, what="a text", advice=advice), item.value)
        found = UNKNOWN
    program.types[item] = found
    override = program.overrides.get(name)
    if isinstance(override, str):
        override = parse_value(found, override)
    known: dict[ast.Node, Value] = dict(program.tunable.items())
    value = override if override is not None else evaluate(program, item.value, known, context.report)
    for path, part in program.overrides.items():
        if value is not None and path.startswith((f"{name}.", f"{name}[")):
            value = with_part(found, value, path[len(name) :], part)
    if value is None:
        program.poisoned.add(item)
    elif item.tunable or (override is None and _follows(context, item)):
        program.tunable[item] = value
    else:
        program.constants[item] = value


def _follows(context: Context, item: ast.Constant) -> bool:
    """Whether the value of a constant changes with a parameter of the program."""
    program = context.program
    return any(program.bindings.get(name) in program.tunable for name in names((item.value,)))


def _refuse_duplicates(context: Context, names: tuple[ast.Identifier, ...], where: str, kind: str) -> None:
    first: dict[str, ast.Identifier] = {}
    for name in names:
        other = first.setdefault(name.text, name)
        if other is not name:
            refused = DuplicateName(
                name.span, name=name.text, where=where, kind=kind, first=other.span, first_kind=kind
            )
            context.refuse(refused, name)
