"""Type names in the text, and the types that they mean."""

from __future__ import annotations

from itertools import chain

from cspdiag.base import Span
from cspdiag.model.context import Context
from cspdiag.model.diagnostics.names import UnknownName
from cspdiag.model.diagnostics.units import UnitNotAllowed, UnknownUnit
from cspdiag.model.expressions.functions import integer_named
from cspdiag.model.program import Symbol
from cspdiag.model.symbols import TYPE_NAMES, declared_at
from cspdiag.model.types import BOOL, DOUBLE, TEXT, TIME, UNKNOWN, ArrayType, RealType, Type
from cspdiag.model.units import Unit, near_unit, parse_unit
from cspdiag.syntax import ast

_SYNONYMS = {
    "real": "double", "float64": "double", "float32": "float", "single": "float",
    "integer": "int", "boolean": "bool", "logical": "bool",
}  # fmt: skip
"""Types of this language under their names in other languages."""

_OTHER_NAMES = {
    **_SYNONYMS, "number": "double", "int64": "int", "long": "int", "short": "int16", "byte": "uint8",
    "unsigned": "uint32", "char": "uint8", "duration": "time",
}  # fmt: skip
"""Names of types in other languages, and similar types of this one."""

_TEXTS = frozenset(["string", "String", "str"])


def builtin_type(name: str) -> Type | None:
    """The built-in type with a name."""
    match name:
        case "bool":
            return BOOL
        case "double":
            return DOUBLE
        case "float":
            return RealType(32)
        case "time":
            return TIME
        case "text":
            return TEXT
        case "int" | "int8" | "int16" | "int32" | "uint8" | "uint16" | "uint32":
            return integer_named(name)
        case _:  # Any other name.
            return None


def unit_of(context: Context, text: str, span: Span, place: ast.Node) -> Unit | None:
    """The unit between angle brackets; None if it is not a unit, which is reported."""
    unit = parse_unit(text)
    if unit is None:
        context.refuse(UnknownUnit(span, text=text, suggestion=near_unit(text)), place)
    return unit


def element_type(context: Context, name: ast.TypeName) -> Type:
    """The type that a name and its unit mean, without the dimensions; binds the name."""
    found = builtin_type(name.name.text)
    if found is None:
        found = _defined_type(context, name)
    if name.unit is None or found is UNKNOWN:
        return found
    unit = unit_of(context, name.unit, name.unit_span or name.span, name)
    if unit is None:
        return UNKNOWN
    if not isinstance(found, RealType) or found.unit != RealType().unit:
        context.refuse(UnitNotAllowed(name.unit_span or name.span, name=name.name.text, meaning=found), name)
        return UNKNOWN
    return RealType(found.bits, unit)


def _defined_type(context: Context, name: ast.TypeName) -> Type:
    program, text = context.program, name.name.text
    symbol = program.definitions.get(text)
    if isinstance(symbol, ast.EnumDefinition | ast.StructDefinition | ast.TypeAliasDefinition):
        program.bindings[name.name] = symbol
        return program.types.get(symbol, UNKNOWN)
    program.poisoned.add(name)
    if symbol is not None:
        _refuse_kind(context, name, symbol)
    elif not context.excuses_unknown_names:
        types = (
            other
            for other, found in program.definitions.items()
            if isinstance(found, ast.EnumDefinition | ast.StructDefinition | ast.TypeAliasDefinition)
        )
        suggestion = _OTHER_NAMES.get(text) or context.speller.nearest(text, chain(TYPE_NAMES, types))
        near = program.definitions.get(suggestion) if suggestion else None
        declared = declared_at(near) if near is not None else None
        if text in _TEXTS:
            suggestion = None
        advice = "a text is a `text`; only parameters of drivers and of bodies in other languages are texts"
        refused = UnknownName(
            name.name.span,
            name=text,
            expected="type",
            suggestion=suggestion,
            declared=declared,
            advice=advice if text in _TEXTS else None,
            is_synonym=text in _SYNONYMS,
        )
        context.refuse(refused, name)
    return UNKNOWN


def _refuse_kind(context: Context, name: ast.TypeName, symbol: Symbol) -> None:
    advice = None
    if isinstance(symbol, ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition):
        advice = "an instance is declared without `var`, and has a name of its own"
    context.refuse_kind(name.name.span, name.name.text, symbol, "a type", advice, name)


def in_dimensions(element: Type, sizes: list[int | None]) -> Type:
    """The array type with these dimensions; the first dimension is the outermost."""
    if element is UNKNOWN:
        return UNKNOWN
    for size in reversed(sizes):
        element = ArrayType(element, size)
    return element
