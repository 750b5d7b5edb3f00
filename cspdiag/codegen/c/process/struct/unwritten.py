"""Variables that may be read before they are written: which ones need a flag, and which ports a pointer to one."""

from __future__ import annotations

from functools import cached_property
from typing import assert_never

from cspdiag.network.checks.unwritten import may_be_unwritten, ports_of_unwritten
from cspdiag.network.ir.actions import ChannelEnd, PortEnd
from cspdiag.network.ir.network import ConstantEnd, DiscardEnd, Network, ProcessClass

Place = tuple[str, int | None]


class Unwritten:
    """The variables and ports of a network that may be read before they are written."""

    def __init__(self, network: Network) -> None:
        self._network = network

    @cached_property
    def variables(self) -> dict[str, frozenset[str]]:
        """The variables with a flag, by class."""
        return may_be_unwritten(self._network)

    @cached_property
    def _inputs(self) -> dict[str, frozenset[Place]]:
        return ports_of_unwritten(self._network)

    @cached_property
    def _outputs(self) -> dict[str, set[Place]]:
        """The outputs that write a variable with a flag in at least one instance, by class."""
        found: dict[str, set[Place]] = {entry.name: set() for entry in self._network.classes}
        if not any(self.variables.values()):
            return found
        outputs = {(c.name, port.name) for c in self._network.classes for port in c.ports if port.direction == "out"}
        for entry in reversed(self._network.classes):
            if isinstance(entry, ProcessClass):
                for instance in entry.instances:
                    for connection in instance.connections:
                        match connection.attachment:
                            case ChannelEnd(channel=channel):
                                flagged = channel in self.variables[entry.name]
                            case PortEnd(port=port, index=index):
                                flagged = (port, index) in found[entry.name]
                            case ConstantEnd() | DiscardEnd():
                                flagged = False
                            case _:
                                assert_never(connection.attachment)
                        if flagged and (instance.class_name, connection.port) in outputs:
                            found[instance.class_name].add((connection.port, connection.index))
        return found

    def has_port(self, class_: str, port: str, index: int | None) -> bool:
        """Whether a port of a class has a pointer to a flag; it is NULL if the variable always is written before."""
        return (port, index) in self._inputs[class_] or (port, index) in self._outputs[class_]
