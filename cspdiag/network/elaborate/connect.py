"""Connects the relationships of a communication diagram: finds what each port of each instance is attached to."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TypeAlias, assert_never

from cspdiag.base import Span
from cspdiag.base.record import node
from cspdiag.model.program import Value
from cspdiag.model.types import UNKNOWN, Type
from cspdiag.network.diagnostics.arrays import ArraysDiffer
from cspdiag.network.diagnostics.connections import (
    ConnectedTwice,
    JoinsTwoObjects,
    NotConnected,
    OpenPort,
    PortEndsInLabel,
    PortToPort,
)
from cspdiag.network.elaborate.array_sizes import check_sizes
from cspdiag.network.elaborate.expression import LoweringContext, lower_expression
from cspdiag.network.elaborate.places import ChannelPlace, Endpoint, InstancePort, Places, ProcessPort
from cspdiag.network.elaborate.sizes import Sizes
from cspdiag.network.shapes import (
    Attached,
    AttachmentShape,
    ChannelShape,
    Default,
    Discarded,
    InstanceShape,
    OwnChannel,
    OwnPort,
    RequestedKind,
    Shape,
    Unresolved,
    element_name,
)
from cspdiag.syntax import ast

Values: TypeAlias = Mapping[ast.Node, Value]


def connect(sizes: Sizes, shape: Shape, places: Places, declarations: Iterable[ast.Declaration]) -> None:
    """Makes the channels of a shape, and attaches the ports of its instances."""
    connector = _Connector(sizes, shape, places)
    items = tuple(declarations)
    connector.declare(items, (), shape.values)
    connector.relate(items, shape.values)
    connector.complete()


@node
class _Ends:
    """The ends of one relationship, element by element."""

    ports: dict[str, ProcessPort]
    channels: dict[str, ChannelPlace]
    instances: list[InstancePort]


class _Connector:
    def __init__(self, sizes: Sizes, shape: Shape, places: Places) -> None:
        self.sizes = sizes
        self.program = sizes.program
        self.report = sizes.report
        self.shape = shape
        self.places = places

    def declare(self, declarations: Iterable[ast.Declaration], prefix: tuple[int, ...], values: Values) -> None:
        """Makes variables and channels, which relationships may use before their declaration in the text."""
        for item in declarations:
            match item:
                case ast.Variable() | ast.Channel():
                    self._declare(item, prefix, values)
                case ast.RepeatedDeclarations():
                    for index, inner in enumerate(self._repeated(item, values)):
                        self.declare(item.declarations, (*prefix, index), inner)
                case ast.Instance() | ast.Connection():
                    pass
                case _:
                    assert_never(item)

    def relate(self, declarations: Iterable[ast.Declaration], values: Values) -> None:
        """Connects all relationships. Their labels can be used in the composition only, so their order does
        not matter.
        """
        for item in declarations:
            match item:
                case ast.Connection():
                    self._relationship(item, values)
                case ast.RepeatedDeclarations():
                    self._relate_repeated(item, values)
                case ast.Instance() | ast.Variable() | ast.Channel():
                    pass
                case _:
                    assert_never(item)

    def _relate_repeated(self, item: ast.RepeatedDeclarations, values: Values) -> None:
        repetitions = self._repeated(item, values)
        outermost = not any(isinstance(key, ast.Replicator) for key in values)
        known: dict[ast.Declaration, list[Sequence[Endpoint]] | None] = {
            inner: self._in_all_repetitions(inner, item.replicator, len(repetitions))
            for inner in item.declarations
            if outermost and isinstance(inner, ast.Connection)
        }
        for index, inside in enumerate(repetitions):
            for declaration in item.declarations:
                ends = known.get(declaration)
                if ends is None:
                    self.relate((declaration,), inside)
                else:
                    assert isinstance(declaration, ast.Connection)
                    self._connect(declaration, [each[index] for each in ends], inside, None)

    def _in_all_repetitions(
        self, item: ast.Connection, replicator: ast.Replicator, count: int
    ) -> list[Sequence[Endpoint]] | None:
        """The ends of a relationship in each repetition, by reference, if each reference means a port of an instance;
        None if they have to be found one by one.
        """
        found: list[Sequence[Endpoint]] = []
        for reference in (*item.sources, *item.sinks):
            if isinstance(reference, ast.Discard):
                return None
            ends = self.places.in_all_repetitions(reference, replicator, count)
            if ends is None:
                return None
            found.append(ends)
        return found

    def complete(self) -> None:
        """Gives unconnected inputs their defaults, and reports all other unconnected ports."""
        for instance in self.shape.instances.values():
            missing: list[str] = []
            for port, element, key in instance.shape.port_elements():
                if element in instance.attachments:
                    continue
                name = instance.declaration.name.text
                excused = not self.places.excused.isdisjoint(((name, port.name), (name, None)))
                if port.direction == "in" and port.symbol.declaration.default is not None:
                    self._attach(instance, element, Default(port.name), instance.span)
                elif excused or self.shape.incomplete or instance.shape.incomplete:
                    self._attach(instance, element, Unresolved(), instance.span)
                else:
                    missing.append(key)
                    self._attach(instance, element, Unresolved(), instance.span)
            if missing:
                self._report_missing(instance, missing)

    def _report_missing(self, instance: InstanceShape, missing: list[str]) -> None:
        ports = {element_name(*element): port for port, element, _ in instance.shape.port_elements()}
        self.report.add(
            NotConnected(
                span=instance.span,
                instance=instance.name,
                definition=instance.shape.name,
                ports=tuple(OpenPort(key, ports[key].direction, ports[key].span) for key in missing),
            )
        )

    def _repeated(self, item: ast.RepeatedDeclarations, values: Values) -> list[dict[ast.Node, Value]]:
        return self.sizes.repeated(item.replicator, "`for`", values) or []

    def _declare(self, item: ast.Variable | ast.Channel, prefix: tuple[int, ...], values: Values) -> None:
        name = element_name(item.name.text, *prefix)
        known = self.sizes.type_of(item.type, self.program.types.get(item, UNKNOWN), values)
        channel = ChannelShape(name, item, known, item.name.span)
        match item:
            case ast.Variable(initial=initial):
                if initial is not None:
                    known_here = channel.replicators = dict(_known(values))
                    channel.initial = lower_expression(self.program, initial, LoweringContext(values=known_here))
            case ast.Channel(kind=kind):
                channel.requested = None if kind is None else self._requested(kind, values)
            case _:
                assert_never(item)
        self.shape.channels[name] = channel

    def _requested(self, kind: ast.Kind, values: Values) -> RequestedKind:
        capacity = None
        if kind.capacity is not None:
            capacity = self.sizes.size(kind.capacity, f"the `{kind.name}`", values) or 1
        return RequestedKind(kind.name, kind.span, capacity)

    def _relationship(self, item: ast.Connection, values: Values) -> None:
        """Connects one relationship, whole arrays element by element."""
        found: list[tuple[list[Endpoint], bool]] = []
        resolved = True
        for reference in (*item.sources, *item.sinks):
            if isinstance(reference, ast.Discard):
                continue
            ends = self.places.endpoints(reference, values)
            if ends is None:
                resolved = False
            else:
                found.append(ends)
        if not resolved or item in self.program.poisoned:
            self._give_up([end for ends, _ in found for end in ends])
            return
        if not any(whole for _, whole in found):
            self._connect(item, [ends[0] for ends, _ in found], values, None)
            return
        sizes = {len(ends) for ends, _ in found}
        if len(sizes) > 1 or not all(whole for _, whole in found):
            self._report_sizes(item, found)
            return
        for index in range(sizes.pop()):
            self._connect(item, [ends[index] for ends, _ in found], values, index)

    def _report_sizes(self, item: ast.Connection, found: list[tuple[list[Endpoint], bool]]) -> None:
        largest = max(found, key=lambda ends: len(ends[0]))
        other = next((ends for ends in found if len(ends[0]) != len(largest[0]) or not ends[1]), largest)
        self.report.add(
            ArraysDiffer(
                span=largest[0][0].span, size=len(largest[0]), other=other[0][0].span, other_size=len(other[0])
            )
        )
        self._give_up([end for ends, _ in found for end in ends])

    def _give_up(self, ends: list[Endpoint]) -> None:
        """Counts the ends of a relationship that was reported as connected."""
        self.shape.has_unknown_uses = True
        for end in ends:
            match end:
                case InstancePort():
                    end.instance.attachments.setdefault(end.element, Attached(target=Unresolved(), span=end.span))
                case ProcessPort():
                    self.shape.port_spans.setdefault(end.key, end.span)
                case ChannelPlace():
                    end.channel.excused = True
                case _:
                    assert_never(end)

    def _connect(self, item: ast.Connection, ends: list[Endpoint], values: Values, index: int | None) -> None:
        instances = [end for end in ends if isinstance(end, InstancePort)]
        if len(instances) == len(ends):
            target = self._between(item, instances, values, index)
        else:
            sorted_ends = _Ends(
                ports={end.key: end for end in ends if isinstance(end, ProcessPort)},
                channels={end.channel.name: end for end in ends if isinstance(end, ChannelPlace)},
                instances=instances,
            )
            target = self._target(item, sorted_ends, values, index)
        for end in instances:
            self._attach(end.instance, end.element, target, end.span)

    def _target(self, item: ast.Connection, ends: _Ends, values: Values, index: int | None) -> AttachmentShape:
        """The channel, port or ``_`` that the ports of instances in this relationship are attached to."""
        for key, place in ends.ports.items():
            self.shape.port_spans.setdefault(key, place.span)
        if len(ends.ports) + len(ends.channels) > 1:
            self._report_joined(ends)
            self._give_up([*ends.ports.values(), *ends.channels.values(), *ends.instances])
            return Unresolved()
        if ends.ports:
            (place,) = ends.ports.values()
            return self._at_port(item, place, values)
        if ends.channels:
            (channel,) = ends.channels.values()
            return OwnChannel(channel.channel.name)
        return self._between(item, ends.instances, values, index)

    def _between(
        self, item: ast.Connection, instances: list[InstancePort], values: Values, index: int | None
    ) -> AttachmentShape:
        """What ports of instances are attached to that are connected to each other, or to ``_``."""
        for sink in item.sinks:
            if not isinstance(sink, ast.Discard):
                break
        else:
            if item.sinks:
                return Discarded()
        return OwnChannel(self._channel(item, instances, values, index).name)

    def _at_port(self, item: ast.Connection, place: ProcessPort, values: Values) -> AttachmentShape:
        if not item.sinks and item.label is not None:
            self.report.add(PortEndsInLabel(span=place.span, port=place.key, label_name=item.label.text))
            self._declare_label(item, place.port.type, values)
            self._give_up([place])
            return Unresolved()
        if item.label is not None:
            self.places.aliases[self._label_name(item, values, None)] = place
        if item.kind is not None:
            self.shape.requested.setdefault(place.key, []).append(self._requested(item.kind, values))
        return OwnPort(place.key)

    def _report_joined(self, ends: _Ends) -> None:
        places: list[tuple[str, Span]] = [(key, place.span) for key, place in ends.ports.items()]
        places += [(name, place.span) for name, place in ends.channels.items()]
        (first, first_span), (second, second_span) = places[:2]
        ports = [place.port for place in ends.ports.values()]
        if len(ports) > 1 and ports[0].direction != ports[1].direction and not ends.instances:
            self.report.add(PortToPort(span=second_span, source=first, sink=second, first=first_span))
            return
        self.report.add(JoinsTwoObjects(span=second_span, one=first, other=second, first=first_span))

    def _label_name(self, item: ast.Connection, values: Values, index: int | None) -> str:
        assert item.label is not None
        loops = self.places.loops.get(item, ())
        return element_name(item.label.text, *(_integer(values[loop]) for loop in loops), index)

    def _declare_label(self, item: ast.Connection, type_: Type, values: Values) -> None:
        name = self._label_name(item, values, None)
        assert item.label is not None
        channel = self.shape.channels[name] = ChannelShape(name, item, type_, item.label.span)
        channel.excused = True

    def _channel(
        self, item: ast.Connection, instances: list[InstancePort], values: Values, index: int | None
    ) -> ChannelShape:
        """The channel between ports of instances, named after its label or its first source."""
        if item.label is not None:
            name, span = self._label_name(item, values, index), item.label.span
        else:
            name, span = instances[0].name, item.sources[0].span
        known = instances[0].port.type
        if item.type is not None:
            known = self.sizes.type_of(item.type, self.program.types.get(item.type, known), values)
        channel = ChannelShape(name, item, known, span)
        if item.kind is not None:
            channel.requested = self._requested(item.kind, values)
        return self.shape.channels.setdefault(name, channel)

    def _attach(
        self, instance: InstanceShape, element: tuple[str, int | None], target: AttachmentShape, span: Span
    ) -> None:
        before = instance.attachments.get(element)
        if isinstance(target, (OwnPort, OwnChannel)):
            known = instance.shape.ports[element[0]].type
            other = self.shape.port_or_channel_type(target.key)
            if known is not other:
                port = f"{instance.name}.{element[0]}"
                check_sizes(known, other, span, port, target.key, self.report)
        if before is None:
            instance.attachments[element] = Attached(target=target, span=span)
            return
        if isinstance(before.target, Unresolved) or isinstance(target, Unresolved):
            return
        for end in (before.target, target):
            if isinstance(end, OwnChannel):
                self.shape.channels[end.key].excused = True
        port = f"{instance.name}.{element_name(*element)}"
        direction = instance.shape.ports[element[0]].direction
        self.report.add(ConnectedTwice(span=span, port=port, direction=direction, first=before.span))
        self.shape.has_unknown_uses = True


def _known(values: Values) -> Iterable[tuple[ast.Node, Value]]:
    """The values of replicators only; parameters stay symbols."""
    return ((key, value) for key, value in values.items() if isinstance(key, ast.Replicator))


def _integer(value: Value) -> int:
    assert isinstance(value, int)
    return value
