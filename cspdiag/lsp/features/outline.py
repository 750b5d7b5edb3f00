"""The outline of a file: definitions with their ports, parts and values; and the definitions of many files."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from lsprotocol import types

from cspdiag.base.span import SourceFile, Span
from cspdiag.editing import text_at
from cspdiag.editing.view import View
from cspdiag.lsp.documents import Documents
from cspdiag.lsp.positions import Positions
from cspdiag.syntax import ast
from cspdiag.syntax.walk import declarations

_KINDS: dict[str, types.SymbolKind] = {
    "const": types.SymbolKind.Constant,
    "parameter": types.SymbolKind.Constant,
    "type": types.SymbolKind.Class,
    "enum": types.SymbolKind.Enum,
    "literal": types.SymbolKind.EnumMember,
    "struct": types.SymbolKind.Struct,
    "field": types.SymbolKind.Field,
    "exception": types.SymbolKind.Event,
    "process": types.SymbolKind.Class,
    "submodel": types.SymbolKind.Function,
    "driver": types.SymbolKind.Interface,
    "environment": types.SymbolKind.Module,
    "in": types.SymbolKind.Property,
    "out": types.SymbolKind.Property,
    "instance": types.SymbolKind.Object,
    "var": types.SymbolKind.Variable,
    "channel": types.SymbolKind.Variable,
    "label": types.SymbolKind.Variable,
    "let": types.SymbolKind.Variable,
    "state": types.SymbolKind.Variable,
}


def outline(view: View, positions: Positions) -> list[types.DocumentSymbol]:
    """The symbols of the main file; definitions that could not be read have those that their tokens show."""
    source = view.tree.source
    read = {item.name.span.start: item for item in view.tree.items if not isinstance(item, ast.Import | ast.Assertion)}
    found: list[types.DocumentSymbol] = []
    for outlined in text_at.definitions(source):
        item = read.get(outlined.name_start)
        if item is not None:
            found.append(_Outline(positions).definition(item, outlined.keyword))
        elif outlined.name:
            found.append(_recovered(source, outlined, positions))
    return found


def symbols(query: str, names: Iterable[str], documents: Documents) -> list[types.WorkspaceSymbol]:
    """The definitions in some files whose names have the letters of ``query``, in this order; what cannot be read
    has none.
    """
    wanted = re.compile(".*".join(map(re.escape, query)), re.IGNORECASE)
    found: list[types.WorkspaceSymbol] = []
    for file in names:
        try:
            source = documents.read(file)
        except (OSError, ValueError):
            continue
        for outlined in text_at.definitions(source):
            if outlined.name and wanted.search(outlined.name):
                name = Span(source, outlined.name_start, outlined.name_start + len(outlined.name))
                place = types.Location(documents.uri(file), documents.positions.range(name))
                found.append(types.WorkspaceSymbol(place, outlined.name, _KINDS[outlined.keyword]))
    return found


def _recovered(source: SourceFile, outlined: text_at.Outlined, positions: Positions) -> types.DocumentSymbol:
    name = Span(source, outlined.name_start, outlined.name_start + len(outlined.name))
    end = outlined.start + len(source.text[outlined.start : outlined.end].rstrip())
    children = [
        _symbol(each.name, each.kind, each.type, place, place, positions)
        for each in text_at.declared_in(source, outlined)
        if each.kind != "parameter"
        for place in (Span(source, each.start, each.start + len(each.name)),)
    ]
    whole = Span(source, outlined.start, max(end, name.end))
    return _symbol(outlined.name, outlined.keyword, "", whole, name, positions, children)


def _symbol(
    name: str,
    kind: str,
    detail: str,
    whole: Span,
    selected: Span,
    positions: Positions,
    children: Iterable[types.DocumentSymbol] = (),
) -> types.DocumentSymbol:
    return types.DocumentSymbol(
        name,
        _KINDS[kind],
        positions.range(whole),
        positions.range(selected),
        detail or None,
        None,
        None,
        list(children),
    )


class _Outline:
    """The symbols of definitions."""

    def __init__(self, positions: Positions) -> None:
        self._positions = positions

    def definition(self, item: ast.Definition, keyword: str) -> types.DocumentSymbol:
        """A definition with what is in it."""
        detail = ""
        if isinstance(item, ast.EnvironmentDefinition):
            detail = f"for {item.process.text}"
        elif isinstance(item, ast.Constant):
            detail = " ".join(item.value.span.text.split())[:60]
        return _symbol(
            item.name.text, keyword, detail, item.span, item.name.span, self._positions, list(self._inside(item))
        )

    def _inside(self, item: ast.Definition) -> Iterator[types.DocumentSymbol]:
        match item:
            case ast.EnumDefinition():
                for literal in item.literals:
                    yield self._named(literal, "literal", "", literal.span)
            case ast.StructDefinition():
                for field in item.fields:
                    yield self._named(field.name, "field", field.type.span.text, field.span)
            case ast.ProcessDefinition():
                yield from self._ports(item.ports)
                if item.communication is not None:
                    yield from self._declared(item.communication.declarations)
            case ast.SubmodelDefinition():
                yield from self._ports(item.ports)
                for part in item.items:
                    if isinstance(part, ast.Let):
                        yield self._named(part.name, "let", "", part.span)
                    elif isinstance(part, ast.State):
                        yield self._named(part.name, "state", part.type.span.text, part.span)
                    elif isinstance(part, ast.Instance):
                        yield self._named(part.name, "instance", part.definition.text, part.span)
            case ast.DriverDefinition():
                yield from self._ports(item.ports)
            case ast.EnvironmentDefinition():
                yield from self._declared(item.declarations)
            case ast.Constant() | ast.TypeAliasDefinition() | ast.ExceptionDefinition():
                pass

    def _ports(self, ports: tuple[ast.Ports, ...]) -> Iterator[types.DocumentSymbol]:
        for declaration in ports:
            for port in declaration.names:
                yield self._named(port.name, declaration.direction, declaration.type.span.text, port.span)

    def _declared(self, block: tuple[ast.Declaration, ...]) -> Iterator[types.DocumentSymbol]:
        for item in declarations(block):
            match item:
                case ast.Instance():
                    yield self._named(item.name, "instance", item.definition.text, item.span)
                case ast.Variable():
                    yield self._named(item.name, "var", item.type.span.text, item.span)
                case ast.Channel():
                    yield self._named(item.name, "channel", item.type.span.text, item.span)
                case ast.Connection():
                    if item.label is not None:
                        detail = "" if item.type is None else item.type.span.text
                        yield self._named(item.label, "label", detail, item.label.span)
                case ast.RepeatedDeclarations():
                    pass

    def _named(self, name: ast.Identifier, kind: str, detail: str, whole: Span) -> types.DocumentSymbol:
        return _symbol(name.text, kind, detail, whole, name.span, self._positions)
