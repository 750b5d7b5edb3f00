"""The members of the struct of a process class, and how step functions refer to them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

from cspdiag.base.record import record, replaced
from cspdiag.codegen.c.process.struct.port_layout import PortLayout, elements
from cspdiag.codegen.c.process.struct.signals import kept_signals, made_signals
from cspdiag.codegen.c.process.struct.unwritten import Unwritten
from cspdiag.codegen.c.text.code import Code, address, cast, code, own, target
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.c.text.media import (
    READING_ENDS,
    Access,
    EndInC,
    access_of,
)
from cspdiag.codegen.c.text.names import PROCESS_LOCALS, Names
from cspdiag.codegen.c.text.numbered import Numbered
from cspdiag.codegen.c.text.operands import is_int64
from cspdiag.codegen.c.text.statements import Statement
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.codegen.shared.laws.equations import finite_signals
from cspdiag.codegen.shared.places_in_arrays import Arrays
from cspdiag.model.types import TimeType, Type
from cspdiag.network.elaborate.fewer.rows import examples, without_repeated
from cspdiag.network.ir.actions import ChannelEnd, End, PortEnd, ProcessScope, ResetStates, RunLaw
from cspdiag.network.ir.expressions import ParameterValue, TunableValue
from cspdiag.network.ir.network import (
    CreatedChoice,
    CreatedInstance,
    InstanceOf,
    LocalChannel,
    Network,
    Port,
    ProcessClass,
    channels_of,
)
from cspdiag.network.ir.walk import PartsByType

R = TypeVar("R", LocalChannel, InstanceOf)


@record
class StructMember:
    """A member of a struct: its declaration without the semicolon, and its comment."""

    declaration: str
    comment: str | None = None


@record
class NumberedEnd(PortEnd):
    """The element of an array of ports that the present branch selects by its number; ``index`` is that of the first
    branch.
    """

    number: Numbered = Numbered(())


@dataclass
class Members:
    """The contents of the struct of one process class; ``work`` are the members that its composition adds."""

    process: ProcessClass
    network: Network
    types: CTypes
    unwritten: Unwritten
    work: list[StructMember] = field(default_factory=list)
    structs: dict[str, list[StructMember]] = field(default_factory=dict)
    """Members that are structs, one for each alternative."""
    made_choices: dict[str, list[Statement]] = field(default_factory=dict)
    """The statements that initialize the alternatives, by name."""
    reports: dict[str, tuple[int, Type]] = field(default_factory=dict)
    """Channels that were optimized away, by path, with their number and type."""

    def __post_init__(self) -> None:
        process = self.process
        self.inside = PartsByType(process.body)
        self.layout = PortLayout(process, self.types.names.macros)
        self.names = self.layout.names
        self.parameters = self.layout.parameters
        self.ports = self.layout.ports
        self.channels = {channel.name: channel for channel in process.channels}
        self.arrays = Arrays(
            (process.channels, lambda item: (access_of(item), item.type, item.capacity, item.doc)),
            (process.instances, lambda item: (item.class_name, item.doc)),
            taken={*self.parameters, *self.ports},
        )
        self._plain: dict[str, str] = {}
        for row in (*self.with_arrays_once(process.channels), *self.with_arrays_once(process.instances)):
            self._plain[row.name] = self.names[self.arrays.base(row.name)]
        self._elements_by_number: dict[str, tuple[str, Numbered]] = {}
        self._numbers: dict[str, Code] = {}
        self.classes = {entry.name: entry for entry in self.network.classes}
        self.instances = {instance.name: instance for instance in process.instances}
        created = without_repeated(process.creation, lambda item: isinstance(item, CreatedInstance))
        self.created = [item for item in created if not isinstance(item, CreatedInstance | CreatedChoice)]
        self._end_names: dict[End, str] = {}
        self._scopes = {end: scope.instance for scope in self.inside.of(ProcessScope) for end in scope.ends}
        self._name_ends()
        sampled = [end for end in self.created if self.access(end) == "sampled"]
        self.has_samples = any(end not in self._scopes for end in sampled)
        self.scope_samples = {
            scope: self.names.fresh(f"{scope} samples")
            for scope in dict.fromkeys(self._scopes[end] for end in sampled if end in self._scopes)
        }
        self._own = self._own_variables()
        self._prepare_signals()

    def _prepare_signals(self) -> None:
        process = self.process
        assert process.body is not None
        laws = self.inside.of(RunLaw)
        self.finite_signals = finite_signals([equation for law in laws for equation in law.equations])
        made = made_signals(process.body, self.inside)
        self.signal_types = {item.name: item.type for item in process.constants}
        self.signal_types |= {item.name: item.type for item in process.states} | made
        kept = kept_signals(process, made, self.inside)
        self.signal_members = {name: self.names.fresh(name) for name in kept}
        local = Names({*self.types.names.globals, *PROCESS_LOCALS, "self", "h"})
        self.local_signals = {name: local.fresh(name) for name in self.signal_types if name not in self.signal_members}

    def _own_variables(self) -> set[str]:
        """Variables that are not connected to a port of an instance."""
        if not any(channel.kind == "var" for channel in examples(self.process.channels)):
            return set()
        processes = (i for i in self.process.instances if isinstance(self.classes[i.class_name], ProcessClass))
        return self.channels.keys() - channels_of(processes)

    # What is needed at run time

    def stored_parameters(self) -> list[str]:
        """Parameters that step functions use: those in the composition, and in the initial values of states that it
        resets.
        """
        reset = {name for step in self.inside.of(ResetStates) for name in step.states}
        initial = PartsByType(tuple(state.initial for state in self.process.states if state.name in reset))
        places = (self.inside, initial)
        used = {part.name for place in places for part in place.of(ParameterValue)}
        used |= {part.name for place in places for part in place.of(TunableValue)}
        return [name for name in self.parameters if name in used]

    def used_ports(self) -> list[tuple[Port, int | None]]:
        """Ports, or elements of arrays of ports, that step functions use themselves."""
        used: set[tuple[str, int | None]] = set()
        for part in (*self.inside.of(PortEnd), *self.ends_of_laws()):
            if isinstance(part, PortEnd):
                used.add((part.port, part.index))
        places = ((port, index) for port in self.process.ports for index in elements(port))
        return [(port, index) for port, index in places if (port.name, index) in used]

    def ends_of_laws(self) -> Iterator[object]:
        """What the submodels of the class are connected to."""

        def is_of_process(instance: InstanceOf) -> bool:
            return isinstance(self.classes[instance.class_name], ProcessClass)

        for instance in without_repeated(self.process.instances, is_of_process):
            if not is_of_process(instance):
                yield from (connection.attachment for connection in instance.connections)

    # How members are written in expressions

    def with_arrays_once(self, rows: Sequence[R]) -> Iterator[R]:
        """The channels or instances, but of those that are known to repeat and that are elements of arrays only the
        first round.
        """
        return without_repeated(rows, lambda row: self.arrays.place(row.name)[1] is not None)

    def plain(self, name: str) -> str:
        """The member of a channel or instance; elements of arrays have the member of the array."""
        return self._plain.get(name) or self.names[self.arrays.base(name)]

    def member(self, name: str) -> Code:
        """The member of a channel or instance: ``cell[3]``."""
        return self._element(self.plain(name), name)

    def _element(self, array: str, name: str) -> Code:
        if name in self._elements_by_number:
            return code(array).at(self._elements_by_number[name][1])
        index = self.arrays.place(name)[1]
        return code(array) if index is None else code(array).at(index)

    def variable(self, name: str) -> Code:
        """The lvalue of a variable."""
        return self._numbers[name] if name in self._numbers else own(self.member(name))

    def numbered(self, array: str, index: Numbered, start: int) -> str:
        """A name for the element of an array of channels or instances that a branch selects by its number; the first
        branch selects that at ``start``.
        """
        name = f"{array}[]"
        while self._elements_by_number.setdefault(name, (array, index)) != (array, index):
            name += "[]"
        first = self.arrays.element(array, start)
        self._plain[name] = self.plain(first)
        if first in self.channels:
            self.channels[name] = self.channels[first]
        else:
            self.instances[name] = self.instances[first]
        return name

    def number(self, value: Numbered, type_: Type) -> str:
        """A name, as of a variable, for an integer that follows from the number of the branch."""
        wide = replaced(value, type_name="int64_t", is_duration=isinstance(type_, TimeType))
        number = wide if is_int64(type_) else cast(self.types.type_name(type_), wide)
        self._numbers[str(number)] = number
        return str(number)

    def written(self, name: str) -> Code | None:
        """The flag whether a variable was written; None if it always is before it is read."""
        if name not in self.unwritten.variables[self.process.name]:
            return None
        return own(self._element(self.names[f"{self.plain(name)} written"], name))

    def _flag(self, name: str) -> Code | None:
        """A pointer to the flag whether a variable was written."""
        written = self.written(name)
        return None if written is None else address(written)

    def running_parameter(self, name: str) -> Code:
        """A parameter in a step function."""
        return own(self.parameters[name])

    def initial_parameter(self, name: str) -> Code:
        """A parameter in the function that initializes the process."""
        return code(self.parameters[name])

    def signal(self, name: str) -> Code:
        """The lvalue of a signal of an inlined law, a state or a constant."""
        local = self.local_signals.get(name)
        return own(self.signal_members[name]) if local is None else code(local)

    @property
    def initial_printer(self) -> Printer:
        """The printer for expressions in the initialization function."""
        return Printer(self.types, parameter=self.initial_parameter, signal=self.signal, variable=self.variable)

    @property
    def running_printer(self) -> Printer:
        """The printer for expressions in step functions."""
        return Printer(
            self.types,
            parameter=self.running_parameter,
            signal=self.signal,
            variable=self.variable,
            written=self._flag,
        )

    def is_own(self, variable: str) -> bool:
        """Whether a variable is used by this process only."""
        return variable in self._own

    def samples(self, end: End) -> str:
        """The member that closes a reading end: that of the process or of the scope that owns it."""
        scope = self._scopes.get(end)
        return "samples" if scope is None else self.scope_samples[scope]

    def samples_of_scope(self, scope: str) -> str | None:
        """The member that closes the ends of a scope; None if it has none."""
        return self.scope_samples.get(scope)

    def report(self, channel: str, type_: Type) -> int:
        """The number, within the class, of a channel that was optimized away."""
        return self.reports.setdefault(channel, (len(self.reports), type_))[0]

    def access(self, end: End) -> Access:
        """The access to what an end belongs to."""
        if isinstance(end, ChannelEnd):
            return access_of(self.channels[end.channel])
        return access_of(self.ports[end.port].media[end.index or 0])

    def type(self, end: End) -> Type:
        """The type of the values at an end."""
        return self.channels[end.channel].type if isinstance(end, ChannelEnd) else self.ports[end.port].type

    def source(self, end: End) -> EndInC:
        """The C text of an end that is read."""
        return self._end_in_c(end, reads=True)

    def sink(self, end: End) -> EndInC:
        """The C text of an end that is written."""
        return self._end_in_c(end, reads=False)

    def _end_in_c(self, end: End, *, reads: bool) -> EndInC:
        access, type_, name = self.access(end), self.type(end), name_of(end)
        if reads and access in READING_ENDS:
            member = self.end_member(end)
            indirect = access == "event"
            return EndInC(access, own(member) if indirect else address(own(member)), member, indirect, type_, name)
        if isinstance(end, ChannelEnd):
            member = self.member(end.channel)
            pointer = own(member) if access == "variable" else address(own(member))
            written = self._flag(end.channel)
        else:
            member = self.layout.member(self.ports[end.port], _place(end))
            pointer = target(own(member)) if access == "variable" else own(member)
            flagged = self.unwritten.has_port(self.process.name, end.port, end.index)
            written = own(self.layout.written(self.ports[end.port], end.index)) if flagged else None
        return EndInC(access, pointer, member, isinstance(end, PortEnd), type_, name, written)

    def end_member(self, end: End) -> Code:
        """The member for a reading end: the object itself, or for an event input the pointer to its latch."""
        base = self.end_name(end)
        return self.layout.element(base, self.ports[end.port], _place(end)) if isinstance(end, PortEnd) else code(base)

    def _name_ends(self) -> None:
        """The end of a process that was flattened into this one is named after both."""
        read_in: dict[End, set[str | None]] = {}
        for end in self.created:
            read_in.setdefault(_whole(end), set()).add(self._scopes.get(end))
        for end in self.created:
            whole = _whole(end)
            if whole in self._end_names or self.access(end) not in READING_ENDS:
                continue
            if isinstance(end, PortEnd):
                base, scopes = self.names[end.port], read_in[whole]
                scope = next(iter(scopes)) if len(scopes) == 1 else None
                if scope is not None:
                    self._end_names[whole] = self.names.fresh(f"{scope} {base}")
                else:
                    self._end_names[whole] = base if end.end == 0 else self.names.fresh(f"{base}_{end.end + 1}")
            else:
                self._end_names[whole] = self.names.fresh(
                    f"{end.channel}_end{'' if end.end == 0 else f'_{end.end + 1}'}"
                )

    # Members that belong to others

    def end_name(self, end: End) -> str:
        """The member for a reading end, or for those of an array of ports."""
        return self._end_names[_whole(end)]

    def latch_name(self, base: str) -> str:
        """The member for the latch of the reading end ``base``."""
        return self.names[f"{base} latch"]

    def latch(self, end: PortEnd) -> Code:
        """The member for the latch that a reader of an event input may have of its own."""
        base, uniform = self.end_name(end), self.layout.uniform[end.port]
        if end.index is None or uniform:
            return self.layout.element(self.latch_name(base), self.ports[end.port], end.index)
        return code(self.latch_name(f"{base}_{end.index}"))

    def storage_name(self, channel: str) -> str:
        """The name of the member for the values of a buffer, or of an array of buffers."""
        return self.names[f"{self.plain(channel)} values"]

    def storage(self, channel: str) -> Code:
        """The member for the values of a buffer."""
        return self._element(self.storage_name(channel), channel)


def name_of(end: End) -> str:
    """The name of an end as part of the names of states."""
    return end.port if isinstance(end, PortEnd) else end.channel


def _place(end: PortEnd) -> int | Code | None:
    return end.number if isinstance(end, NumberedEnd) else end.index


def _whole(end: End) -> End:
    return PortEnd(end.port, None, end.end) if isinstance(end, PortEnd) else end
