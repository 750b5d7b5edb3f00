"""Types of calls: values of structs, functions of the language, conversions."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

from cspdiag.model.diagnostics.names import UnknownName
from cspdiag.model.expressions.arguments import matched, report_missing
from cspdiag.model.expressions.coercion import Purpose
from cspdiag.model.expressions.functions import FUNCTIONS, conversion, function
from cspdiag.model.program import BuiltinSymbol
from cspdiag.model.symbols import CONVERSIONS
from cspdiag.model.types import UNKNOWN, StructType, Type
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.model.expressions.expression_typer import ExpressionTyper


def call(typer: ExpressionTyper, node: ast.Call) -> Type:
    """The type of a call: a value of a struct, a function of the language, or a conversion."""
    name = node.function.text
    program = typer.context.program
    definition = program.definitions.get(name)
    structure = program.types.get(definition) if definition is not None else None
    if isinstance(structure, StructType):
        return _structure(typer, node, structure)
    if name in FUNCTIONS:
        program.bindings[node.function] = BuiltinSymbol(name=name)
        return function(typer, node)
    if name in CONVERSIONS:
        program.bindings[node.function] = BuiltinSymbol(name=name)
        return conversion(typer, node)
    for argument in node.arguments:
        typer.infer(argument.value)
    _refuse_function(typer, node, definition)
    return UNKNOWN


def _structure(typer: ExpressionTyper, node: ast.Call, structure: StructType) -> Type:
    definition = typer.context.program.definitions[structure.name]
    if not isinstance(definition, ast.StructDefinition):
        return UNKNOWN
    typer.context.program.bindings[node.function] = definition
    declared, types = definition.name.span, dict(structure.fields)
    matches = matched(typer.context, structure.name, definition.fields, node.arguments, declared)
    example = f"{structure.name}({', '.join(f'{name} = ...' for name in types)})"
    report_missing(typer.context, structure.name, matches, tuple(types), node, example, declared)
    for field in definition.fields:
        argument = matches.values.get(field.name.text)
        if argument is not None:
            purpose = Purpose(
                what=f"the field `{field.name.text}`", declared=field.name.span, declared_text="declared here"
            )
            typer.require(argument.value, types[field.name.text], purpose)
    return structure


_SYNONYMS = {
    "arcsin": "asin", "arccos": "acos", "arctan": "atan", "arctan2": "atan2", "ln": "log", "fabs": "abs", "sgn": "sign",
}  # fmt: skip
"""Functions of this language under their names in other languages."""

_ELSEWHERE = {
    **_SYNONYMS, "clamp": "limit", "clip": "limit", "saturate": "limit", "sat": "limit", "trunc": "int",
    "real": "double",
}  # fmt: skip
"""Names of functions in other languages, and their names in this one."""

_OPERATORS = {"pow": "x ^ y", "power": "x ^ y", "mod": "x % y", "fmod": "x - y * floor(x / y)"}


def _refuse_function(typer: ExpressionTyper, node: ast.Call, definition: ast.Definition | None) -> None:
    name = node.function.text
    typer.context.program.poisoned.add(node)
    if isinstance(definition, ast.StructDefinition):
        # The fields of the struct were refused.
        return
    if definition is not None:
        advice = (
            f"declare an instance: `{name.lower()} : {name}(...)`"
            if isinstance(definition, ast.SubmodelDefinition | ast.ProcessDefinition)
            else None
        )
        typer.context.refuse_kind(node.function.span, name, definition, "a function", advice, node)
    elif not typer.context.excuses_unknown_names:
        structs = (
            found
            for found, given in typer.context.program.definitions.items()
            if isinstance(given, ast.StructDefinition)
        )
        near = _ELSEWHERE.get(name) or typer.context.speller.nearest(name, chain(FUNCTIONS, CONVERSIONS, structs))
        operator = _OPERATORS.get(name)
        typer.context.refuse(
            UnknownName(
                node.function.span,
                name=name,
                expected="function",
                suggestion=None if operator else near,
                declared=None,
                advice=f"write `{operator}`" if operator else None,
                is_synonym=name in _SYNONYMS,
            ),
            node,
        )
