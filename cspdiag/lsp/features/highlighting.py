"""Semantic tokens: colours that depend on what a name means."""

from __future__ import annotations

from collections.abc import Iterator

from lsprotocol import types

from cspdiag.base.span import SourceFile, Span
from cspdiag.editing import text_at
from cspdiag.editing.occurrences import Meaning
from cspdiag.editing.view import View
from cspdiag.lsp.positions import Positions
from cspdiag.model.program import BuiltinSymbol, EndLabelSymbol, EnumLiteralSymbol, PortSymbol
from cspdiag.model.symbols import BUILTIN_EXCEPTIONS, TYPE_NAMES
from cspdiag.syntax import ast
from cspdiag.syntax.parse.automaton import automaton
from cspdiag.syntax.parse.lexer import CONTEXTUAL_KEYWORDS

_TYPES = [
    *("namespace", "type", "class", "enum", "interface", "struct", "parameter", "variable", "property"),
    *("enumMember", "event", "function", "keyword", "comment", "string", "number"),
]
_MODIFIERS = ["declaration", "readonly", "defaultLibrary"]
LEGEND = types.SemanticTokensLegend(_TYPES, _MODIFIERS)

_NAMES: dict[type, str] = {
    ast.Constant: "variable",
    ast.TypeAliasDefinition: "type",
    ast.EnumDefinition: "enum",
    ast.StructDefinition: "struct",
    ast.ExceptionDefinition: "event",
    ast.ProcessDefinition: "class",
    ast.SubmodelDefinition: "function",
    ast.DriverDefinition: "interface",
    ast.EnvironmentDefinition: "namespace",
    ast.Parameter: "parameter",
    ast.Field: "property",
    PortSymbol: "property",
    EnumLiteralSymbol: "enumMember",
    ast.Variable: "variable",
    ast.Channel: "variable",
    ast.Instance: "variable",
    ast.Let: "variable",
    ast.State: "variable",
    ast.Replicator: "variable",
    EndLabelSymbol: "variable",
}
_READ_ONLY = (ast.Constant, ast.Parameter, ast.Replicator, EnumLiteralSymbol, ast.Let)


def semantic_tokens(view: View, positions: Positions, start: int = 0, end: int | None = None) -> types.SemanticTokens:
    """The tokens between two offsets, in the form of the protocol: differences of lines and columns."""
    source = view.tree.source
    data: list[int] = []
    line = column = 0
    for span, kind, modifiers in _tokens(view, source, start, len(source.text) if end is None else end):
        for part in _lines(span):
            place, after = positions.position(source, part.start), positions.position(source, part.end)
            if place.line != line:
                column = 0
            length = after.character - place.character
            data += [place.line - line, place.character - column, length, _TYPES.index(kind), modifiers]
            line, column = place.line, place.character
    return types.SemanticTokens(data)


def _tokens(view: View, source: SourceFile, start: int, end: int) -> Iterator[tuple[Span, str, int]]:
    names = {each.span.start: each for each in view.here}
    words = automaton().tables.words
    start = source.text.rfind("\n", 0, start) + 1
    for token in text_at.tokens(source, start, end):
        span = Span(source, token.start, token.end)
        name = names.get(token.start)
        match token.kind:
            case "word" if name is not None and name.span.end == token.end:
                kind, modifiers = _of(name.meaning)
                yield span, kind, modifiers | (1 if name.is_declaration else 0)
            case "word" if token.text in words and token.text not in CONTEXTUAL_KEYWORDS:
                yield span, "keyword", 0
            case "word" if token.text in TYPE_NAMES:
                yield span, "type", 4
            case "word" if token.text in words:
                yield span, "keyword", 0
            case "word":
                # A name without a meaning, in a text with mistakes.
                pass
            case "comment":
                yield span, "comment", 0
            case "text":
                yield span, "string", 0
            case "number":
                yield span, "number", 0
            case "sign":
                pass


def _of(meaning: Meaning) -> tuple[str, int]:
    """The type of the token of a name, and its modifiers as bits."""
    if isinstance(meaning, BuiltinSymbol):
        if meaning.name in BUILTIN_EXCEPTIONS:
            return "event", 4
        return ("variable", 6) if meaning.name in ("pi", "sample", "time", "now") else ("function", 4)
    return _NAMES[type(meaning)], 2 if isinstance(meaning, _READ_ONLY) and not _is_tunable(meaning) else 0


def _is_tunable(meaning: Meaning) -> bool:
    return isinstance(meaning, ast.Constant) and meaning.tunable


def _lines(span: Span) -> Iterator[Span]:
    """The parts of a span on each line."""
    start = span.start
    for line in span.text.split("\n"):
        if line:
            yield Span(span.source, start, start + len(line))
        start += len(line) + 1
