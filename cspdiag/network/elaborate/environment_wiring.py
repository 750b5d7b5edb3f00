"""The relationships of an environment, element by element: which port is connected to which."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import assert_never

from cspdiag.base import Report, Span
from cspdiag.base.record import node, record
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.program import PortSymbol, Program, Value
from cspdiag.network.diagnostics.wiring import (
    DriverToSubmodel,
    NotInEnvironment,
    SharedPort,
    TwoSources,
    WrongDirection,
)
from cspdiag.network.ir.network import Direction
from cspdiag.syntax import ast

LIMIT = 100_000
"""Only the first elements of an array, up to this number, are considered."""


@node
class Member:
    """An instance of a submodel or a driver in the environment; ``values`` are those of the replicators around it."""

    name: str
    declaration: ast.Instance
    definition: ast.SubmodelDefinition | ast.DriverDefinition
    values: Mapping[ast.Node, Value]

    @property
    def is_driver(self) -> bool:
        """Whether the member is a driver."""
        return isinstance(self.definition, ast.DriverDefinition)


@record
class Terminal:
    """A port, or element of an array of ports, of the program (then ``member`` is empty) or of a member."""

    member: str
    port: str

    @property
    def name(self) -> str:
        """The name of the terminal, such as ``pan.voltage``; for a port of the program only that of the port."""
        return f"{self.member}.{self.port}" if self.member else self.port


@node
class Wire:
    """A connection from one source to one sink, and where they are named in the text."""

    source: Terminal
    sink: Terminal
    source_span: Span
    span: Span


@node
class Wiring:
    """An environment with its arrays and ``for`` unrolled: its members by name, its wires, and the ports of the program
    that are connected to ``_``.
    """

    members: dict[str, Member]
    wires: tuple[Wire, ...]
    discarded: frozenset[str]


def wiring(
    program: Program, definition: ast.EnvironmentDefinition, values: Mapping[ast.Node, Value], report: Report
) -> Wiring:
    """Unrolls an environment, and reports invalid relationships.

    ``values`` are those of the parameters of its process, on which the sizes of its arrays of ports depend.
    """
    return _Drawing(program, definition, values, report).draw()


class _Drawing:
    def __init__(
        self,
        program: Program,
        definition: ast.EnvironmentDefinition,
        values: Mapping[ast.Node, Value],
        report: Report,
    ) -> None:
        self.program = program
        self.definition = definition
        self.process_values = values
        self.report = report
        self.members: dict[str, Member] = {}
        self.wires: list[Wire] = []
        self.discarded: set[str] = set()

    def draw(self) -> Wiring:
        connections: list[tuple[ast.Connection, Mapping[ast.Node, Value]]] = []
        for item, values in self._drawn_out(self.definition.declarations, {}):
            match item:
                case _ if item in self.program.poisoned:
                    pass
                case ast.Instance():
                    self._instance(item, values)
                case ast.Connection():
                    connections.append((item, values))
                case ast.Variable() | ast.Channel():
                    what = "a variable" if isinstance(item, ast.Variable) else "a channel"
                    self.report.add(NotInEnvironment(item.name.span, what))
                case ast.RepeatedDeclarations():
                    pass
                case _:
                    assert_never(item)
        for connection, values in connections:
            self._connect(connection, values)
        self._refuse_shared()
        return Wiring(members=self.members, wires=tuple(self.wires), discarded=frozenset(self.discarded))

    def _drawn_out(
        self, declarations: tuple[ast.Declaration, ...], values: Mapping[ast.Node, Value]
    ) -> Iterator[tuple[ast.Declaration, Mapping[ast.Node, Value]]]:
        for item in declarations:
            if isinstance(item, ast.RepeatedDeclarations):
                for index in range(self._size(item.replicator.count, values)):
                    yield from self._drawn_out(item.declarations, {**values, item.replicator: index})
            else:
                yield item, values

    def _size(self, expression: ast.Expression, values: Mapping[ast.Node, Value]) -> int:
        value = evaluate(self.program, expression, values, self.report)
        return value if isinstance(value, int) and 0 <= value <= LIMIT else 0

    def _instance(self, instance: ast.Instance, values: Mapping[ast.Node, Value]) -> None:
        definition = self.program.bindings.get(instance.definition)
        if not isinstance(definition, ast.SubmodelDefinition | ast.DriverDefinition):
            return
        size = instance.size
        # Inside `for`, the replicators around count the instances.
        name = instance.name.text + "".join(f"[{index}]" for index in values.values())
        elements: list[tuple[str, Mapping[ast.Node, Value]]] = [(name, values)]
        if size is not None:
            count = size.count if isinstance(size, ast.Replicator) else size
            indexes = range(self._size(count, values))
            inner = {size: 0} if isinstance(size, ast.Replicator) else {}
            elements = [(f"{name}[{i}]", {**values, **dict.fromkeys(inner, i)}) for i in indexes]
        for element, around in elements:
            self.members[element] = Member(name=element, declaration=instance, definition=definition, values=around)

    def _connect(self, connection: ast.Connection, values: Mapping[ast.Node, Value]) -> None:
        if connection.label is not None and not connection.sinks:
            self.report.add(NotInEnvironment(connection.label.span, "a label at the end of an arrow"))
            return
        if connection.kind is not None:
            self.report.add(NotInEnvironment(connection.kind.span, "a kind of channel"))
        for source in connection.sources:
            sources = self._terminals(source, values, "out")
            for sink in connection.sinks:
                if isinstance(sink, ast.Discard):
                    self.discarded.update(terminal.name for terminal in sources or ())
                    continue
                sinks = self._terminals(sink, values, "in")
                for one, other in zip(sources or (), sinks or (), strict=False):
                    self._wire(Wire(source=one, sink=other, source_span=source.span, span=sink.span))

    def _wire(self, wire: Wire) -> None:
        ends = [self.members.get(terminal.member) for terminal in (wire.source, wire.sink)]
        drivers = [end for end in ends if end is not None and end.is_driver]
        if drivers and all(ends):
            self.report.add(DriverToSubmodel(wire.span, drivers[0].name, wire.source.name, wire.sink.name))
        else:
            self.wires.append(wire)

    def _terminals(
        self, reference: ast.Reference, values: Mapping[ast.Node, Value], role: Direction
    ) -> list[Terminal] | None:
        """The elements that a reference names; None if an error in it was reported."""
        if reference in self.program.poisoned:
            return None
        symbol = self.program.bindings.get(reference)
        if reference.member is None:
            if not isinstance(symbol, PortSymbol):
                return None
            member, port, indexes, around = "", symbol, reference.indexes, self.process_values
            # An output of the program is a source in the environment.
            direction: Direction = port.declaration.direction
        else:
            found = self.program.members.get(reference)
            if not isinstance(found, PortSymbol):
                return None
            member = reference.name.text + self._indexes(reference.indexes, values)
            if member not in self.members:
                return None
            port, indexes = found, reference.member_indexes
            direction, around = port.declaration.direction, self.members[member].values
        if direction != role:
            self.report.add(
                WrongDirection(reference.span, reference.span.text, direction, bool(member), port.port.span)
            )
            return None
        names = elements_of(self.program, port, around, self.report)
        if indexes and port.port.dimensions:
            chosen = port.name + self._indexes(indexes, values)
            names = [name for name in names if name == chosen]
        elif indexes:
            self.report.add(NotInEnvironment(reference.span, "an element of a value"))
            return None
        return [Terminal(member, name) for name in names]

    def _indexes(self, indexes: tuple[ast.Expression, ...], values: Mapping[ast.Node, Value]) -> str:
        return "".join(f"[{evaluate(self.program, index, values, self.report)}]" for index in indexes)

    def _refuse_shared(self) -> None:
        """Reports sinks with several sources, and ports of the program that are shared by drivers or with the simulated
        system.
        """
        sources: dict[Terminal, Wire] = {}
        devices: dict[str, tuple[str, Span]] = {}
        for wire in self.wires:
            first = sources.setdefault(wire.sink, wire)
            if first is not wire:
                names = wire.sink.name, first.source.name, wire.source.name
                self.report.add(TwoSources(wire.source_span, *names, first.source_span))
                continue
            for own, other in ((wire.source, wire.sink), (wire.sink, wire.source)):
                if own.member:
                    continue
                member = self.members.get(other.member)
                owner = member.name if member is not None and member.is_driver else ""
                before, span = devices.setdefault(own.port, (owner, wire.span))
                if before != owner:
                    self.report.add(SharedPort(wire.span, own.port, before, owner, span))


def elements_of(program: Program, symbol: PortSymbol, values: Mapping[ast.Node, Value], report: Report) -> list[str]:
    """The names of the elements of an array of ports, or of a single port."""
    total = 1
    for dimension in symbol.port.dimensions:
        size = evaluate(program, dimension, values, report)
        total *= size if isinstance(size, int) and 0 < size <= LIMIT else 0
    if not symbol.port.dimensions:
        return [symbol.name]
    return [f"{symbol.name}[{index}]" for index in range(min(total, LIMIT))]
