"""The common part of the constructors of readable and optimized process classes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.plain.instances import path
from cspdiag.codegen.python.plain.members import Array, Members
from cspdiag.codegen.python.text.code import NONE, Argument, Call, Code, Name, WholeNumber, own, typed
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.modules import parameter_annotation, port_annotation
from cspdiag.codegen.python.text.rolling import rolled_list
from cspdiag.codegen.python.text.statements import Statement, assign
from cspdiag.codegen.python.text.types import annotation
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

    def _attributes(
        self, items: Sequence[LocalChannel] | Sequence[InstanceOf], made: Mapping[str, Code]
    ) -> Iterator[Statement]:
        """Assign the attributes of channels or instances; elements of an array that are missing in ``made`` become
        ``None``.
        """
        done: set[str] = set()
        for item in items:
            array = self.members.array_of(item.name)
            if array is None:
                yield assign(self.members.attribute(item.name), made[item.name])
            elif array.name not in done:
                done.add(array.name)
                elements = [made.get(element, NONE) for element in array.elements]
                yield assign(own(array.name), self._array(array, elements))

    def _array(self, array: Array, elements: Sequence[Code]) -> Code:
        """The elements of an array of channels or instances as a list."""
        return rolled_list(elements, self.members.index)
