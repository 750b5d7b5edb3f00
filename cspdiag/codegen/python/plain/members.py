"""The attributes of a process class: its reading ends, ports, channels, instances."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, KeysView, Mapping, Sequence
from functools import cached_property
from typing import TypeAlias, TypeVar

from cspdiag.base.record import record
from cspdiag.codegen.python.text.code import Code, Name, own
from cspdiag.codegen.python.text.names import PROCESS_MEMBERS, Names
from cspdiag.codegen.python.text.statements import Statement, bound_in
from cspdiag.codegen.shared.places_in_arrays import MANY, Elements, arrays_of, indexed, numbered_lines
from cspdiag.network.elaborate.fewer.rows import Strand, examples, without_repeated
from cspdiag.network.ir.actions import ChannelEnd, End, InputEvent, InputRead, PortEnd, ReadValue, ReadyEvent
from cspdiag.network.ir.network import CreatedInstance, InstanceOf, LocalChannel, Network, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import parts

Row: TypeAlias = LocalChannel | InstanceOf
R = TypeVar("R", bound=Row)


@record
class Array:
    """Instances or channels that are kept in one list: its attribute, and their rows in order."""

    name: str
    rows: Elements[Row]

    @cached_property
    def elements(self) -> tuple[str, ...]:
        """The names of all."""
        return tuple([row.name for row in self.rows])

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
        self._arrays: list[Array] = []
        self._places: dict[str, tuple[Array, int]] = {}
        self._known: dict[str, Array] = {}
        """The arrays of which the elements are not among these places, by what the names of the elements share."""
        all_rows: tuple[Sequence[Row], ...] = (process.channels, process.instances)
        for rows in all_rows:
            self._group(rows)
        for base, elements in lines_as_arrays(process).items():
            self._add_array(self.names.fresh(base), elements)
        self._plain = {
            item.name: self.names[item.name]
            for rows in all_rows
            for item in self.with_lists_once(rows)
            if self.place_of(item.name) is None
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
        sizes: dict[Code, int] = {own(array.name): len(array.rows) for array in self._arrays}
        for port in self.process.ports:
            if port.size is not None:
                sizes[Name(self.arguments[port.name])] = port.size
        return sizes

    def _group(self, rows: Sequence[Row]) -> None:
        for base, elements in arrays_of(rows).items():
            self._add_array(self.names[base], elements, base)

    def _add_array(self, name: str, elements: Elements[Row], base: str | None = None) -> None:
        array = Array(name, elements)
        self._arrays.append(array)
        if base is not None and elements.are_known:
            self._known[base] = array
        else:
            self._places.update({element: (array, index) for index, element in enumerate(array.elements)})

    def with_lists_once(self, rows: Sequence[R]) -> Iterator[R]:
        """The rows, but of those that are known to repeat and that are elements of lists only the first round."""
        return without_repeated(rows, lambda row: self.place_of(row.name) is not None)

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

    def place_of(self, name: str) -> tuple[Array, int] | None:
        """The list that contains an instance or channel, and where."""
        found = self._places.get(name)
        if found is None and self._known:
            place = indexed(name)
            array = None if place is None else self._known.get(place[0])
            if place is not None and array is not None and place[1] < len(array.rows):
                return (array, place[1]) if array.rows[place[1]].name == name else None
        return found

    def array_of(self, name: str) -> Array | None:
        """The list that contains an instance or channel."""
        place = self.place_of(name)
        return None if place is None else place[0]

    def attribute(self, name: str) -> Code:
        """``self.cell[3]`` for the channel or instance ``cell[3]``."""
        place = self.place_of(name)
        return own(self._plain[name]) if place is None else place[0].code.at(place[1])

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


def lines_as_arrays(process: ProcessClass) -> dict[str, Elements[Row]]:
    """Channels and instances with a line for each that are many and numbered, by what their names have in common;
    instances are made one directly after the other.
    """
    rows = (examples(process.channels), examples(process.instances))
    if not any(sum("[" not in item.name for item in items) >= MANY for items in rows):
        return {}
    channels = {item.name: (item.kind, item.type, item.capacity, item.doc) for item in process.channels}
    instances = {item.name: (item.class_name, item.doc) for item in process.instances}
    taken = {*channels, *instances, *(item.name for item in (*process.parameters, *process.ports))}
    taken |= {place[0] for place in map(indexed, taken) if place is not None}
    places = {name: at for at, name in enumerate(channels)}
    found: dict[str, Elements[Row]] = {}
    for base, names in numbered_lines(channels, taken).items():
        found[base] = Elements(process.channels, [Strand(places[name], 1, 1) for name in names])
    made = {item.instance: at for at, item in enumerate(process.creation) if isinstance(item, CreatedInstance)}
    declared = {name: at for at, name in enumerate(instances)}
    for base, names in numbered_lines(instances, taken).items():
        if _is_run(names, made) and _is_run(names, declared):
            found[base] = Elements(process.instances, [Strand(declared[name], 1, 1) for name in names])
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

    for part in parts(process.body) if process.body is not None and (inputs or broadcast) else ():
        if isinstance(part, ReadValue | ReadyEvent | InputEvent | InputRead):
            add(part.source)
    read = {
        (entry.name, port.name)
        for entry in network.classes
        if isinstance(entry, SubmodelClass)
        for port in entry.ports
        if port.direction == "in"
    }
    for instance in process.instances if read else ():
        for connection in instance.connections:
            if (instance.class_name, connection.port) in read:
                add(connection.attachment)
    return found.keys()
