"""The attributes of a process class: its reading ends, ports, channels, instances."""

from __future__ import annotations

from collections.abc import Iterable, KeysView, Mapping, Sequence
from functools import cached_property

from cspdiag.base.record import record
from cspdiag.codegen.python.text.code import Code, Name, own
from cspdiag.codegen.python.text.names import PROCESS_MEMBERS, Names
from cspdiag.codegen.python.text.statements import Statement, bound_in
from cspdiag.codegen.shared.places_in_arrays import MANY, indexed, numbered_lines
from cspdiag.network.ir.actions import ChannelEnd, End, InputEvent, InputRead, PortEnd, ReadValue, ReadyEvent
from cspdiag.network.ir.network import CreatedInstance, InstanceOf, LocalChannel, Network, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import parts


@record
class Array:
    """Instances or channels that are kept in one list: its attribute, and their names in order."""

    name: str
    elements: tuple[str, ...]
    positions: Mapping[str, int]

    @cached_property
    def code(self) -> Code:
        """The list."""
        return own(self.name)


class Members:
    """The attributes of ``self`` for everything in a process class."""

    def __init__(self, process: ProcessClass, network: Network) -> None:
        self.process = process
        self.names = Names(PROCESS_MEMBERS)
        self.arguments = {item.name: self.names[item.name] for item in (*process.parameters, *process.ports)}
        self._ports = {port.name: port for port in process.ports}
        self._channels = {channel.name: channel for channel in process.channels}
        self._arrays: dict[str, Array] = {}
        self._group(process.channels)
        self._group(process.instances)
        for base, names in lines_as_arrays(process).items():
            self._add_array(self.names.fresh(base), names)
        self._plain = {
            item.name: self.names[item.name]
            for item in (*process.channels, *process.instances)
            if item.name not in self._arrays
        }
        self.reading_ends = _reading_ends(process, network)
        self._ends = self._name_ends()
        self.index = self.names.fresh("i")
        """The variable of loops over elements."""
        self._indexes = [self.index]

    def index_around(self, groups: Iterable[Iterable[Statement]]) -> str:
        """The variable of a loop around these statements, which may contain loops with variables of their own."""
        bound = {name for group in groups for name in bound_in(group)}
        for name in self._indexes:
            if name not in bound:
                return name
        self._indexes.append(self.names.fresh(chr(ord("i") + len(self._indexes) % 18)))
        return self._indexes[-1]

    @property
    def list_sizes(self) -> dict[Code, int]:
        """The lengths of the lists, by the expressions for them."""
        sizes: dict[Code, int] = {own(array.name): len(array.elements) for array in self._arrays.values()}
        for port in self.process.ports:
            if port.size is not None:
                sizes[Name(self.arguments[port.name])] = port.size
        return sizes

    def _group(self, items: Sequence[LocalChannel] | Sequence[InstanceOf]) -> None:
        grouped: dict[str, dict[int, str]] = {}
        for item in items:
            place = indexed(item.name)
            if place is not None:
                grouped.setdefault(place[0], {})[place[1]] = item.name
        for base, elements in grouped.items():
            if sorted(elements) == list(range(len(elements))):
                self._add_array(self.names[base], [elements[index] for index in sorted(elements)])

    def _add_array(self, name: str, elements: Sequence[str]) -> None:
        array = Array(name, tuple(elements), {element: index for index, element in enumerate(elements)})
        self._arrays.update(dict.fromkeys(array.elements, array))

    def _name_ends(self) -> dict[End, str]:
        names: dict[End, str] = {}
        for end in self.reading_ends:
            whole = _whole(end)
            if whole in names:
                continue
            if isinstance(end, PortEnd):
                base = self.arguments[end.port]
                names[whole] = base if end.end == 0 else self.names.fresh(f"{base}_{end.end + 1}")
            else:
                names[whole] = self.names.fresh(f"{end.channel}_end_{end.end + 1}")
        return names

    def array_of(self, name: str) -> Array | None:
        """The list that contains an instance or channel."""
        return self._arrays.get(name)

    def attribute(self, name: str) -> Code:
        """``self.cell[3]`` for the channel or instance ``cell[3]``."""
        array = self._arrays.get(name)
        return own(self._plain[name]) if array is None else array.code.at(array.positions[name])

    channel = attribute
    instance = attribute

    def end_name(self, end: End) -> str:
        """The attribute of a reading end, without its index."""
        return self._ends[_whole(end)]

    def source(self, end: End) -> Code:
        """The expression for a reading end of this process."""
        if end not in self.reading_ends:
            return self.sink(end)
        return _indexed(own(self.end_name(end)), end)

    def sink(self, end: End) -> Code:
        """The expression for an end to write to."""
        if isinstance(end, ChannelEnd):
            return self.attribute(end.channel)
        return _indexed(own(self.arguments[end.port]), end)

    def passed_to_instance(self, end: End) -> Code:
        """The expression that is passed to an instance of a process: the port or channel itself, of which it makes its
        own ends.
        """
        if isinstance(end, ChannelEnd):
            return self.attribute(end.channel)
        return _indexed(Name(self.arguments[end.port]), end)

    def is_input(self, end: End) -> bool:
        """Whether an end is an input port of the class."""
        return isinstance(end, PortEnd) and self._ports[end.port].direction == "in"


