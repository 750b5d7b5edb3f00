"""The syntax tree → the elements of a communication diagram, even if the program has errors."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias, assert_never

from cspdiag.base import Span
from cspdiag.base.record import replaced
from cspdiag.draw.elements import texts
from cspdiag.draw.elements.accesses import Access, accesses
from cspdiag.draw.elements.boxes import Boxes
from cspdiag.draw.elements.diagram import (
    Arrow,
    CommunicationDiagram,
    End,
    FlowKind,
    ParentPort,
    Sink,
    Store,
    Vertex,
    WrittenValue,
)
from cspdiag.draw.elements.facts import NOTHING, Facts, Flow
from cspdiag.model.program import Program
from cspdiag.network.ir.network import Direction
from cspdiag.syntax import ast

Drawn: TypeAlias = ast.ProcessDefinition | ast.EnvironmentDefinition


def communication_diagram(program: Program, facts: Facts, definition: Drawn, depth: int = 1) -> CommunicationDiagram:
    """The communication diagram of a process or an environment; ``depth`` 2 shows the inside of its process instances,
    and so on.
    """
    return _Extraction(program, facts, definition).diagram(depth, ())


class _Extraction:
    """Collects the elements of one diagram in text order; ``vertices`` are by key."""

    def __init__(self, program: Program, facts: Facts, definition: Drawn) -> None:
        self.program = program
        self.facts = facts
        self.definition = definition
        self.vertices: dict[str, Vertex] = {}
        self.arrows: dict[str, Arrow] = {}
        self.boxes = Boxes(program, facts, definition)
        self.outside = ""
        """In an environment, the key of the process that it is for."""

    def diagram(self, depth: int, within: tuple[Drawn, ...]) -> CommunicationDiagram:
        definition = self.definition
        if isinstance(definition, ast.EnvironmentDefinition):
            self.outside = self.boxes.add_process(definition)
            self.vertices[self.outside] = Sink(key=self.outside)
            declarations: Iterable[ast.Declaration] = definition.declarations
        else:
            self._parent_ports(definition)
            declarations = definition.communication.declarations if definition.communication else ()
        declarations = tuple(declarations)
        self._declare(declarations, ())
        self._relate(declarations, ())
        if isinstance(definition, ast.ProcessDefinition) and definition.composition is not None:
            self._communicate(definition.composition)
        boxes = self.boxes.complete()
        for box in boxes:
            inner = self.boxes.definition_of(box.key)
            if depth > 1 and isinstance(inner, ast.ProcessDefinition) and inner not in (*within, definition):
                inside = _Extraction(self.program, self.facts, inner).diagram(depth - 1, (*within, definition))
                box = replaced(box, inside=inside if inner.external is None else None)
            self.vertices[box.key] = box
        return CommunicationDiagram(
            key=definition.name.text,
            doc=definition.doc,
            spans=(definition.span,),
            parameters=texts.parameters(definition.parameters)
            if isinstance(definition, ast.ProcessDefinition)
            else texts.arguments(definition.arguments),
            environment_of=definition.process.text if isinstance(definition, ast.EnvironmentDefinition) else None,
            vertices=tuple(self.vertices.values()),
            arrows=tuple(self.arrows.values()),
        )

    def _parent_ports(self, definition: ast.ProcessDefinition) -> None:
        for declaration in definition.ports:
            for port in declaration.names:
                name = port.name.text
                self.vertices.setdefault(
                    name,
                    ParentPort(
                        key=name,
                        doc=declaration.doc,
                        spans=(port.span, declaration.span),
                        size=texts.indexes(port.dimensions) or None,
                        direction=declaration.direction,
                        type=texts.written(declaration.type),
                        period=texts.optional(declaration.sampling),
                        periods=self.facts.stated_periods(definition, name),
                        immediate=declaration.immediate,
                        default=texts.optional(declaration.default),
                        safe=texts.optional(declaration.safe),
                        kinds=self.facts.port(definition, name).kinds,
                    ),
                )

    def _declare(self, declarations: Iterable[ast.Declaration], repeated: tuple[str, ...]) -> None:
        for item in declarations:
            match item:
                case ast.Instance():
                    self.vertices.setdefault(item.name.text, Sink(key=item.name.text))
                    self.boxes.add(item, repeated)
                case ast.Variable():
                    initial = texts.optional(item.initial)
                    self._store(Store(key=item.name.text, form="variable", type="", initial=initial), item, item.type)
                case ast.Channel():
                    name, capacity = texts.kind(item.kind)
                    channel = Store(key=item.name.text, form="channel", type="", capacity=capacity, requested=name)
                    self._store(channel, item, item.type)
                case ast.RepeatedDeclarations():
                    self._declare(item.declarations, (*repeated, texts.replicator(item.replicator)))
                case ast.Connection():
                    if item.label is not None and not item.sinks:
                        self._store(Store(key=item.label.text, form="label", type=""), item, item.type)
                case _:
                    assert_never(item)

    def _store(
        self, store: Store, item: ast.Variable | ast.Channel | ast.Connection, declared: ast.TypeName | None
    ) -> None:
        places: tuple[Span, ...] = (item.span,)
        if isinstance(item, ast.Connection):
            # The arrow represents the rest of the relationship.
            places = (item.label.span,) if item.label is not None else ()
        flow = self.facts.channel(self.definition, item)
        written = texts.optional(declared) or ""
        self.vertices.setdefault(store.key, replaced(store, doc=item.doc, spans=places, type=written, kinds=flow.kinds))

    def _relate(self, declarations: Iterable[ast.Declaration], repeated: tuple[str, ...]) -> None:
        for item in declarations:
            if isinstance(item, ast.RepeatedDeclarations):
                self._relate(item.declarations, (*repeated, texts.replicator(item.replicator)))
            elif isinstance(item, ast.Connection):
                self._relationship(item, repeated)

    def _relationship(self, item: ast.Connection, repeated: tuple[str, ...]) -> None:
        sources = tuple(self._end(reference, "out") for reference in item.sources)
        sinks = tuple(
            self._discard(sources) if isinstance(sink, ast.Discard) else self._end(sink, "in") for sink in item.sinks
        )
        if not sinks and item.label is not None:
            sinks = (End(item.label.text),)
        requested, capacity = texts.kind(item.kind)
        flow = self._flow(item, (*sources, *sinks))
        label = item.label.text if item.label is not None and item.sinks else None
        self._arrow(
            Arrow(
                key=label or "",
                doc=item.doc,
                spans=(item.span,),
                sources=sources,
                sinks=sinks,
                label=label,
                type=texts.optional(item.type),
                requested=requested,
                kinds=flow.kinds,
                capacity=capacity,
                periods=flow.periods,
                repeated=repeated,
            )
        )

    def _flow(self, item: ast.Connection, ends: tuple[End, ...]) -> Flow:
        """The flow of the communication object: of the parent's port or the variable at an end, or else of the
        relationship itself.
        """
        for end in ends:
            vertex = self.vertices.get(end.element)
            if isinstance(vertex, ParentPort):
                return self.facts.port(self.definition, vertex.key)
            if isinstance(vertex, Store):
                return Flow(vertex.kinds)
            if isinstance(vertex, Sink) and end.port is None and len(ends) == 2:
                return Flow(("discard",))
            if end.element == self.outside and end.port is not None:
                process = self.boxes.definition_of(self.outside)
                return NOTHING if process is None else self.facts.port(process, end.port.partition("[")[0])
        return self.facts.channel(self.definition, item)

    def _end(self, reference: ast.Reference, direction: Direction) -> End:
        """The element that a reference names, and its port; an undeclared one becomes a box of kind ``unknown``."""
        name = reference.name.text
        if self.outside and reference.member is None:
            return self.boxes.end(self.outside, "", reference.name, texts.indexes(reference.indexes), direction)
        if reference.member is not None or self.boxes.has(name):
            if not self.boxes.has(name):
                if name in self.vertices:
                    return End(name)
                self.vertices.setdefault(name, Sink(key=name))
                self.boxes.add_unknown(reference)
            if reference.member is None:
                return End(name)
            index = texts.indexes(reference.indexes)
            return self.boxes.end(name, index, reference.member, texts.indexes(reference.member_indexes), direction)
        if name not in self.vertices:
            self.vertices[name] = Sink(key=name)
            self.boxes.add_unknown(reference)
            return End(name)
        return End(name, texts.indexes(reference.indexes) or None)

    def _discard(self, sources: tuple[End, ...]) -> End:
        key = f"{', '.join(map(str, sources))} -> _"
        self.vertices.setdefault(key, Sink(key=key))
        return End(key)

    def _communicate(self, composition: ast.Composition) -> None:
        """What the process itself reads and writes."""
        for access in accesses(self.program, composition):
            if access.channel in self.vertices and not self.boxes.has(access.channel):
                if access.is_write:
                    self._written(access)
                else:
                    for store in access.stores:
                        if store in self.vertices:
                            self._by_composition(_end_of(access), End(store), access)

    def _written(self, access: Access) -> None:
        stores = [store for store in access.stores if store in self.vertices]
        if access.is_plain and stores:
            self._by_composition(End(stores[0]), _end_of(access), access)
            return
        key = f"{access.channel} ! {access.text}"
        self.vertices.setdefault(key, WrittenValue(key=key, text=access.text, spans=(access.span,)))
        for store in stores:
            self._by_composition(End(store), End(key), access)
        self._by_composition(End(key), _end_of(access), access)

    def _by_composition(self, source: End, sink: End, access: Access) -> None:
        """An arrow for all accesses of one element by another; its ends are the ports that they name."""
        key = _key(source.element, sink.element, by_composition=True)
        known = self.arrows.get(key)
        if known is not None and known.by_composition:
            self.arrows[key] = replaced(
                known,
                spans=(*known.spans, access.span),
                sources=tuple(dict.fromkeys((*known.sources, source))),
                sinks=tuple(dict.fromkeys((*known.sinks, sink))),
            )
            return
        flow = next((kinds for end in (source, sink) if (kinds := self._kinds(end.element))), ())
        arrow = Arrow(key=key, sources=(source,), sinks=(sink,), spans=(access.span,), by_composition=True, kinds=flow)
        self._arrow(arrow)

    def _kinds(self, key: str) -> tuple[FlowKind, ...]:
        """The kinds of what a communication of the process itself passes through, seen from the port or channel at one
        of its ends.
        """
        match self.vertices.get(key):
            case ParentPort(kinds=kinds) | Store(form="channel", kinds=kinds):
                return kinds
            case _:  # Other elements have no kind, and neither has a missing one.
                return ()

    def _arrow(self, arrow: Arrow) -> None:
        """Add an arrow under its label, or its ends; a second one with the same ends gets a number."""
        key = arrow.key or _key(", ".join(map(str, arrow.sources)), ", ".join(map(str, arrow.sinks)))
        number = 1
        unique = key
        while unique in self.arrows or unique in self.vertices:
            number += 1
            unique = f"{key} ({number})"
        self.arrows[unique] = replaced(arrow, key=unique)


def _key(sources: str, sinks: str, *, by_composition: bool = False) -> str:
    return f"{sources} {'~>' if by_composition else '->'} {sinks}"


def _end_of(access: Access) -> End:
    return End(access.channel, access.index or None)
