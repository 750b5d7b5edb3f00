"""The creation of an instance inside a process: the call of its constructor, with its arguments and the ends for its
ports.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Mapping, Sequence
from typing import assert_never

from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.plain.external import ExternalModules, converting
from cspdiag.codegen.python.plain.laws.submodels import signal_names
from cspdiag.codegen.python.plain.members import Members
from cspdiag.codegen.python.text.code import Argument, Call, Code, Element, Formatted, Name, WholeNumber, call
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.names import MEMBERS, PROCESS_MEMBERS, Names
from cspdiag.codegen.python.text.rolling import rolled_list
from cspdiag.codegen.shared.places_in_arrays import NUMBER
from cspdiag.codegen.shared.trees import Outline
from cspdiag.model.types import IntType
from cspdiag.network.ir.actions import ChannelEnd, PortEnd
from cspdiag.network.ir.expressions import Expression, LiteralValue, TunableValue
from cspdiag.network.ir.network import (
    Connection,
    ConstantEnd,
    DiscardEnd,
    InstanceOf,
    Network,
    Port,
    ProcessClass,
    SubmodelClass,
)

_NAME = Name("name")
_NUMBERS = re.compile(rf"((?<=\[)\d+(?=\])|{NUMBER})")


class Instances:
    """Creates the instances of one process class; ``initial`` prints expressions of its parameters in the
    constructor.
    """

    def __init__(
        self, network: Network, members: Members, initial: Printer, imports: Imports, modules: ExternalModules
    ) -> None:
        self.network = network
        self.members = members
        self.initial = initial
        self.imports = imports
        self.modules = modules
        self._keywords: dict[str, Mapping[str, str]] = {}

    def made(self, instance: InstanceOf) -> Code:
        """The call that creates it."""
        class_ = self.network.class_named(instance.class_name)
        if class_.name not in self._keywords:
            self._keywords[class_.name] = keywords_of(class_)
        keywords = self._keywords[class_.name]
        arguments = [Argument(path(instance.name))]
        arguments += [Argument(self._argument(value), keywords[name]) for name, value in instance.arguments]
        for port in class_.ports:
            attached = [c for c in instance.connections if c.port == port.name]
            value = self._attached(port, attached, isinstance(class_, SubmodelClass))
            if isinstance(class_, ProcessClass) and class_.external is not None:
                value = converting(port, value, self.imports)
            arguments.append(Argument(value, keywords[port.name]))
        if isinstance(class_, ProcessClass) and class_.external is not None:
            return Call(Name(self.modules.imported(class_.external, self.imports)), tuple(arguments))
        return Call(Name(self.imports.class_(class_.name)), tuple(arguments))

    def row(self, instance: InstanceOf) -> Outline:
        """What the call that creates an instance depends on: if another instance has a row of the same shape, both
        calls differ at most in numbers, and these are among those of the rows.
        """
        if isinstance(self.network.class_named(instance.class_name), SubmodelClass):
            return Outline(instance, ())  # A reading end has a name of its own.
        texts, numbers = numbers_in_name(instance.name)
        shape: list[Hashable] = [texts, instance.class_name]
        for _, value in instance.arguments:
            if not (
                isinstance(value, LiteralValue)
                and value.name is None
                and isinstance(value.type, IntType)
                and isinstance(value.value, int)
                and value.value >= 0
            ):
                shape.append(printed_alike(value))
            else:
                shape.append("number")
                numbers.append(value.value)
        for connection in instance.connections:
            if connection.index is not None:
                return Outline(instance, ())  # What is attached may be a whole array.
            attachment = connection.attachment
            if isinstance(attachment, ChannelEnd):
                place = self.members.place_of(attachment.channel)
                if place is None:
                    shape += "channel", attachment.channel
                else:
                    shape += "array", place[0].name
                    numbers.append(place[1])
            elif isinstance(attachment, PortEnd) and attachment.index is not None:
                shape += "element", attachment.port, attachment.end
                numbers.append(attachment.index)
            elif isinstance(attachment, ConstantEnd):
                shape += "constant", printed_alike(attachment.value)
            else:
                shape.append(attachment)
        return Outline(tuple(shape), tuple(numbers))

    def _argument(self, value: Expression) -> Code:
        if isinstance(value, TunableValue):
            return self.initial.reference(value)
        return self.initial.print(value)

    def _attached(self, port: Port, connections: Sequence[Connection], by_submodel: bool) -> Code:
        ordered = sorted(connections, key=lambda connection: connection.index or 0)
        values = [self._attachment(port, connection, by_submodel) for connection in ordered]
        if port.size is None:
            return values[0]
        return self._whole(values) or rolled_list(values, self.members.index)

    def _whole(self, values: Sequence[Code]) -> Code | None:
        """The list that has exactly these elements in this order; None if there is none."""
        first = values[0]
        if not isinstance(first, Element) or self.members.list_sizes.get(first.operand) != len(values):
            return None
        return first.operand if list(values) == [first.operand.at(index) for index in range(len(values))] else None

    def _attachment(self, port: Port, connection: Connection, by_submodel: bool) -> Code:
        attachment = connection.attachment
        match attachment:
            case ConstantEnd(value=value):
                return call(self.imports.runtime("Constant"), self.initial.print(value))
            case DiscardEnd():
                return call(self.imports.runtime("Discard"))
            case PortEnd() | ChannelEnd():
                if by_submodel and port.direction == "in":
                    return self.members.source(attachment)
                return self.members.passed_to_instance(attachment)
            case _:
                assert_never(attachment)


def keywords_of(class_: ProcessClass | SubmodelClass) -> Mapping[str, str]:
    """The keywords of a class's constructor, by parameter and port."""
    if isinstance(class_, ProcessClass):
        names = Names(MEMBERS if class_.external is not None else PROCESS_MEMBERS)
    else:
        names = signal_names(class_)
    return {item.name: names[item.name] for item in (*class_.parameters, *class_.ports)}


def path(name: str, owner: Code | None = None) -> Code:
    """The hierarchical name of a part, as an extension of the ``name`` of the process."""
    parts = _NUMBERS.split(name)
    counted = [WholeNumber(int(part)) if position % 2 else part for position, part in enumerate(parts)]
    return Formatted((owner or _NAME, ".", *counted))


def printed_alike(value: Expression) -> Hashable:
    """Equal for expressions that have the same text; places and names of constants, too, may matter for that."""
    return (value, value.span, value.name) if isinstance(value, LiteralValue) else id(value)


def numbers_in_name(name: str) -> tuple[tuple[str, ...], list[int]]:
    """The parts of a name between the numbers that may count in it, and these numbers."""
    parts = _NUMBERS.split(name)
    return tuple(parts[::2]), [int(part) for part in parts[1::2]]
