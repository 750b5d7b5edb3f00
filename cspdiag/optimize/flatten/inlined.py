"""An instance of a process, inlined into the class around it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from cspdiag.base.record import replaced
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import (
    Attachment,
    Connection,
    ConstantEnd,
    CreatedChoice,
    CreatedInstance,
    DiscardEnd,
    InstanceOf,
    LocalChannel,
    MediumKind,
    ProcessClass,
    SubmodelClass,
)
from cspdiag.network.ir.walk import parts
from cspdiag.optimize.changes import with_parts
from cspdiag.optimize.creation import MEDIA_WITH_READER_STATE
from cspdiag.optimize.flatten.naming import parameter_constants, renamed, renamed_equation, renamed_part

T = TypeVar("T")


class EndNumbers:
    """Numbers for ends that are added to a class."""

    def __init__(self, entry: ProcessClass) -> None:
        self._used: dict[ir.End, int] = {}
        for part in (*entry.creation, *parts(entry.body)):
            if isinstance(part, ir.PortEnd | ir.ChannelEnd):
                place = replaced(part, end=0)
                self._used[place] = max(self._used.get(place, 0), part.end + 1)

    def new(self, place: ir.End) -> ir.End:
        """One more end of a port or channel."""
        place = replaced(place, end=0)
        number = self._used.get(place, 0)
        self._used[place] = number + 1
        return replaced(place, end=number)


class InlinedProcess:
    """The parts of an instance of ``inner`` in terms of the class ``outer``: all names get the name of the instance as
    a prefix.

    A port is replaced by what it is connected to. One without a connection, or discarded, becomes a variable.
    """

    def __init__(
        self,
        instance: InstanceOf,
        inner: ProcessClass,
        outer: ProcessClass,
        numbers: EndNumbers,
        classes: Mapping[str, ProcessClass | SubmodelClass],
    ) -> None:
        assert inner.body is not None
        self.instance = instance
        self.inner = inner
        self.prefix = instance.name
        self._classes = classes
        self._arguments = dict(instance.arguments)
        self._values, given = parameter_constants(instance, inner.parameters)
        self._attachments = {(c.port, c.index): c.attachment for c in instance.connections}
        self._inputs = {port.name for port in inner.ports if port.direction == "in"}
        self._media = {port.name: port.media for port in inner.ports}
        self._ends: dict[ir.End, ir.End] = {}
        for part in inner.creation:
            if isinstance(part, ir.PortEnd) and self._keeps(part):
                place = self._attachments[part.port, part.index]
                assert isinstance(place, ir.PortEnd | ir.ChannelEnd)
                self._ends[part] = numbers.new(place)
        self.constants = (*given, *map(self._equation, inner.constants))
        self.states = tuple(
            replaced(state, name=self._name(state.name), initial=self._inlined(state.initial)) for state in inner.states
        )
        self.channels = (*self._unconnected(), *map(self._channel, inner.channels))
        self.instances = tuple(map(self._instance, inner.instances))
        self.creation = tuple(map(self._created, inner.creation))
        self._body = inner.body
        self.size = sum(1 for _ in parts((self.channels, self.instances, self.constants)))
        """The number of records except for the body, because arguments may have made expressions larger."""

    def scope(self, action: ir.RunInstance) -> ir.ProcessScope:
        """The action that replaces the run of the instance."""
        inside = {end for part in parts(self._body) if isinstance(part, ir.ProcessScope) for end in part.ends}
        own = [end for end in self._ends if self._medium(end) == "sampled" and end not in inside]
        return ir.ProcessScope(
            span=action.span,
            instance=self.prefix,
            class_name=self.inner.definition,
            ends=tuple(self._ends[end] for end in own),
            body=self._inlined(self._body),
            doc=self.inner.doc,
        )

    def _name(self, name: str) -> str:
        return f"{self.prefix}.{name}"

    def _medium(self, end: ir.End) -> MediumKind | None:
        return self._media[end.port][end.index or 0].kind if isinstance(end, ir.PortEnd) else None

    def _keeps(self, end: ir.PortEnd) -> bool:
        return end.port in self._inputs and self._medium(end) in MEDIA_WITH_READER_STATE

    def _end(self, end: ir.End) -> ir.End:
        """The end in terms of the outer class."""
        if isinstance(end, ir.ChannelEnd):
            return replaced(end, channel=self._name(end.channel))
        known = self._ends.get(end)
        if known is not None:
            return known
        match self._attachments[end.port, end.index]:
            case ir.PortEnd() | ir.ChannelEnd() as place:
                return place
            case ConstantEnd() | DiscardEnd():
                return ir.ChannelEnd(self._name(_element(end)))

    def _unconnected(self) -> list[LocalChannel]:
        """Variables for ports without a connection."""
        found = []
        for port in self.inner.ports:
            for index in [None] if port.size is None else range(port.size):
                attachment = self._attachments[port.name, index]
                if isinstance(attachment, ConstantEnd | DiscardEnd):
                    variable = LocalChannel(
                        name=self._name(_element(ir.PortEnd(port.name, index))),
                        doc=port.doc,
                        span=port.span,
                        type=port.type,
                        kind="var",
                        initial=attachment.value if isinstance(attachment, ConstantEnd) else None,
                    )
                    found.append(variable)
        return found

    def _channel(self, channel: LocalChannel) -> LocalChannel:
        initial = None if channel.initial is None else self._at_creation(channel.initial)
        return replaced(channel, name=self._name(channel.name), initial=initial)

    def _at_creation(self, value: Expression) -> Expression:
        """An expression over parameters, in terms of the parameters of the outer class only."""
        return renamed(value, self.prefix, self._arguments)

    def _instance(self, instance: InstanceOf) -> InstanceOf:
        return replaced(
            instance,
            name=self._name(instance.name),
            array=None if instance.array is None else self._name(instance.array),
            arguments=tuple((name, self._at_creation(value)) for name, value in instance.arguments),
            connections=tuple(self._connection(connection, instance) for connection in instance.connections),
        )

    def _connection(self, connection: Connection, instance: InstanceOf) -> Connection:
        attachment: Attachment = connection.attachment
        match attachment:
            case ConstantEnd(value=value):
                attachment = ConstantEnd(self._at_creation(value))
            case ir.PortEnd(port=port, index=index) if isinstance(self._classes[instance.class_name], ProcessClass):
                attachment = self._attachments[port, index]
            case ir.PortEnd() | ir.ChannelEnd():
                attachment = self._end(attachment)
            case DiscardEnd():
                pass
        return replaced(connection, attachment=attachment)

    def _created(self, part: ir.End | CreatedInstance | CreatedChoice) -> ir.End | CreatedInstance | CreatedChoice:
        match part:
            case CreatedInstance(instance=name):
                return CreatedInstance(self._name(name))
            case CreatedChoice(choice=name):
                return CreatedChoice(self._name(name))
            case ir.PortEnd() | ir.ChannelEnd():
                return self._end(part)

    def _equation(self, equation: SubmodelEquation) -> SubmodelEquation:
        inlined = renamed_equation(equation, self.prefix, self._values)
        assert isinstance(inlined, SubmodelEquation)
        return inlined

    def _any_equation(self, equation: SubmodelEquation | ExternalCall) -> SubmodelEquation | ExternalCall:
        return renamed_equation(equation, self.prefix, self._values)

    def _by_name(self, values: tuple[tuple[str, Expression], ...]) -> tuple[tuple[str, Expression], ...]:
        return tuple((self._name(name), self._inlined(value)) for name, value in values)

    def _inlined(self, item: T) -> T:
        """An action or expression in terms of the outer class."""
        return with_parts(item, self._replacement)

    def _replacement(self, part: object) -> object | None:
        match part:
            case ir.PortEnd() | ir.ChannelEnd():
                return self._end(part)
            case ir.Target(channel=channel, indexes=indexes):
                return ir.Target(self._name(channel), self._inlined(indexes))
            case ir.RunInstance(instance=name) | ir.ResetInstance(instance=name):
                return replaced(part, instance=self._name(name))
            case ir.ResetStates(states=states):
                return replaced(part, states=tuple(map(self._name, states)))
            case ir.Choice(name=name, branches=branches):
                return replaced(part, name=self._name(name), branches=self._inlined(branches))
            case ir.ReportCommunication(channel=channel, value=value):
                return replaced(part, channel=self._name(channel), value=self._inlined(value))
            case ir.ProcessScope():
                ends, body = self._inlined(part.ends), self._inlined(part.body)
                return replaced(part, instance=self._name(part.instance), ends=ends, body=body)
            case ir.ReadInputs(law=law, reads=reads):
                return replaced(part, law=self._name(law), reads=self._inlined(reads))
            case ir.InputRead(source=source, name=name):
                return replaced(part, source=self._end(source), name=self._name(name))
            case ir.WriteOutputs(law=law, writes=writes):
                return replaced(part, law=self._name(law), writes=self._inlined(writes))
            case ir.RunLaw():
                return self._law(part)
            case _:  # Any other part names values at most.
                return renamed_part(part, self.prefix, self._values)

    def _law(self, law: ir.RunLaw) -> ir.RunLaw:
        return replaced(
            law,
            law=self._name(law.law),
            equations=tuple(map(self._any_equation, law.equations)),
            next_values=self._by_name(law.next_values),
            derivative_equations=tuple(map(self._equation, law.derivative_equations)),
            derivatives=self._by_name(law.derivatives),
            sample=None if law.sample is None else self._inlined(law.sample),
        )


def _element(end: ir.PortEnd) -> str:
    return end.port if end.index is None else f"{end.port}[{end.index}]"
