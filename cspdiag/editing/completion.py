"""Completion: the words of the language that can follow, and the names that mean something there."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Literal, TypeAlias

from cspdiag.base.files.resources import library_names
from cspdiag.base.record import record
from cspdiag.base.span import SourceFile, Span
from cspdiag.editing import descriptions, text_at
from cspdiag.editing.ends import Direction, End, end_at, inner_direction, own_direction
from cspdiag.editing.imports import programs_beside
from cspdiag.editing.view import View
from cspdiag.model.expressions.functions import FUNCTIONS
from cspdiag.model.program import EndLabelSymbol, EnumLiteralSymbol, PortSymbol, Symbol
from cspdiag.model.symbols import BUILTIN_EXCEPTIONS, CONVERSIONS, TYPE_NAMES
from cspdiag.model.types import StructType
from cspdiag.model.units import unit_names
from cspdiag.syntax import ast
from cspdiag.syntax.continuations import Continuations, continuations
from cspdiag.syntax.parse.numbers import UNITS_OF_DURATIONS

Kind: TypeAlias = Literal[
    "class",
    "constant",
    "enum",
    "enum member",
    "event",
    "field",
    "function",
    "interface",
    "keyword",
    "module",
    "property",
    "struct",
    "type parameter",
    "unit",
    "variable",
]


@record
class Completion:
    """What can be written: ``insert`` is the text to insert if that is not the label, ``documentation`` Markdown."""

    label: str
    kind: Kind
    detail: str | None = None
    insert: str | None = None
    documentation: str | None = None


_DEFINITION_KINDS: dict[type, Kind] = {
    ast.Constant: "constant",
    ast.TypeAliasDefinition: "class",
    ast.EnumDefinition: "enum",
    ast.StructDefinition: "struct",
    ast.ExceptionDefinition: "event",
    ast.ProcessDefinition: "class",
    ast.SubmodelDefinition: "function",
    ast.DriverDefinition: "interface",
    ast.EnvironmentDefinition: "module",
}
_LOCAL_KINDS: dict[type, Kind] = {
    PortSymbol: "property",
    ast.Instance: "field",
    ast.Parameter: "type parameter",
    EnumLiteralSymbol: "enum member",
}
_RECOVERED_KINDS: dict[str, Kind] = {
    "in": "property",
    "out": "property",
    "instance": "field",
    "parameter": "type parameter",
}

_DISCARD = Completion("_", "keyword", "the values are discarded")

_LOCAL_RULES = frozenset(["action", "event", "reference", "references", "endpoint", "equation", "channel_reference"])
"""Rules that begin with a name declared in the same definition."""
_ENDS = (PortSymbol, ast.Instance, ast.Variable, ast.Channel, EndLabelSymbol)
_RECOVERED_ENDS = frozenset(["instance", "var", "channel", "label"])
_CARRIES_VALUES = (PortSymbol, ast.Variable, ast.Channel, EndLabelSymbol, ast.Parameter, ast.Let, ast.State)


@record
class _Place:
    """Where completion is requested: in a definition, after some tokens."""

    source: SourceFile
    offset: int
    word: Span
    definition: text_at.Outlined | None
    before: tuple[text_at.Token, ...]

    def previous(self, count: int) -> str:
        """The text of a token before the word, counted backwards from 1."""
        return self.before[-count].text if len(self.before) >= count else ""


def completion(view: View, offset: int) -> list[Completion]:
    """What can be written at an offset, the most probable first."""
    source = view.tree.source
    word = text_at.word_at(source, offset)
    word = Span(source, word.start, offset)
    definition = text_at.definition_at(source, offset)
    start = definition.start if definition is not None else 0
    around = text_at.tokens(source, start, offset)
    if around and around[-1].kind in ("comment", "text") and _is_open(around[-1], offset, source):
        is_imported = around[-1].kind == "text" and len(around) > 1 and around[-2].text == "import"
        return [_item(name, "module") for name in programs_beside(source)] if is_imported else []
    before = text_at.tokens(source, start, word.start)
    found = _Completion(view, _Place(source, offset, word, definition, tuple(_significant(before)))).run(start)
    unique: dict[str, Completion] = {}
    for item in found:
        unique.setdefault(item.label, item)
    return list(unique.values())


def _significant(found: Iterable[text_at.Token]) -> Iterator[text_at.Token]:
    return (token for token in found if token.kind != "comment")


def _is_open(token: text_at.Token, offset: int, source: SourceFile) -> bool:
    """Whether an offset is inside a comment or a text."""
    if offset > token.end:
        return False
    if token.text.startswith("//"):
        return "\n" not in source.text[token.start : offset]
    closing = "*/" if token.text.startswith("/*") else '"'
    return offset < token.end or len(token.text) < 2 or not token.text.endswith(closing)


class _Completion:
    def __init__(self, view: View, place: _Place) -> None:
        self._view = view
        self._program = view.program
        self._place = place

    def run(self, start: int) -> Iterator[Completion]:
        """What can be written, the most probable first."""
        place = self._place
        if place.previous(1) == "." and len(place.before) > 1 and place.before[-2].kind != "number":
            yield from self._members()
            return
        if text_at.is_in_unit(place.before):
            yield from (_item(name, "unit") for name in unit_names())
            return
        if place.before and place.before[-1].kind == "number" and place.previous(2) != "[":
            yield from (_item(name, "unit") for name in UNITS_OF_DURATIONS)
        allowed = self._continuations(start, place.word.start)
        if allowed.accepts_name:
            yield from self._names(allowed.rules)
        for keyword in allowed.keywords:
            yield _item(keyword, "keyword")

    def _continuations(self, start: int, end: int) -> Continuations:
        source = self._place.source
        return continuations(SourceFile(name=source.name, text=source.text[start:end]))

    # Names

    def _names(self, rules: frozenset[str]) -> Iterator[Completion]:
        if "argument" in rules:
            yield from self._arguments()
        if "type_name" in rules:
            yield from self._types()
        if "expression" in rules or "atom" in rules:
            yield from self._values()
        end = end_at(self._place.before, rules)
        if end is not None:
            yield from self._ends(end)
            if end == "sink" and "endpoint" in rules:
                yield _DISCARD
        elif self._place.previous(1) == "reset":
            yield from self._submodels()
        elif not rules.isdisjoint(_LOCAL_RULES):
            yield from self._locals()
        if not rules:
            yield from self._after_keyword()

    def _after_keyword(self) -> Iterator[Completion]:
        """Names of definitions where the grammar only knows that there is a name."""
        match self._place.previous(1):
            case ":":
                yield from self._definitions(self._instantiable())
            case "for" if self._place.previous(3) == "environment":
                yield from self._definitions((ast.ProcessDefinition,))
            case "assert" | "refines":
                yield from self._definitions((ast.ProcessDefinition,))
            case "raise" | "catch":
                yield from self._definitions((ast.ExceptionDefinition,))
                yield from (_described(name, "event", descriptions.builtin(name)) for name in BUILTIN_EXCEPTIONS)
            case "next" | "der":
                yield from self._locals((ast.State,))
            case "import":
                yield from (_item(name, "module") for name in library_names())
            case _:  # A new name, or one that no list has.
                pass

    def _instantiable(self) -> tuple[type, ...]:
        keyword = self._place.definition.keyword if self._place.definition is not None else ""
        if keyword == "environment":
            return ast.SubmodelDefinition, ast.DriverDefinition
        return (ast.SubmodelDefinition,) if keyword == "submodel" else (ast.ProcessDefinition, ast.SubmodelDefinition)

    def _definitions(self, kinds: tuple[type, ...]) -> Iterator[Completion]:
        seen = set()
        for name, definition in self._program.definitions.items():
            if isinstance(definition, kinds):
                seen.add(name)
                yield self._symbol(name, definition)
        # Those that could not be read.
        keywords = {
            "process": ast.ProcessDefinition,
            "submodel": ast.SubmodelDefinition,
            "driver": ast.DriverDefinition,
        }
        for outlined in text_at.definitions(self._place.source):
            kind = keywords.get(outlined.keyword)
            if outlined.name and kind in kinds and kind is not None and outlined.name not in seen:
                yield _item(outlined.name, _DEFINITION_KINDS[kind])

    def _types(self) -> Iterator[Completion]:
        yield from (_item(name, "class") for name in TYPE_NAMES)
        yield from self._definitions((ast.TypeAliasDefinition, ast.EnumDefinition, ast.StructDefinition))

    def _values(self) -> Iterator[Completion]:
        yield from self._locals(None if self._is_submodel() else _CARRIES_VALUES)
        yield from self._definitions((ast.Constant, ast.EnumDefinition, ast.StructDefinition))
        functions = (name for name, each in FUNCTIONS.items() if self._is_submodel() or not each.has_memory)
        for name in (*functions, *CONVERSIONS):
            yield _described(name, "function", descriptions.builtin(name))
        in_equations = ("sample", "time") if self._is_submodel() else ()
        for name in ("pi", *in_equations, *(("now",) if self._is_in_composition() else ())):
            yield _described(name, "constant", descriptions.builtin(name))

    def _is_submodel(self) -> bool:
        return self._place.definition is not None and self._place.definition.keyword == "submodel"

    def _is_in_composition(self) -> bool:
        return any(token.text == "composition" for token in self._place.before)

    def _submodels(self) -> Iterator[Completion]:
        """The instances of submodels, which can be reset."""
        for instance in self._locals():
            definition = self._program.definitions.get(self._definition_of(instance.label) or "")
            if instance.kind == "field" and isinstance(definition, ast.SubmodelDefinition | None):
                yield instance

    def _locals(self, kinds: tuple[type, ...] | None = None) -> Iterator[Completion]:
        """The names that are declared in the definition around the place."""
        definition = self._place.definition
        if definition is None:
            return
        for name, symbol in self._names_of(definition):
            if kinds is None or isinstance(symbol, kinds):
                yield self._symbol(name, symbol)
        for declared in text_at.declared_in(self._place.source, definition):
            is_instance = declared.kind == "instance"
            if declared.start != self._place.word.start and (kinds is None or not is_instance):
                yield self._recovered(declared)

    def _names_of(self, definition: text_at.Outlined) -> Iterator[tuple[str, Symbol]]:
        read = self._program.definitions.get(definition.name)
        scope = self._program.scopes.get(read) if read is not None else None
        if scope is not None and read is not None and read.name.span.start == definition.name_start:
            yield from scope.names.items()

    def _recovered(self, declared: text_at.Declared) -> Completion:
        kind = _RECOVERED_KINDS.get(declared.kind, "variable")
        return _item(declared.name, kind, detail=text_at.written(declared))

    def _ends(self, end: End) -> Iterator[Completion]:
        """The names of the definition around the place that can be an end of an arrow or an equation."""
        definition = self._place.definition
        if definition is None:
            return
        direction = own_direction(end, definition.keyword)
        is_equation = definition.keyword == "submodel"
        for name, symbol in self._names_of(definition):
            if isinstance(symbol, PortSymbol):
                if symbol.declaration.direction == direction:
                    yield self._symbol(name, symbol)
            elif isinstance(symbol, ast.Instance if is_equation else _ENDS):
                yield self._symbol(name, symbol)
        for declared in text_at.declared_in(self._place.source, definition):
            possible = {"instance"} if is_equation else _RECOVERED_ENDS
            if declared.start != self._place.word.start and declared.kind in {direction, *possible}:
                yield self._recovered(declared)

    def _arguments(self) -> Iterator[Completion]:
        """The names of parameters of what is instantiated or called."""
        called = text_at.called(self._place.before)
        definition = self._program.definitions.get(called.name) if called is not None else None
        parts: tuple[ast.Parameter, ...] | tuple[ast.Field, ...] = ()
        if isinstance(definition, ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition):
            parts = definition.parameters
        elif isinstance(definition, ast.StructDefinition):
            parts = definition.fields
        for part in parts:
            if called is not None and part.name.text not in called.named:
                shown = descriptions.described(self._program, None, part, None)
                yield _described(part.name.text, "property", shown, insert=f"{part.name.text} = ")

    # Members

    def _members(self) -> Iterator[Completion]:
        """What can follow a point: ports of an instance, literals of an enum, fields of a struct."""
        path = text_at.path_before(self._place.before)
        if not path:
            return
        first, *rest = path
        definition = self._program.definitions.get(first)
        if isinstance(definition, ast.EnumDefinition) and not rest:
            for index, literal in enumerate(definition.literals):
                yield self._symbol(literal.text, EnumLiteralSymbol(definition=definition, index=index))
            return
        if first == "import" or (self._place.before and self._place.before[0].text == "import"):
            prefix = ".".join(path) + "."
            names = (name for name in library_names() if name.startswith(prefix))
            yield from (_item(name.removeprefix(prefix), "module") for name in names)
            return
        if not rest and not self._is_in_composition():
            yield from self._ports_of(first, self._direction())
        yield from self._fields_of(path)

    def _direction(self) -> Direction | None:
        """The direction that a port of the instance before the point has to have, if only one is possible."""
        place = self._place
        start = text_at.reference_start(place.before, len(place.before))
        rules = self._continuations(place.before[0].start, place.before[start].start).rules
        if self._is_submodel() and "atom" in rules:
            return inner_direction("source")
        end = end_at(place.before[:start], rules)
        return None if end is None else inner_direction(end)

    def _ports_of(self, instance: str, direction: Direction | None) -> Iterator[Completion]:
        name = self._definition_of(instance)
        definition = self._program.definitions.get(name or "")
        scope = self._program.scopes.get(definition) if definition is not None else None
        if scope is not None and not isinstance(definition, ast.EnvironmentDefinition):
            for port, symbol in scope.ports.items():
                if direction in (None, symbol.declaration.direction):
                    yield self._symbol(port, symbol)
        for outlined in text_at.definitions(self._place.source):
            if name is not None and outlined.name == name:
                for declared in text_at.declared_in(self._place.source, outlined):
                    if declared.kind in (("in", "out") if direction is None else (direction,)):
                        yield self._recovered(declared)

    def _definition_of(self, instance: str) -> str | None:
        """The name of what an instance of the definition around the place is an instance of."""
        if self._place.definition is None:
            return None
        symbol = self._symbol_named(instance)
        if isinstance(symbol, ast.Instance):
            return symbol.definition.text
        declared = text_at.declared_in(self._place.source, self._place.definition)
        return next((each.type for each in declared if each.name == instance and each.kind == "instance"), None)

    def _symbol_named(self, name: str) -> Symbol | None:
        definition = self._place.definition
        read = self._program.definitions.get(definition.name) if definition is not None else None
        scope = self._program.scopes.get(read) if read is not None else None
        return scope.names.get(name) if scope is not None else None

    def _fields_of(self, path: list[str]) -> Iterator[Completion]:
        symbol = self._symbol_named(path[0]) or self._program.definitions.get(path[0])
        kind = symbol.type if isinstance(symbol, PortSymbol | EndLabelSymbol) else None
        if isinstance(symbol, ast.Node):
            kind = self._program.types.get(symbol)
        for name in path[1:]:
            kind = kind.field(name) if isinstance(kind, StructType) else None
        struct = self._program.definitions.get(kind.name) if isinstance(kind, StructType) else None
        for field in struct.fields if isinstance(struct, ast.StructDefinition) else ():
            shown = descriptions.described(self._program, None, field, None)
            yield _described(field.name.text, "field", shown)

    def _symbol(self, name: str, symbol: Symbol) -> Completion:
        kind = _DEFINITION_KINDS.get(type(symbol)) or _LOCAL_KINDS.get(type(symbol), "variable")
        return _described(name, kind, descriptions.described(self._program, None, symbol, None))


def _item(name: str, kind: Kind, *, detail: str | None = None) -> Completion:
    return Completion(name, kind, detail)


def _described(name: str, kind: Kind, shown: descriptions.Description, insert: str | None = None) -> Completion:
    return Completion(name, kind, shown.code.split("\n")[0].removesuffix(" {"), insert, shown.doc or None)