def lines_as_arrays(process: ProcessClass) -> dict[str, Sequence[str]]:
    """Channels and instances with a line for each that are many and numbered, by what their names have in common;
    instances are made one directly after the other.
    """
    if not any(sum("[" not in item.name for item in items) >= MANY for items in (process.channels, process.instances)):
        return {}
    channels = {item.name: (item.kind, item.type, item.capacity, item.doc) for item in process.channels}
    instances = {item.name: (item.class_name, item.doc) for item in process.instances}
    taken = {*channels, *instances, *(item.name for item in (*process.parameters, *process.ports))}
    taken |= {place[0] for place in map(indexed, taken) if place is not None}
    found = numbered_lines(channels, taken)
    made = {item.instance: at for at, item in enumerate(process.creation) if isinstance(item, CreatedInstance)}
    declared = {name: at for at, name in enumerate(instances)}
    for base, names in numbered_lines(instances, taken).items():
        if _is_run(names, made) and _is_run(names, declared):
            found[base] = names
    return found


def _is_run(names: Sequence[str], places: Mapping[str, int]) -> bool:
    """Whether names have consecutive places, or none has one."""
    first = places.get(names[0])
    return all(places.get(name) == (None if first is None else first + at) for at, name in enumerate(names))


def _indexed(port: Code, end: End) -> Code:
    return port.at(end.index) if isinstance(end, PortEnd) and end.index is not None else port


def _whole(end: End) -> End:
    return PortEnd(end.port, None, end.end) if isinstance(end, PortEnd) else end


def _reading_ends(process: ProcessClass, network: Network) -> KeysView[End]:
    """The ends through which this process or its submodels read: of input ports, and of broadcast channels."""
    broadcast = {channel.name for channel in process.channels if channel.kind == "broadcast"}
    inputs = {port.name for port in process.ports if port.direction == "in"}
    found: dict[End, None] = {}

    def add(end: object) -> None:
        if (isinstance(end, PortEnd) and end.port in inputs) or (
            isinstance(end, ChannelEnd) and end.channel in broadcast
        ):
            found[end] = None

    for part in parts(process.body) if process.body is not None else ():
        if isinstance(part, ReadValue | ReadyEvent | InputEvent | InputRead):
            add(part.source)
    for instance in process.instances:
        class_ = network.class_named(instance.class_name)
        if isinstance(class_, SubmodelClass):
            read = {port.name for port in class_.ports if port.direction == "in"}
            for connection in instance.connections:
                if connection.port in read:
                    add(connection.attachment)
    return found.keys()
