"""The layout of the struct through which a process receives its ports."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from cspdiag.codegen.c.text.code import Code, code
from cspdiag.codegen.c.text.media import access_of, port_type
from cspdiag.codegen.c.text.names import PROCESS_LOCALS, Names
from cspdiag.network.ir.network import Port, ProcessClass


class PortLayout:
    """The members for the ports of one class; an array of ports is an array in C if all elements have the same kind of
    connection.
    """

    def __init__(self, process: ProcessClass, macros: Collection[str]) -> None:
        """``macros``: names that no member may have."""
        self.names = Names((*PROCESS_LOCALS, *macros))
        self.parameters = {item.name: self.names[item.name] for item in process.parameters}
        self.ports = {port.name: port for port in process.ports}
        for port in process.ports:
            self.names[port.name]
        self.uniform = {port.name: len({access_of(medium) for medium in port.media}) <= 1 for port in process.ports}

    def member(self, port: Port, index: int | Code | None) -> Code:
        """The member of a port, or of an element of an array of ports."""
        return self.element(self.names[port.name], port, index)

    def written(self, port: Port, index: int | None) -> str:
        """The member for the pointer to the flag whether the variable that is connected to a port was written."""
        suffix = "" if index is None else f"_{index}"
        return self.names[f"{self.names[port.name]}{suffix} written"]

    def element(self, base: str, port: Port, index: int | Code | None) -> Code:
        """The member with the given base name for a port, or for an element of an array of ports."""
        if index is None:
            return code(base)
        return code(base).at(index) if self.uniform[port.name] else code(f"{base}_{index}")

    def designator(self, port: str, index: int | None) -> Code | None:
        """The designator of a port in an initializer; None for a port that has no member."""
        found = self.ports[port]
        type_ = port_type(access_of(found.media[index or 0]), "", writes=found.direction == "out")
        return None if type_ is None else self.member(found, index)


def elements(port: Port) -> Sequence[int | None]:
    """The indexes of an array of ports; for a single port, None only."""
    return [None] if port.size is None else range(port.size)
