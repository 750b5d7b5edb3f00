"""The function that initializes a process. The order of creation matters: it decides which waiting process is first."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeGuard, TypeVar

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.calls import kernel_of, law_verbs
from cspdiag.codegen.c.process.leaves import KINDS
from cspdiag.codegen.c.process.outlines import Outlines, known_creation
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
from cspdiag.codegen.c.text.media import READING_ENDS, access_of
from cspdiag.codegen.c.text.rolling import Rolled, countable, rolled, rolled_from
from cspdiag.codegen.c.text.statements import Block, Plain, Statement, define, mentions_kernel, run, store
from cspdiag.codegen.shared.document import Document
from cspdiag.codegen.shared.trees import Outline, nodes, outlines_of
from cspdiag.model.types import IntType
from cspdiag.network.elaborate.fewer.rows import examples
from cspdiag.network.ir.actions import AfterEvent, ChannelEnd, End, PortEnd
from cspdiag.network.ir.expressions import Expression, LiteralValue, ParameterValue, TunableValue
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

T = TypeVar("T")

PORTS = code("ports")

_INIT_FUNCTIONS = {
    "channel": "csp_channel_init", "guarded": "csp_guarded_init", "any": "csp_any_init",
    "broadcast": "csp_broadcast_init",
}  # fmt: skip


@record
class PortMember(Code):
    """A port in the argument of the initialization function: ``ports->x``."""

    member: Code

    def _document(self) -> Document:
        return (PORTS.document, "->", self.member.document)


_MAX_LISTED_PORTS = 8
"""If there are more ports, they are assigned one by one, or in loops, where that makes the text shorter."""


@record
class FilledPort(Code):
    """A member of the local variable with the ports of an instance: ``ports.x``."""

    ports: str
    member: Code

    def _document(self) -> Document:
        return (f"{self.ports}.", self.member.document)


def _advance_number(kind: str, by: int) -> Plain:
    """Advances the next free number of processes, channels or variables."""
    number = code(f"numbers->{kind}")
    return run(f"{number}++") if by == 1 else Plain(Assignment(number, unsigned(by), "+="))


def initialization(writer: Writer) -> list[Statement]:
    """The statements of the initialization function."""
    return _Initialization(writer).statements()


def _has_no_choices(
    creation: Sequence[End | CreatedInstance | CreatedChoice],
) -> TypeGuard[Sequence[End | CreatedInstance]]:
    return not any(isinstance(item, CreatedChoice) for item in examples(creation))


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
        statements: list[Statement] = [run(made), _advance_number("process", len(self.writer.observed) + 1)]
        stored = set(members.stored_parameters())
        used = self._used_parameters()
        for item in self.process.parameters:
            name = members.parameters[item.name]
            if item.name in stored:
                statements.append(store(own(name), name))
            elif item.name not in used:
                statements.append(run(ignored(code(name))))
        statements += rolled([[statement] for statement in self._ports()])
        statements += self._channels()
        if members.reports:
            statements += [
                store(own("first_report"), "numbers->channel"),
                _advance_number("channel", len(members.reports)),
            ]
        statements += self._signals()
        for member, count in self.writer.offer_arrays().items():
            made = call("csp_offers_init", address(own(member)), own(f"{member}_made"), unsigned(count))
            statements.append(run(made))
        statements += self._creations()
        statements += self.writer.initial
        if port_members(members) and not any(isinstance(node, PortMember) for node in nodes(statements)):
            statements.insert(0, run(ignored(PORTS)))
        if mentions_kernel(statements):
            statements.insert(0, define("csp_kernel *const", "csp", "numbers->csp"))
        return statements

    def _used_parameters(self) -> set[str]:
        """Parameters that the initialization function itself evaluates."""
        process = self.process
        evaluated = (
            process.constants,
            process.states,
            tuple(channel.initial for channel in examples(process.channels) if channel.initial is not None),
            tuple(instance.arguments for instance in examples(process.instances)),
            tuple(c.attachment for instance in examples(process.instances) for c in instance.connections),
            tuple(self.members.inside.of(AfterEvent)),
        )
        return {part.name for part in parts(evaluated) if isinstance(part, ParameterValue | TunableValue)}

    def _ports(self) -> Iterator[Plain]:
        members = self.members
        for port, index in members.used_ports():
            access = access_of(port.media[index or 0])
            if access != "discard" and not (port.direction == "in" and access in READING_ENDS):
                member = members.layout.member(port, index)
                yield store(own(member), PortMember(member))
                if members.unwritten.has_port(self.process.name, port.name, index):
                    flag = members.layout.written(port, index)
                    yield store(own(flag), PortMember(code(flag)))

    def _channels(self) -> list[Statement]:
        channels, outlines = self.process.channels, Outlines(self.members)
        return list(
            rolled_from(
                self._outlines(channels, outlines.channel),
                lambda at: self._with_setup(self._channel(channels[at])),
            )
        )

    def _channel(self, channel: LocalChannel) -> list[Plain]:
        access, lvalue = access_of(channel), own(self.members.member(channel.name))
        number = code("numbers->channel")
        if access == "variable":
            statements = [] if channel.initial is None else [store(lvalue, self._printed(channel.initial))]
            flag = self.members.written(channel.name)
            if flag is not None:
                statements += [store(flag.field("number"), "numbers->variable"), _advance_number("variable", 1)]
            return statements
        if access == "buffer":
            values, capacity = own(self.members.storage(channel.name)), unsigned(channel.capacity or 0)
            overwrites = "true" if channel.kind == "overwrite" else "false"
            made = call("csp_buffer_init", address(lvalue), number, values, capacity, overwrites)
        else:
            made = call(_INIT_FUNCTIONS[access], address(lvalue), number)
        return [run(made), _advance_number("channel", 1)]

    def _signals(self) -> list[Statement]:
        statements: list[Statement] = []
        for constant in self.process.constants:
            statements += self._assigned(self.members.signal(constant.name), constant.value)
        for state in self.process.states:
            statements += self._assigned(self.members.signal(state.name), state.initial)
        return statements

    def _assigned(self, lvalue: Code, value: Expression) -> list[Statement]:
        evaluation = self.printer.evaluate(value)
        return [*evaluation.setup, store(lvalue, evaluation.code)]

    def _printed(self, value: Expression) -> Code:
        match value:
            case LiteralValue(type=IntType(), value=int(number), name=None) if number >= 0:
                return countable(number)
        evaluation = self.printer.evaluate(value)
        self.setup += [statement for statement in evaluation.setup if isinstance(statement, Plain)]
        return evaluation.code

    def _with_setup(self, made: Sequence[Rolled]) -> list[Rolled]:
        """Statements, preceded by what the expressions in them need."""
        statements = [*self.setup, *made]
        self.setup.clear()
        return statements

    def _creations(self) -> list[Statement]:
        """Reading ends, instances and alternatives, in the order in which they are created."""
        outlines = Outlines(self.members)

        def made(items: Sequence[CreatedInstance | End]) -> list[Rolled]:
            known = known_creation(items, self.members.arrays)
            return rolled_from(
                self._outlines(known, outlines.created), lambda at: self._with_setup(self._creation(items[at]))
            )

        creation = self.process.creation
        if _has_no_choices(creation):
            return [*made(creation)]
        statements: list[Statement] = []
        pending: list[CreatedInstance | End] = []
        for item in creation:
            if isinstance(item, CreatedChoice):
                statements += made(pending)
                pending = []
                statements += self.members.made_choices.get(item.choice, [])  # none for an unreachable one
            else:
                pending.append(item)
        return [*statements, *made(pending)]

    def _outlines(self, rows: Sequence[T], outlined: Callable[[T], Outline]) -> Sequence[Outline]:
        """The outlines of rows. Whether a variable has a flag is not known from the rows."""
        if any(self.members.unwritten.variables.values()):
            return list(map(outlined, rows))
        return outlines_of(rows, outlined)

    def _creation(self, item: CreatedInstance | End) -> list[Rolled]:
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
                raise AssertionError(f"a {access} has no reading ends")

    def _medium(self, end: End) -> Code:
        if isinstance(end, ChannelEnd):
            return address(own(self.members.member(end.channel)))
        return PortMember(self.members.layout.member(self.members.ports[end.port], end.index))

    def _instance(self, instance: InstanceOf) -> list[Rolled]:
        class_ = self.members.classes[instance.class_name]
        struct = self.writer.names.classes[class_.name]
        lvalue = own(self.members.member(instance.name))
        given = [
            self.printer.reference(value) if isinstance(value, TunableValue) else self._printed(value)
            for _, value in instance.arguments
        ]
        if isinstance(class_, SubmodelClass):
            return [
                run(call(f"{struct}_initialize", *kernel_of(law_verbs(class_), "initialize"), address(lvalue), *given))
            ]
        arguments: list[Code] = [address(lvalue), code("numbers")]
        layout = self._layout(class_)
        if class_.external is not None:
            return [*self._hand_written(instance, class_, layout, [*arguments], given)]
        if any(layout.designator(port.name, index) for port in class_.ports for index in elements(port)):
            fields = list(self._fields(class_.name, instance.connections, layout))
            loops = self._filled(instance, class_, fields)
            if loops:
                name = self.members.names[f"ports of {instance.name}"]
                made = run(call(f"{struct}_initialize", *arguments, f"&{name}", *given))
                return [Block((define(f"struct {struct}_ports", name), *loops, made))]
            named = tuple((f".{member}", value) for member, value in fields)
            arguments.append(address(Aggregate(named, f"const struct {struct}_ports")))
        return [run(call(f"{struct}_initialize", *arguments, *given))]

    def _filled(self, instance: InstanceOf, class_: ProcessClass, fields: Sequence[tuple[Code, Code]]) -> list[Rolled]:
        """Loops that assign the ports of an instance one by one; none where a list of them is as short.

        Elements of arrays are initialized in loops already. Ports with flags whether they were written are excluded,
        because an instance need not have a flag for each of them.
        """
        flagged = self.members.unwritten.has_port
        ports = ((port.name, index) for port in class_.ports for index in elements(port))
        if (
            len(fields) <= _MAX_LISTED_PORTS
            or instance.index is not None
            or any(flagged(class_.name, *port) for port in ports)
        ):
            return []
        name = self.members.names[f"ports of {instance.name}"]
        loops = rolled([[store(FilledPort(name, member), value)] for member, value in fields])
        return loops if len(loops) < len(fields) else []

    def _layout(self, class_: ProcessClass) -> PortLayout:
        if class_.name not in self.layouts:
            self.layouts[class_.name] = PortLayout(class_, self.members.types.names.macros)
        return self.layouts[class_.name]

    def _hand_written(
        self, instance: InstanceOf, class_: ProcessClass, layout: PortLayout, arguments: list[Code], given: list[Code]
    ) -> list[Plain]:
        """A hand-written process; a constant input is a variable that is never written."""
        struct = self.writer.names.classes[class_.name]
        statements: list[Plain] = []
        fields: list[tuple[str | None, Code]] = []
        for connection in instance.connections:
            port = layout.ports[connection.port]
            access = access_of(port.media[connection.index or 0])
            name = layout.names[port.name] + ("" if connection.index is None else f"[{connection.index}]")
            match connection.attachment:
                case ConstantEnd(value=value):
                    member = self.members.names[f"{instance.name} {name} constant"]
                    self.members.work.append(StructMember(f"{self.writer.members.types.type_name(port.type)} {member}"))
                    statements.append(store(own(member), self._printed(value)))
                    at: Code = address(own(member))
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
        return [*statements, run(call(f"{struct}_initialize", *arguments, *given))]

    def _flag(self, connection: Connection) -> Code | None:
        """A pointer to the flag whether the variable at a connection was written; None if it always is before it is
        read.
        """
        members = self.members
        match connection.attachment:
            case ChannelEnd(channel=channel):
                flag = members.written(channel)
                return None if flag is None else address(flag)
            case PortEnd(port=port, index=index) if members.unwritten.has_port(self.process.name, port, index):
                return PortMember(code(members.layout.written(members.ports[port], index)))
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
                raise AssertionError("a discarded output needs no port")
            case ChannelEnd(channel=channel):
                return address(own(members.member(channel)))
            case PortEnd(port=port, index=index):
                return PortMember(members.layout.member(members.ports[port], index))
