"""Scopes: each name in a definition is declared once."""

from __future__ import annotations

from cspdiag.model.context import Context
from cspdiag.model.diagnostics.names import DuplicateName, ReservedName, ShadowedReplicator
from cspdiag.model.expressions.numbers import Typer
from cspdiag.model.names.definitions import reserved_value
from cspdiag.model.program import EndLabelSymbol, PortSymbol, Scope, Symbol
from cspdiag.model.symbols import declared_at, described
from cspdiag.syntax import ast


def definition_text(definition: ast.Definition) -> str:
    """A definition as it is called in messages: ``the process `Jiwy```."""
    return f"the {described(definition).split(' ', 1)[1]} `{definition.name.text}`"


def declare(context: Context, scope: Scope, name: ast.Identifier, symbol: Symbol, where: str) -> None:
    """Declare a name; a reserved or repeated name is reported, and the first declaration keeps its meaning."""
    text = name.text
    meaning = reserved_value(text)
    if meaning:
        context.refuse(ReservedName(name.span, name=text, meaning=meaning), name)
    first = scope.names.get(text)
    place = declared_at(first) if first is not None else None
    if first is not None and place is not None:
        refused = DuplicateName(
            name.span, name=text, where=where, kind=described(symbol), first=place, first_kind=described(first)
        )
        context.refuse(refused, name)
        if isinstance(symbol, EndLabelSymbol):
            context.program.poisoned.add(symbol.connection)
        elif isinstance(symbol, ast.Node):
            context.program.poisoned.add(symbol)
        return
    scope.names[text] = symbol
    if isinstance(symbol, PortSymbol):
        scope.ports[text] = symbol


def check_replicator(typer: Typer, replicator: ast.Replicator) -> None:
    """Check that a replicator does not hide another name."""
    text = replicator.name.text
    meaning = reserved_value(text)
    if meaning:
        typer.context.refuse(ReservedName(replicator.name.span, name=text, meaning=meaning), replicator)
        return
    symbol = typer.find(text)
    place = declared_at(symbol) if symbol is not None else None
    if symbol is not None and place is not None:
        refused = ShadowedReplicator(replicator.name.span, name=text, kind=described(symbol), first=place)
        typer.context.refuse(refused, replicator)
