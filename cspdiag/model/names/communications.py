"""Names and types in communication blocks and environments."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.model.expressions.coercion import Purpose
from cspdiag.model.expressions.declared_types import declared_type, size_of
from cspdiag.model.expressions.numbers import Typer
from cspdiag.model.names.instances import Definitions, resolve_instance
from cspdiag.model.names.references import end_of_channel
from cspdiag.model.names.scopes import check_replicator, declare
from cspdiag.model.program import EndLabelSymbol
from cspdiag.model.types import INT, UNKNOWN, Type
from cspdiag.syntax import ast


def resolve_declarations(
    typer: Typer, declarations: Sequence[ast.Declaration], where: str, kinds: Definitions, expected: str
) -> None:
    """Resolve declarations. All names are declared first, so a name may be used before its declaration."""
    _declare_all(typer, declarations, where, repeated=False)
    _resolve_all(typer, declarations, kinds, expected)
    _connect_all(typer, declarations, where)


def _declare_all(typer: Typer, declarations: Sequence[ast.Declaration], where: str, *, repeated: bool) -> None:
    for item in declarations:
        match item:
            case ast.Instance() | ast.Variable() | ast.Channel():
                if repeated and isinstance(item, ast.Instance):
                    typer.context.repeated.add(item)
                declare(typer.context, typer.surroundings.scope, item.name, item, where)
            case ast.RepeatedDeclarations():
                _declare_all(typer, item.declarations, where, repeated=True)
            case ast.Connection():
                pass


def _resolve_all(typer: Typer, declarations: Sequence[ast.Declaration], kinds: Definitions, expected: str) -> None:
    types = typer.context.program.types
    for item in declarations:
        match item:
            case ast.Instance():
                resolve_instance(typer, item, kinds, expected)
            case ast.Variable():
                types[item] = declared_type(typer, item.type)
                if item.initial is not None:
                    what = f"the variable `{item.name.text}`"
                    purpose = Purpose(what=what, declared=item.type.span, declared_text="its type")
                    typer.constant(item.initial, types[item], purpose)
            case ast.Channel():
                types[item] = declared_type(typer, item.type)
                _resolve_kind(typer, item.kind)
            case ast.RepeatedDeclarations():
                check_replicator(typer, item.replicator)
                size_of(typer, item.replicator.count, "the count of a replicator")
                _resolve_all(typer.within(item.replicator), item.declarations, kinds, expected)
            case ast.Connection():
                pass


def _resolve_kind(typer: Typer, kind: ast.Kind | None) -> None:
    if kind is not None and kind.capacity is not None:
        typer.constant(kind.capacity, INT, Purpose(what="the capacity of a channel"))


def _connect_all(typer: Typer, declarations: Sequence[ast.Declaration], where: str) -> None:
    for item in declarations:
        if isinstance(item, ast.RepeatedDeclarations):
            _connect_all(typer.within(item.replicator), item.declarations, where)
        elif isinstance(item, ast.Connection):
            _resolve_connection(typer, item, where)


def _resolve_connection(typer: Typer, connection: ast.Connection, where: str) -> None:
    context = typer.context
    types = [end_of_channel(typer, source, "source") for source in connection.sources]
    declared = declared_type(typer, connection.type) if connection.type is not None else None
    _resolve_kind(typer, connection.kind)
    if connection.label is not None:
        # The label is declared before the sinks, but a sink cannot refer to it: it is the value that the arrow passes.
        known = next((found for found in types if found is not UNKNOWN), UNKNOWN)
        label: Type = declared if declared is not None else known
        symbol = EndLabelSymbol(connection=connection, type=label, ends_arrow=not connection.sinks)
        declare(context, typer.surroundings.scope, connection.label, symbol, where)
        context.program.bindings[connection.label] = symbol
    for sink in connection.sinks:
        if isinstance(sink, ast.Reference):
            end_of_channel(typer, sink, "sink")
