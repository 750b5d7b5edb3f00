"""The common part of the constructors of readable and optimized process classes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeGuard

from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.plain.instances import Instances, numbers_in_name, path, printed_alike
from cspdiag.codegen.python.plain.members import Array, Members, Row
from cspdiag.codegen.python.text.code import NONE, Argument, Call, Code, Name, WholeNumber, own, typed
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.modules import parameter_annotation, port_annotation
from cspdiag.codegen.python.text.rolling import rolled_rows
from cspdiag.codegen.python.text.statements import Statement, assign
from cspdiag.codegen.python.text.types import annotation
from cspdiag.codegen.shared.trees import Outline, stretches, stretches_of
from cspdiag.network.ir.network import InstanceOf, LocalChannel, Port, ProcessClass

CHANNEL_CLASSES = {
    "var": "Variable",
    "sync": "Channel",
    "broadcast": "Broadcast",
    "any": "AnyChannel",
    "buffer": "Buffer",
    "overwrite": "Overwriting",
}
"""The class of the runtime for each kind of channel."""


class ConstructorWriter:
    """Writes parts of the constructor of one class; ``initial`` prints expressions of its parameters."""

    process: ProcessClass
    members: Members
    imports: Imports
    initial: Printer
    instances: Instances

    def _argument(self, name: str) -> Code:
        return Name(self.members.arguments[name])

    def _parameters(self) -> tuple[str, ...]:
        arguments = self.members.arguments
        keywords = [f"{arguments[p.name]}: {parameter_annotation(p, self.imports)}" for p in self.process.parameters]
        keywords += [f"{arguments[p.name]}: {self._port_annotation(p)}" for p in self.process.ports]
        return ("self", "name: str", *(["*", *keywords] if keywords else []))

    def _port_annotation(self, port: Port) -> str:
        return port_annotation(port, self.imports)

    def _channel(self, channel: LocalChannel) -> Code:
        arguments = [Argument(path(channel.name))]
        if channel.initial is not None:
            arguments.append(Argument(self.initial.print(channel.initial)))
        if channel.capacity is not None:
            arguments.append(Argument(WholeNumber(channel.capacity), "capacity"))
        class_ = self.imports.runtime(self._channel_class(channel))
        return Call(typed(class_, annotation(channel.type, self.imports)), tuple(arguments))

    def _channel_class(self, channel: LocalChannel) -> str:
        return CHANNEL_CLASSES[channel.kind]

    def _channels_made(self, channels: Sequence[LocalChannel]) -> Iterator[Statement]:
        """Assign the attributes of channels; elements of an array that are not among them are ``None``."""
        made = None if channels is self.process.channels else frozenset(channel.name for channel in channels)
        done: set[str] = set()
        for channel in self.members.with_lists_once(channels):
            array = self.members.array_of(channel.name)
            if array is None:
                yield assign(self.members.attribute(channel.name), self._channel(channel))
            elif array.name not in done:
                done.add(array.name)
                yield assign(own(array.name), self._array(array, self._channel_list(array, made)))

    def _channel_list(self, array: Array, made: frozenset[str] | None) -> Code:
        """The list of the channels of an array, without those that are not ``made``."""

        def is_made(channel: Row) -> TypeGuard[LocalChannel]:
            return isinstance(channel, LocalChannel) and (made is None or channel.name in made)

        def element(position: int) -> Code:
            channel = array.rows[position]
            return self._channel(channel) if is_made(channel) else NONE

        def row(channel: Row) -> Outline:
            return self._row(channel) if is_made(channel) else _NO_CHANNEL

        if made is None and array.rows.are_known and all(map(self._have_one_class, array.rows.parts())):
            rows = stretches_of(array.rows.parts(), row)
        else:
            rows = stretches(map(row, array.rows))
        return rolled_rows(rows, element, self.members.index)

    def _have_one_class(self, channels: Sequence[Row]) -> bool:
        """Whether channels that differ in numbers only have objects of the same class."""
        return True

    def _row(self, channel: LocalChannel) -> Outline:
        """What the creation of a channel depends on."""
        texts, numbers = numbers_in_name(channel.name)
        initial = None if channel.initial is None else printed_alike(channel.initial)
        if channel.capacity is not None:
            numbers.append(channel.capacity)
        shape = (texts, self._channel_class(channel), channel.type, initial, channel.capacity is None)
        return Outline(shape, tuple(numbers))

    def _made_instance(self, instance: InstanceOf, arrays: set[str]) -> Iterator[Statement]:
        """Make an instance, or the whole array that it is an element of unless that is among the ``arrays`` that were
        made.
        """
        array = self.members.array_of(instance.name)
        if array is None:
            yield assign(self.members.attribute(instance.name), self.instances.made(instance))
        elif array.name not in arrays:
            arrays.add(array.name)
            yield assign(own(array.name), self._array(array, self._instance_list(array)))

    def _instance_list(self, array: Array) -> Code:
        """The list with all instances of an array."""

        def element(position: int) -> Code:
            instance = array.rows[position]
            assert isinstance(instance, InstanceOf)
            return self.instances.made(instance)

        def row(instance: Row) -> Outline:
            assert isinstance(instance, InstanceOf)
            return self.instances.row(instance)

        rows = stretches_of(array.rows.parts(), row) if array.rows.are_known else stretches(map(row, array.rows))
        return rolled_rows(rows, element, self.members.index)

    def _array(self, array: Array, elements: Code) -> Code:
        """The list of the elements of an array of channels or instances."""
        return elements


_NO_CHANNEL = Outline(None, ())
