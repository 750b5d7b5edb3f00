"""Changes of the communication diagram: two connections of an instance exchanged, a buffer in a channel.

Exchanging connections changes the order in which an instance takes its resources. If all instances take them in one
order, there is no circular wait (Havender, "Avoiding deadlock in multitasking systems", 1968; Roscoe and Dathi, "The
pursuit of deadlock freedom", 1987).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.base import Report, Span
from cspdiag.base.record import record
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.program import Program
from cspdiag.network.ir.actions import ChannelEnd, PortEnd
from cspdiag.network.ir.network import CoreNetwork, InstanceOf, Net, Port, ProcessClass
from cspdiag.proofs.counterexamples.counterexample import BlockedProcess
from cspdiag.proofs.counterexamples.last_element import LastElement
from cspdiag.proofs.counterexamples.suggestion import Suggestion
from cspdiag.proofs.counterexamples.surroundings import around, covers, looks_the_same, within
from cspdiag.syntax import ast


def buffered(program: Program, network: CoreNetwork, waiting: Sequence[BlockedProcess]) -> Iterator[Suggestion]:
    """Suggests a buffer in a channel that a process waits to write to."""
    spans = {net.path: net.span for net in network.nets if net.external is None and net.kind == "sync"}
    known: set[int] = set()
    for entry in waiting:
        for channel in entry.channels if "to write" in entry.words else ():
            span = spans.get(channel)
            if span is not None and span.start not in known:
                known.add(span.start)
                for node in _relationships(program, span):
                    yield _with_buffer(node)


def _relationships(program: Program, place: Span) -> Iterator[ast.Connection | ast.Channel]:
    """The declarations of channels at a place in the text."""
    for communication in around(program, place, ast.Communication):
        nodes: list[ast.Connection | ast.Channel] = [*within(communication, ast.Connection)]
        nodes += within(communication, ast.Channel)
        for node in nodes:
            if node.kind is None and (covers(node.span, place) or covers(place, node.span)):
                yield node


def _with_buffer(node: ast.Connection | ast.Channel) -> Suggestion:
    if isinstance(node, ast.Connection) and node.label is None and node.type is None:
        at, inserted = node.sinks[0].span.start, "buffer 1 -> "
    else:
        after = node.type or (node.label if isinstance(node, ast.Connection) else node.name)
        assert after is not None
        at, inserted = after.span.end, " buffer 1"
    text, place = node.span.text, at - node.span.start
    changed = f"{text[:place]}{inserted}{text[place:]}"
    words = f"a buffer in the channel: `{' '.join(changed.split())}` ({node.span})"
    return Suggestion(words, node.span, changed)


@record
class _Pair:
    """Two ports of an instance inside the process ``definition`` that are connected to processes of one definition."""

    definition: str
    instance: InstanceOf
    ports: tuple[str, str]


def exchanged_connections(
    program: Program, network: CoreNetwork, waiting: Sequence[BlockedProcess]
) -> Iterator[Suggestion]:
    """Suggests exchanging two connections of an instance, so it takes in another order what it waits for; both must
    lead to processes in which they have the same role.
    """
    tried: set[tuple[str, str, tuple[str, str]]] = set()
    for pair in _pairs(program, network, waiting):
        key = (pair.definition, pair.instance.array or pair.instance.name, pair.ports)
        if key in tried:
            continue
        tried.add(key)
        definition = program.definitions[pair.definition]
        if isinstance(definition, ast.ProcessDefinition) and definition.communication is not None:
            suggestion = _exchange(program, pair, definition.communication)
            if suggestion is not None:
                yield suggestion


def _pairs(program: Program, network: CoreNetwork, waiting: Sequence[BlockedProcess]) -> Iterator[_Pair]:
    """The ports at which processes wait, each paired with every other port like it."""
    places = _Places(program, network)
    for entry in waiting:
        for net in (places.nets[channel] for channel in entry.channels if channel in places.nets):
            for path, port in (*net.writers, *net.readers):
                if path == entry.path:
                    yield from places.pairs(net, path, port)


class _Places:
    """The nets and classes of a network by path."""

    def __init__(self, program: Program, network: CoreNetwork) -> None:
        self._program = program
        classes = {entry.name: entry for entry in network.classes}
        self.nets = {net.path: net for net in network.nets if net.external is None}
        self._classes = {entry.path: classes[entry.class_name] for entry in network.instances}

    def pairs(self, net: Net, leaf: str, leaf_port: str) -> Iterator[_Pair]:
        """The ports that may be exchanged with the port through which a leaf process accesses a channel, at the
        instance that is connected to the channel.
        """
        path, port = leaf, leaf_port
        while "." in path:
            enclosing, _, name = path.rpartition(".")
            owner = self._classes[enclosing]
            assert isinstance(owner, ProcessClass)
            instance = next(entry for entry in owner.instances if entry.name == name)
            attachments = {entry.port: entry.attachment for entry in instance.connections if entry.index is None}
            end = attachments.get(port)
            if isinstance(end, ChannelEnd):
                for other, ports in _like(self._classes[path].ports, port):
                    beside = attachments.get(other)
                    if isinstance(beside, ChannelEnd):
                        channel = self.nets.get(f"{enclosing}.{beside.channel}")
                        if channel is not None and self._lead_to_the_same(net, channel, path):
                            yield _Pair(owner.definition, instance, ports)
            if not isinstance(end, PortEnd) or end.index is not None:
                return
            path, port = enclosing, end.port

    def _lead_to_the_same(self, net: Net, other: Net, path: str) -> bool:
        """Whether two channels of an instance lead to ports that have the same role in processes of one definition."""
        partners = [
            [(leaf, port) for leaf, port in (*one.writers, *one.readers) if not f"{leaf}.".startswith(f"{path}.")]
            for one in (net, other)
        ]
        if any(len(found) != 1 for found in partners):
            return False
        ((leaf, port),), ((other_leaf, other_port),) = partners
        definition = self._program.definitions[self._classes[leaf].definition]
        if definition is not self._program.definitions[self._classes[other_leaf].definition]:
            return False
        return port == other_port or (
            isinstance(definition, ast.ProcessDefinition)
            and definition.composition is not None
            and looks_the_same(definition.composition, {port: other_port, other_port: port})
        )


def _like(ports: Sequence[Port], name: str) -> Iterator[tuple[str, tuple[str, str]]]:
    """The other ports of the same direction and type, each with the names of both in the order of the text."""
    names = [port.name for port in ports]
    own = ports[names.index(name)]
    for at, port in enumerate(ports):
        if port is not own and (port.direction, port.type, port.size) == (own.direction, own.type, None):
            before = at < names.index(name)
            yield port.name, (port.name, name) if before else (name, port.name)


def _exchange(program: Program, pair: _Pair, communication: ast.Communication) -> Suggestion | None:
    """The change of the text; None if the instance is not connected by exactly two relationships, both outside loops or
    both in the same loop.
    """
    whole = communication.declarations
    alone = _references(program, pair, [part for part in whole if isinstance(part, ast.Connection)], None)
    if alone is not None:
        names = alone[0].span.text.removesuffix(f".{pair.ports[0]}")
        first, last = sorted((span for reference in alone if (span := _member(reference))), key=lambda span: span.start)
        span = Span(first.source, first.start, last.end)
        between = span.text[len(first.text) : len(span.text) - len(last.text)]
        return Suggestion(_words(pair, names, span), span, f"{last.text}{between}{first.text}")
    for loop in whole:
        if isinstance(loop, ast.RepeatedDeclarations):
            connections = [part for part in loop.declarations if isinstance(part, ast.Connection)]
            repeated = _references(program, pair, connections, loop.replicator)
            if repeated is not None and len(connections) == len(loop.declarations):
                return _last_exchanged(program, pair, loop, repeated)
    return None


def _references(
    program: Program, pair: _Pair, connections: Sequence[ast.Connection], replicator: ast.Replicator | None
) -> tuple[ast.Reference, ast.Reference] | None:
    """The two references that connect the ports of the instance; in a loop, those to the current element of the array.
    None if there are other references to these ports.
    """
    found = [
        reference
        for connection in connections
        for reference in (*connection.sources, *connection.sinks)
        if isinstance(reference, ast.Reference)
        and reference.member is not None
        and reference.member.text in pair.ports
        and _is_meant(program, pair.instance, reference, replicator)
    ]
    by_port = {reference.member.text: reference for reference in found if reference.member is not None}
    if len(found) != 2 or len(by_port) != 2:
        return None
    one, other = pair.ports
    return by_port[one], by_port[other]


def _is_meant(
    program: Program, instance: InstanceOf, reference: ast.Reference, replicator: ast.Replicator | None
) -> bool:
    if reference.name.text != (instance.array or instance.name) or reference.member_indexes:
        return False
    if instance.array is None:
        return replicator is None and not reference.indexes
    (index,) = reference.indexes
    if replicator is not None:
        return isinstance(index, ast.Name) and program.bindings.get(index) is replicator
    return evaluate(program, index, {}, Report()) == instance.index


def _member(reference: ast.Reference) -> Span:
    assert reference.member is not None
    return reference.member.span


def _words(pair: _Pair, name: str, span: Span) -> str:
    one, other = pair.ports
    return f"another order of what `{name}` takes: exchange its connections `{one}` and `{other}` ({span})"


def _last_exchanged(
    program: Program, pair: _Pair, loop: ast.RepeatedDeclarations, references: tuple[ast.Reference, ast.Reference]
) -> Suggestion | None:
    """The change that writes the last iteration of a loop out after it, with two connections exchanged."""
    last = LastElement(program, loop.replicator)
    if last.count is None or last.count < 2:
        return None
    exchanged = {_member(one): _member(other).text for one, other in (references, references[::-1])}
    start = loop.span.start
    line = loop.span.source.line_text(loop.span.line)
    indent = line[: len(line) - len(line.lstrip())]
    count = loop.replicator.count.span
    rounds = loop.span.text[: count.start - start] + last.fewer + loop.span.text[count.end - start :]
    apart = [last.text_of(connection, exchanged) for connection in loop.declarations]
    name = f"{pair.instance.array}[{last.index}]"
    return Suggestion(_words(pair, name, loop.span), loop.span, f"\n{indent}".join((rounds, *apart)))
