"""The function that initializes a process: everything comes to be in the order that decides who is served first."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.codegen.c.process.leaves import KINDS
from cspdiag.codegen.c.process.members import SELF, Member, Members
from cspdiag.codegen.c.process.port_layout import PortLayout, elements
from cspdiag.codegen.c.process.writer import Writer
from cspdiag.codegen.c.text.media import READING_ENDS, access_of_channel, access_of_medium
from cspdiag.codegen.c.text.rolling import marked, rolled
from cspdiag.codegen.c.text.rows import Row, rows
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
    ProcessClass,
    SubmodelClass,
)
from cspdiag.network.ir.walk import parts

_MAKERS = {"channel": "csp_channel_init", "any": "csp_any_init", "broadcast": "csp_broadcast_init"}


def initialize_rows(writer: Writer) -> list[Row]:
    """The statements of the function."""
    return _Initialization(writer).rows()


class _Initialization:
    def __init__(self, writer: Writer) -> None:
        self.writer = writer
        self.members: Members = writer.members
        self.process = writer.members.process
        self.printer = writer.members.initial_printer
        self.layouts: dict[str, PortLayout] = {}

    def rows(self) -> list[Row]:
        members, numbers = self.members, len(self.writer.observed) + 1
        found = rows(f"csp_process_init(&{SELF}process, &{self.writer.struct}_class, numbers->process);")
        found.append(Row("numbers->process++;" if numbers == 1 else f"numbers->process += {numbers}U;"))
        stored = set(members.stored_parameters())
        used = self._used_parameters()
        for item in self.process.parameters:
            name = members.parameters[item.name]
            if item.name in stored:
                found.append(Row(f"{SELF}{name} = {name};"))
            elif item.name not in used:
                found.append(Row(f"(void){name};"))
        ports = rolled([[text] for text in self._ports()])
        found += ports
        found += self._channels()
        if members.reports:
            found += rows(f"{SELF}first_report = numbers->channel;", f"numbers->channel += {len(members.reports)}U;")
        found += self._signals()
        for member, count in self.writer.offer_arrays().items():
            found.append(Row(f"csp_offers_init(&{SELF}{member}, {SELF}{member}_made, {count}U);"))
        found += self._created()
        found += self.writer.initial
        if members.port_members() and not any("ports->" in row.text or "(*ports)" in row.text for row in found):
            found.insert(0, Row("(void)ports;"))
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
            tuple(part for part in parts(process.body) if isinstance(part, AfterEvent)),
        )
        return {part.name for part in parts(evaluated) if isinstance(part, ParameterValue)}

    def _ports(self) -> Iterator[str]:
        members = self.members
        for port, index in members.used_ports():
            access = access_of_medium(port.media[index or 0])
            if access != "discard" and not (port.direction == "in" and access in READING_ENDS):
                member = members.layout.member(port, index)
                yield f"{SELF}{member} = ports->{member};"
                if members.unwritten.has_port(self.process.name, port.name, index):
                    flag = members.layout.written(port, index)
                    yield f"{SELF}{flag} = ports->{flag};"

    def _channels(self) -> list[Row]:
        groups: list[list[str]] = []
        for channel in self.process.channels:
            access, lvalue = access_of_channel(channel), SELF + self.members.member(channel.name)
            if access == "variable":
                if channel.initial is not None:
                    groups.append([f"{lvalue} = {self._printed(channel.initial)};"])
                flag = self.members.written(channel.name)
                if flag is not None:
                    groups.append([f"{SELF}{flag}.number = numbers->variable;", "numbers->variable++;"])
            elif access == "buffer":
                values = SELF + self.members.storage(channel.name, self.members.arrays.subscript(channel.name))
                overwrites = "true" if channel.kind == "overwrite" else "false"
                made = f"csp_buffer_init(&{lvalue}, numbers->channel, {values}, {channel.capacity}U, {overwrites});"
                groups.append([made, "numbers->channel++;"])
            else:
                groups.append([f"{_MAKERS[access]}(&{lvalue}, numbers->channel);", "numbers->channel++;"])
        return rolled(groups)

    def _signals(self) -> list[Row]:
        found: list[Row] = []
        for constant in self.process.constants:
            found += self._assigned(self.members.signal(constant.name), constant.value)
        for state in self.process.states:
            found += self._assigned(self.members.signal(state.name), state.initial)
        return found

    def _assigned(self, lvalue: str, value: Expression) -> list[Row]:
        text = f"{lvalue} = {self.printer.print(value)};"
        return [*rows(*self.printer.take_temporaries()), Row(text)]

    def _printed(self, value: Expression) -> str:
        match value:
            case LiteralValue(type=IntType(), value=int(number), name=None) if number >= 0:
                return marked(number)
        return str(self.printer.print(value))

    def _created(self) -> list[Row]:
        """Reading ends, instances and alternatives, in the order in which they come to be."""
        found: list[Row] = []
        groups: list[list[str]] = []
        for item in self.process.creation:
            match item:
                case CreatedInstance(instance=name):
                    groups.append(self._instance(self.members.instances[name]))
                case CreatedChoice(choice=name):
                    found += rolled(groups)
                    groups = []
                    found += self.members.made_choices.get(name, [])  # none where control never comes there
                case end:
                    groups.append(self._end(end))
        return [*found, *rolled(groups)]

    def _end(self, end: End) -> list[str]:
        access, members = self.members.access(end), self.members
        if access not in READING_ENDS:
            return []
        member = SELF + members.end_member(end)
        if isinstance(end, ChannelEnd):
            medium = f"&{SELF}{members.member(end.channel)}"
        else:
            medium = f"ports->{members.layout.member(members.ports[end.port], end.index)}"
        match access:
            case "sampled":
                return [f"csp_sampled_end_init(&{member}, {medium}, &{SELF}{members.samples(end)});"]
            case "broadcast":
                return [f"csp_broadcast_end_init(&{member}, {medium});"]
            case _:
                latch = SELF + members.latch(members.end_member(end))
                return [f"{member} = csp_event_reader(&{latch}, {medium});"]

    def _instance(self, instance: InstanceOf) -> list[str]:
        class_ = self.members.classes[instance.class_name]
        struct = self.writer.names.classes[class_.name]
        lvalue = SELF + self.members.member(instance.name)
        given = [self._printed(value) for _, value in instance.arguments]
        if isinstance(class_, SubmodelClass):
            return [f"{struct}_initialize({', '.join([f'&{lvalue}', *given])});"]
        arguments = [f"&{lvalue}", "numbers"]
        layout = self._layout(class_)
        if class_.external is not None:
            return self._by_hand(instance, class_, layout, [*arguments], given)
        if any(layout.designator(port.name, index) for port in class_.ports for index in elements(port)):
            fields = self._fields(class_.name, instance.connections, layout)
            arguments.append(f"&(const struct {struct}_ports){{{', '.join(fields)}}}")
        return [f"{struct}_initialize({', '.join([*arguments, *given])});"]

    def _layout(self, class_: ProcessClass) -> PortLayout:
        if class_.name not in self.layouts:
            self.layouts[class_.name] = PortLayout(class_)
        return self.layouts[class_.name]

    def _by_hand(
        self, instance: InstanceOf, class_: ProcessClass, layout: PortLayout, arguments: list[str], given: list[str]
    ) -> list[str]:
        """A process that is written by hand; a constant input is a variable that nobody writes."""
        struct, found, fields = self.writer.names.classes[class_.name], [], []
        for connection in instance.connections:
            port = layout.ports[connection.port]
            access = access_of_medium(port.media[connection.index or 0])
            name = layout.names[port.name] + ("" if connection.index is None else f"[{connection.index}]")
            match connection.attachment:
                case ConstantEnd(value=value):
                    kept = self.members.names[f"{instance.name} {name} constant"]
                    self.members.work.append(Member(f"{self.writer.members.types.type_name(port.type)} {kept}"))
                    found.append(f"{SELF}{kept} = {self._printed(value)};")
                    at = f"&{SELF}{kept}"
                case DiscardEnd():
                    at = "NULL"
                case ChannelEnd(channel=channel):
                    at = f"&{SELF}{self.members.member(channel)}"
                case PortEnd():
                    at = (
                        f"(void *)({self._attached(connection)})"
                        if access == "variable"
                        else self._attached(connection)
                    )
            size = f"sizeof({self.writer.members.types.type_name(port.type)})"
            fields.append(f".{name} = {{{KINDS[access]}, {at}, {size}}}")
        if fields:
            arguments.append(f"&(const struct {struct}_ports){{{', '.join(fields)}}}")
        return [*found, f"{struct}_initialize({', '.join([*arguments, *given])});"]

    def _flag(self, connection: Connection) -> str | None:
        """A pointer to what tells whether the variable at a connection was written; None where that is sure."""
        members = self.members
        match connection.attachment:
            case ChannelEnd(channel=channel):
                flag = members.written(channel)
                return None if flag is None else f"&{SELF}{flag}"
            case PortEnd(port=port, index=index) if members.unwritten.has_port(self.process.name, port, index):
                return f"ports->{members.layout.written(members.ports[port], index)}"
        return None

    def _fields(self, class_: str, connections: Sequence[Connection], layout: PortLayout) -> Iterator[str]:
        for connection in connections:
            designator = layout.designator(connection.port, connection.index)
            if designator is None:
                continue
            yield f".{designator} = {self._attached(connection)}"
            flag = self._flag(connection)
            if flag is not None and self.members.unwritten.has_port(class_, connection.port, connection.index):
                yield f".{layout.written(layout.ports[connection.port], connection.index)} = {flag}"

    def _attached(self, connection: Connection) -> str:
        members = self.members
        match connection.attachment:
            case ConstantEnd(value=value):
                return self._printed(value)
            case DiscardEnd():
                raise AssertionError("what is discarded needs no port")
            case ChannelEnd(channel=channel):
                return f"&{SELF}{members.member(channel)}"
            case PortEnd(port=port, index=index):
                return f"ports->{members.layout.member(members.ports[port], index)}"
