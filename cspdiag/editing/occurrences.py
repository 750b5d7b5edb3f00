"""The places in a file at which a name is declared or used, with what it means there."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Iterable, Iterator
from typing import TypeAlias

from cspdiag.base.record import record
from cspdiag.base.span import Span
from cspdiag.model.program import BuiltinSymbol, EndLabelSymbol, EnumLiteralSymbol, PortSymbol, Program, Symbol
from cspdiag.model.types import StructType
from cspdiag.syntax import ast
from cspdiag.syntax.walk import nodes

Meaning: TypeAlias = Symbol | ast.Field
"""What a name means."""

Owner: TypeAlias = (
    ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition | ast.EnvironmentDefinition | None
)
"""The definition in which a name is local."""

_WITH_PARAMETERS = (ast.ProcessDefinition, ast.SubmodelDefinition, ast.DriverDefinition)
_OWNERS = (*_WITH_PARAMETERS, ast.EnvironmentDefinition)


@record
class Occurrence:
    """A name at a place; ``owner`` is the definition around it."""

    span: Span
    meaning: Meaning
    owner: Owner
    is_declaration: bool


def name_place(meaning: Meaning) -> Span | None:
    """Where a name was declared; None for parts of the language."""
    match meaning:
        case PortSymbol():
            return meaning.port.name.span
        case EndLabelSymbol():
            return meaning.connection.label.span if meaning.connection.label else None
        case EnumLiteralSymbol():
            return meaning.definition.literals[meaning.index].span
        case BuiltinSymbol():
            return None
        case _:  # Everything else is declared with a name.
            return meaning.name.span


class Occurrences:
    """All occurrences in a file, in text order."""

    def __init__(self, program: Program, tree: ast.SourceTree) -> None:
        found = {each.span.start: each for item in tree.items for each in _Finder(program, item).run()}
        self.all = [found[start] for start in sorted(found) if found[start].span.source is tree.source]
        self._starts = [each.span.start for each in self.all]

    def __iter__(self) -> Iterator[Occurrence]:
        return iter(self.all)

    def at(self, offset: int) -> Occurrence | None:
        """The occurrence at an offset or just before it."""
        position = bisect_right(self._starts, offset) - 1
        if position >= 0 and offset <= self.all[position].span.end:
            return self.all[position]
        return None


class _Finder:
    """The occurrences in one definition, import or assertion."""

    def __init__(self, program: Program, item: ast.Item) -> None:
        self._program = program
        self._item = item
        self._owner: Owner = item if isinstance(item, _OWNERS) else None
        self._scope = program.scopes.get(item)

    def run(self) -> Iterator[Occurrence]:
        for found in nodes(self._item):
            for place, meaning in self._in_node(found):
                if meaning is not None and place is not None:
                    declared = name_place(meaning)
                    is_declaration = declared is not None and (declared.source, declared.start) == (
                        place.source,
                        place.start,
                    )
                    yield Occurrence(place, meaning, self._owner, is_declaration)

    def _in_node(self, item: ast.Node) -> Iterable[tuple[Span | None, Meaning | None]]:
        program = self._program
        match item:
            case ast.Reference():
                yield item.name.span, program.bindings.get(item)
                if item.member is not None:
                    yield item.member.span, self._member(item)
            case ast.Name():
                yield _word(item.span, item.name), program.bindings.get(item)
            case ast.Member():
                yield item.name.span, self._field(item) or self._member(item) or program.bindings.get(item.name)
            case ast.TypeName():
                yield item.name.span, program.definitions.get(item.name.text)
            case ast.Call():
                function = program.definitions.get(item.function.text)
                yield item.function.span, function or BuiltinSymbol(name=item.function.text)
                if isinstance(function, ast.StructDefinition):
                    yield from _named(item.arguments, {each.name.text: each for each in function.fields})
            case ast.Ports():
                for port in item.names:
                    yield port.name.span, self._scope.ports.get(port.name.text) if self._scope else None
            case ast.EnumDefinition():
                yield item.name.span, item
                for index, literal in enumerate(item.literals):
                    yield literal.span, EnumLiteralSymbol(definition=item, index=index)
            case ast.Instance():
                yield item.name.span, item
                definition = program.bindings.get(item.definition)
                yield item.definition.span, definition
                yield from self._arguments(item.arguments, definition)
            case ast.EnvironmentDefinition():
                yield item.name.span, item
                process = program.bindings.get(item.process)
                yield item.process.span, process
                yield from self._arguments(item.arguments, process)
                inside = program.scopes[process].names if isinstance(process, ast.ProcessDefinition) else {}
                for place in item.places:
                    for instance in place.instances:
                        placed = inside.get(instance.text)
                        yield instance.span, placed if isinstance(placed, ast.Instance) else None
            case ast.Assertion():
                process = program.definitions.get(item.process.text)
                yield item.process.span, process
                if item.specification is not None:
                    yield item.specification.span, program.definitions.get(item.specification.text)
                scope = program.scopes.get(process) if process is not None else None
                for hidden in item.hidden:
                    yield hidden.span, scope.ports.get(hidden.text) if scope is not None else None
            case ast.Raise() | ast.Catch():
                yield item.exception.span, program.bindings.get(item.exception)
            case ast.Next() | ast.Derivative():
                yield item.name.span, self._scope.names.get(item.name.text) if self._scope else None
            case ast.Connection():
                if item.label is not None:
                    yield item.label.span, program.bindings.get(item.label)
            case (
                ast.Constant() | ast.TypeAliasDefinition() | ast.StructDefinition() | ast.ExceptionDefinition()
                | ast.ProcessDefinition() | ast.SubmodelDefinition() | ast.DriverDefinition() | ast.Parameter()
                | ast.Variable() | ast.Channel() | ast.Let() | ast.State() | ast.Replicator() | ast.Field()
            ):  # fmt: skip
                yield item.name.span, item
            case _:  # Nothing else has a name of its own.
                pass

    def _member(self, item: ast.Reference | ast.Member) -> Meaning | None:
        found = self._program.members.get(item)
        return None if isinstance(found, str) else found

    def _field(self, item: ast.Member) -> Meaning | None:
        owner = self._program.types.get(item.value)
        if not isinstance(owner, StructType):
            return None
        struct = self._program.definitions.get(owner.name)
        fields = struct.fields if isinstance(struct, ast.StructDefinition) else ()
        return next((field for field in fields if field.name.text == item.name.text), None)

    def _arguments(
        self, arguments: tuple[ast.Argument, ...], definition: object
    ) -> Iterable[tuple[Span | None, Meaning | None]]:
        if isinstance(definition, _WITH_PARAMETERS):
            yield from _named(arguments, {each.name.text: each for each in definition.parameters})


def _named(
    arguments: tuple[ast.Argument, ...], names: dict[str, ast.Parameter] | dict[str, ast.Field]
) -> Iterable[tuple[Span | None, Meaning | None]]:
    for argument in arguments:
        if argument.name is not None:
            yield argument.name.span, names.get(argument.name.text)


def _word(span: Span, word: str) -> Span | None:
    """Where a word is in a span that may have parentheses around it."""
    if span.end - span.start == len(word):
        return span
    found = re.compile(rf"\b{re.escape(word)}\b").search(span.source.text, span.start, span.end)
    return Span(span.source, found.start(), found.end()) if found else None
