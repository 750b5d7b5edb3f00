"""The wording of what a name means, for messages, and where it was declared."""

from __future__ import annotations

from typing import assert_never

from cspdiag.base import Span
from cspdiag.model.program import BuiltinSymbol, EndLabelSymbol, EnumLiteralSymbol, PortSymbol, Symbol
from cspdiag.syntax import ast

TYPE_NAMES = ("bool", "int", "int8", "int16", "int32", "uint8", "uint16", "uint32", "double", "float", "time", "text")
CONVERSIONS = ("int", "int8", "int16", "int32", "uint8", "uint16", "uint32", "double", "float")
RESERVED_VALUES = ("time", "sample", "pi")
BUILTIN_EXCEPTIONS = ("Timeout", "Fault")


def described(symbol: Symbol) -> str:
    """What kind of thing a symbol is, with its article: ``a submodel``, ``an in port``."""
    match symbol:
        case ast.Constant(tunable=tunable):
            return "a parameter of the program" if tunable else "a constant"
        case ast.TypeAliasDefinition():
            return "a type"
        case ast.EnumDefinition():
            return "an enum"
        case ast.StructDefinition():
            return "a struct"
        case ast.ExceptionDefinition():
            return "an exception"
        case ast.ProcessDefinition():
            return "a process"
        case ast.SubmodelDefinition():
            return "a submodel"
        case ast.DriverDefinition():
            return "a driver"
        case ast.EnvironmentDefinition():
            return "an environment"
        case ast.Parameter():
            return "a parameter"
        case ast.Variable():
            return "a variable"
        case ast.Channel():
            return "a channel"
        case ast.Instance():
            return f"an instance of `{symbol.definition.text}`"
        case ast.Let():
            return "a local value"
        case ast.State():
            return "a state"
        case ast.Replicator():
            return "a replicator"
        case PortSymbol():
            return f"an {symbol.declaration.direction} port"
        case EndLabelSymbol():
            return "a label" if symbol.ends_arrow else "the label of an arrow"
        case EnumLiteralSymbol():
            return "a literal of an enum"
        case BuiltinSymbol():
            return "a part of the language"
        case _:
            assert_never(symbol)


def declared_at(symbol: Symbol) -> Span | None:
    """Where a symbol's name was declared; None for parts of the language."""
    match symbol:
        case PortSymbol():
            return symbol.port.span
        case EndLabelSymbol():
            label = symbol.connection.label
            return label.span if label else symbol.connection.span
        case EnumLiteralSymbol():
            return symbol.definition.literals[symbol.index].span
        case BuiltinSymbol():
            return None
        case _:  # Everything else is declared with a name.
            return symbol.name.span
