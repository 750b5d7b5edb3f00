"""The function that initializes a process: everything is created in the order that decides who is served first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.process.leaves import KINDS
from cspdiag.codegen.c.process.outlines import Outlines
from cspdiag.codegen.c.process.struct.declarations import port_members
from cspdiag.codegen.c.process.struct.members import Members, StructMember
from cspdiag.codegen.c.process.struct.port_layout import PortLayout, elements
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.code import (
    Aggregate,
    Assignment,
    Code,
    address,
    call,
    cast,
    code,
    ignored,
    own,
    unsigned,
)
from cspdiag.codegen.c.text.media import READING_ENDS, access_of_channel, access_of_medium
from cspdiag.codegen.c.text.rolling import Rolled, marked, rolled, rolled_from
from cspdiag.codegen.c.text.statements import Block, Plain, Statement, define, run, store
from cspdiag.codegen.shared.document import Document
from cspdiag.codegen.shared.trees import nodes
from cspdiag.model.types import IntType
from cspdiag.network.ir.actions import AfterEvent, ChannelEnd, End, PortEnd
from cspdiag.network.ir.expressions import Expression, LiteralValue, ParameterValue
from cspdiag.network.ir.network import (
    Connection,
    ConstantEnd,
    CreatedChoice,
    CreatedInstance,
    DiscardEnd,
    InstanceOf,
    LocalChannel,
    ProcessClass,
    SubmodelClass,
)
from cspdiag.network.ir.walk import parts

PORTS = code("ports")

_MAKERS = {"channel": "csp_channel_init", "any": "csp_any_init", "broadcast": "csp_broadcast_init"}


@record
class Given(Code):
    """A member of the ports that a process is given: ``ports->x``."""

    member: Code

    def _document(self) -> Document:
        return (PORTS.document, "->", self.member.document)


FEW = 8
"""With more ports than this they are attached one by one, or in loops, where that makes the text shorter."""


@record
class Filled(Code):
    """A member of the ports of an instance while they are filled in: ``ports.x``."""

    ports: str
    member: Code

    def _document(self) -> Document:
        return (f"{self.ports}.", self.member.document)


def _counted(kind: str, by: int) -> Plain:
    """The next free number of processes, channels or variables."""
    number = code(f"numbers->{kind}")
    return run(f"{number}++") if by == 1 else Plain(Assignment(number, unsigned(by), "+="))


def initialization(writer: Writer) -> list[Statement]:
    """The statements of the function."""
    return _Initialization(writer).statements()


class _Initialization:
    def __init__(self, writer: Writer) -> None:
        self.writer = writer
        self.members: Members = writer.members
        self.process = writer.members.process
        self.printer = writer.members.initial_printer
        self.layouts: dict[str, PortLayout] = {}
        self.setup: list[Plain] = []

    def statements(self) -> list[Statement]:
        members, number = self.members, code("numbers->process")
        made = call("csp_process_init", address(own("process")), f"&{self.writer.struct}_class", number)
        found: list[Statement] = [run(made), _counted("process", len(self.writer.observed) + 1)]
        stored = set(members.stored_parameters())
        used = self._used_parameters()
        for item in self.process.parameters:
            name = members.parameters[item.name]
            if item.name in stored:
                found.append(store(own(name), name))
            elif item.name not in used:
                found.append(run(ignored(code(name))))
        found += rolled([[statement] for statement in self._ports()])
        found += self._channels()
        if members.reports:
            found += [store(own("first_report"), "numbers->channel"), _counted("channel", len(members.reports))]
        found += self._signals()
        for member, count in self.writer.offer_arrays().items():
            made = call("csp_offers_init", address(own(member)), own(f"{member}_made"), unsigned(count))
            found.append(run(made))
        found += self._created()
        found += self.writer.initial
        if port_members(members) and not any(isinstance(node, Given) for node in nodes(found)):
            found.insert(0, run(ignored(PORTS)))
        return found

    def _used_parameters(self) -> set[str]:
        """Parameters that the function itself evaluates."""
        process = self.process
        evaluated = (
            process.constants,
            process.states,
            tuple(channel.initial for channel in process.channels if channel.initial is not None),
            tuple(instance.arguments for instance in process.instances),
            tuple(c.attachment for instance in process.instances for c in instance.connections),
            tuple(self.members.inside.of(AfterEvent)),
        )
        return {part.name for part in parts(evaluated) if isinstance(part, ParameterValue)}

    def _ports(self) -> Iterator[Plain]:
        members = self.members
        for port, index in members.used_ports():
            access = access_of_medium(port.media[index or 0])
            if access != "discard" and not (port.direction == "in" and access in READING_ENDS):
                member = members.layout.member(port, index)
                yield store(own(member), Given(member))
                if members.unwritten.has_port(self.process.name, port.name, index):
                    flag = members.layout.written(port, index)
                    yield store(own(flag), Given(code(flag)))

    def _channels(self) -> list[Statement]:
        channels, outlines = self.process.channels, Outlines(self.members)
        return list(
            rolled_from(
                [outlines.channel(item) for item in channels],
                lambda at: self._behind_setup(self._channel(channels[at])),
            )
        )

    def _channel(self, channel: LocalChannel) -> list[Plain]:
        access, lvalue = access_of_channel(channel), own(self.members.member(channel.name))
        number = code("numbers->channel")
        if access == "variable":
            found = [] if channel.initial is None else [store(lvalue, self._printed(channel.initial))]
            flag = self.members.written(channel.name)
            if flag is not None:
                found += [store(flag.field("number"), "numbers->variable"), _counted("variable", 1)]
            return found
        if access == "buffer":
            values, capacity = own(self.members.storage(channel.name)), unsigned(channel.capacity or 0)
            overwrites = "true" if channel.kind == "overwrite" else "false"
            made = call("csp_buffer_init", address(lvalue), number, values, capacity, overwrites)
        else:
            made = call(_MAKERS[access], address(lvalue), number)
        return [run(made), _counted("channel", 1)]

    def _signals(self) -> list[Statement]:
        found: list[Statement] = []
        for constant in self.process.constants:
            found += self._assigned(self.members.signal(constant.name), constant.value)
        for state in self.process.states:
            found += self._assigned(self.members.signal(state.name), state.initial)
        return found

    def _assigned(self, lvalue: Code, value: Expression) -> list[Statement]:
        found = self.printer.evaluate(value)
        return [*found.setup, store(lvalue, found.code)]

    def _printed(self, value: Expression) -> Code:
        match value:
            case LiteralValue(type=IntType(), value=int(number), name=None) if number >= 0:
                return marked(number)
        found = self.printer.evaluate(value)
        self.setup += [statement for statement in found.setup if isinstance(statement, Plain)]
        return found.code

    def _behind_setup(self, made: Sequence[Rolled]) -> list[Rolled]:
        """Statements behind what has to be done for the expressions that were printed in them."""
        found = [*self.setup, *made]
        self.setup.clear()
        return found

    def _created(self) -> list[Statement]:
        """Reading ends, instances and alternatives, in the order in which they are created."""
        found: list[Statement] = []
        pending: list[CreatedInstance | End] = []
        outlines = Outlines(self.members)

        def made() -> list[Rolled]:
            return rolled_from(
                [outlines.created(item) for item in pending], lambda at: self._behind_setup(self._made(pending[at]))
            )

        for item in self.process.creation:
            if isinstance(item, CreatedChoice):
                found += made()
                pending.clear()
                found += self.members.made_choices.get(item.choice, [])  # none where control never comes there
            else:
                pending.append(item)
        return [*found, *made()]

    def _made(self, item: CreatedInstance | End) -> list[Rolled]:
        if isinstance(item, CreatedInstance):
            return self._instance(self.members.instances[item.instance])
        return [*self._end(item)]

    def _end(self, end: End) -> list[Plain]:
        access, members = self.members.access(end), self.members
        if access not in READING_ENDS:
            return []
        member = own(members.end_member(end))
        match access, end:
            case "sampled", _:
                samples = address(own(members.samples(end)))
                return [run(call("csp_sampled_end_init", address(member), self._medium(end), samples))]
            case "event", PortEnd():
                latch = address(own(members.latch(end)))
                return [store(member, call("csp_event_reader", latch, self._medium(end)))]
            case "broadcast", _:
                return [run(call("csp_broadcast_end_init", address(member), self._medium(end)))]
            case _:
                raise AssertionError(f"no end of its own reads a {access}")

    def _medium(self, end: End) -> Code:
        if isinstance(end, ChannelEnd):
            return address(own(self.members.member(end.channel)))
        return Given(self.members.layout.member(self.members.ports[end.port], end.index))

    def _instance(self, instance: InstanceOf) -> list[Rolled]:
        class_ = self.members.classes[instance.class_name]
        struct = self.writer.names.classes[class_.name]
        lvalue = own(self.members.member(instance.name))
        given = [self._printed(value) for _, value in instance.arguments]
        if isinstance(class_, SubmodelClass):
            return [run(call(f"{struct}_initialize", address(lvalue), *given))]
        arguments: list[Code] = [address(lvalue), code("numbers")]
        layout = self._layout(class_)
        if class_.external is not None:
            return [*self._by_hand(instance, class_, layout, [*arguments], given)]
        if any(layout.designator(port.name, index) for port in class_.ports for index in elements(port)):
            fields = list(self._fields(class_.name, instance.connections, layout))
            filled = self._filled(instance, class_, fields)
            if filled:
                name = self.members.names[f"ports of {instance.name}"]
                made = run(call(f"{struct}_initialize", *arguments, f"&{name}", *given))
                return [Block((define(f"struct {struct}_ports", name), *filled, made))]
            named = tuple((f".{member}", value) for member, value in fields)
            arguments.append(address(Aggregate(named, f"const struct {struct}_ports")))
        return [run(call(f"{struct}_initialize", *arguments, *given))]

    def _filled(self, instance: InstanceOf, class_: ProcessClass, fields: Sequence[tuple[Code, Code]]) -> list[Rolled]:
        """Loops that attach the ports of an instance one by one; none where a list of them is as short.

        Elements of arrays are made in loops themselves. Where ports tell whether they were written, not each instance
        has something for every one of them.
        """
        flagged = self.members.unwritten.has_port
        ports = ((port.name, index) for port in class_.ports for index in elements(port))
        if len(fields) <= FEW or instance.index is not None or any(flagged(class_.name, *port) for port in ports):
            return []
        name = self.members.names[f"ports of {instance.name}"]
        filled = rolled([[store(Filled(name, member), value)] for member, value in fields])
        return filled if len(filled) < len(fields) else []

    def _layout(self, class_: ProcessClass) -> PortLayout:
        if class_.name not in self.layouts:
            self.layouts[class_.name] = PortLayout(class_)
        return self.layouts[class_.name]

    def _by_hand(
        self, instance: InstanceOf, class_: ProcessClass, layout: PortLayout, arguments: list[Code], given: list[Code]
    ) -> list[Plain]:
        """A process that is written by hand; a constant input is a variable that nobody writes."""
        struct = self.writer.names.classes[class_.name]
        found: list[Plain] = []
        fields: list[tuple[str | None, Code]] = []
        for connection in instance.connections:
            port = layout.ports[connection.port]
            access = access_of_medium(port.media[connection.index or 0])
            name = layout.names[port.name] + ("" if connection.index is None else f"[{connection.index}]")
            match connection.attachment:
                case ConstantEnd(value=value):
                    kept = self.members.names[f"{instance.name} {name} constant"]
                    self.members.work.append(StructMember(f"{self.writer.members.types.type_name(port.type)} {kept}"))
                    found.append(store(own(kept), self._printed(value)))
                    at: Code = address(own(kept))
                case DiscardEnd():
                    at = code("NULL")
                case ChannelEnd(channel=channel):
                    at = address(own(self.members.member(channel)))
                case PortEnd():
                    at = self._attached(connection)
                    at = cast("void *", at) if access == "variable" else at
            size = call("sizeof", self.writer.members.types.type_name(port.type))
            fields.append((f".{name}", Aggregate(((None, code(KINDS[access])), (None, at), (None, size)))))
        if fields:
            arguments.append(address(Aggregate(tuple(fields), f"const struct {struct}_ports")))
        return [*found, run(call(f"{struct}_initialize", *arguments, *given))]

    def _flag(self, connection: Connection) -> Code | None:
        """A pointer to the flag whether the variable at a connection was written; None where that is sure."""
        members = self.members
        match connection.attachment:
            case ChannelEnd(channel=channel):
                flag = members.written(channel)
                return None if flag is None else address(flag)
            case PortEnd(port=port, index=index) if members.unwritten.has_port(self.process.name, port, index):
                return Given(code(members.layout.written(members.ports[port], index)))
        return None

    def _fields(
        self, class_: str, connections: Sequence[Connection], layout: PortLayout
    ) -> Iterator[tuple[Code, Code]]:
        for connection in connections:
            designator = layout.designator(connection.port, connection.index)
            if designator is None:
                continue
            yield designator, self._attached(connection)
            flag = self._flag(connection)
            if flag is not None and self.members.unwritten.has_port(class_, connection.port, connection.index):
                written = layout.written(layout.ports[connection.port], connection.index)
                yield code(written), flag

    def _attached(self, connection: Connection) -> Code:
        members = self.members
        match connection.attachment:
            case ConstantEnd(value=value):
                return self._printed(value)
            case DiscardEnd():
                raise AssertionError("what is discarded needs no port")
            case ChannelEnd(channel=channel):
                return address(own(members.member(channel)))
            case PortEnd(port=port, index=index):
                return Given(members.layout.member(members.ports[port], index))
