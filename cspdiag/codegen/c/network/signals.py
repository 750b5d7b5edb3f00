"""The signals of an environment in C behind the ports of the program: what reads and writes them."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

from cspdiag.base.record import record
from cspdiag.codegen.c.network.devices import Devices
from cspdiag.codegen.c.network.external_ports import port_groups
from cspdiag.codegen.c.text.code import EQUALITY, Aggregate, Code, address, call, code, infix, negated, own
from cspdiag.codegen.c.text.names import Names
from cspdiag.codegen.c.text.statements import Function, Remark, Statement, define, return_value, store
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.model.types import ArrayType, StructType, Type
from cspdiag.network.ir.network import ExternalPort, Network


@record
class Signals:
    """Writes the members with the values of the ports, and the functions that hand them over."""

    environment: str
    """Its name in C."""
    network: Network
    types: CTypes
    members: Names
    devices: Devices

    @cached_property
    def ports(self) -> list[ExternalPort]:
        """The ports with signals behind them."""
        return [port for port in self.network.external_ports if port.key not in self.devices.connected]

    def fields(self) -> Iterable[Statement]:
        """The members of the struct of the environment."""
        for port in self.ports:
            name, type_name = self.members[port.key], self.types.type_name(port.type)
            if port.medium == "event":
                yield define(type_name, f"{name}[2]", remark="present and last")
            else:
                yield define(type_name, name)

    def starting(self) -> Iterable[Statement]:
        """No event happens when the environment starts."""
        for port in self.ports:
            if port.medium == "event":
                member = own(self.members[port.key])
                yield store(member.at(1), member.at(0))

    def transfers(self) -> list[Statement]:
        """Functions that read and write signals, one for each type."""
        statements: list[Statement] = []
        done: set[str] = set()
        for port in self.ports:
            name, type_name = self._transfer(port), self.types.type_name(port.type)
            if name in done:
                continue
            done.add(name)
            if port.direction == "out":
                copied = store(f"*({type_name} *)device", f"*(const {type_name} *)value")
                statements.append(Function(f"static void {name}", ("void *device", "const void *value"), (copied,)))
            elif port.medium != "event":
                copied = store(f"*({type_name} *)value", f"*(const {type_name} *)device")
                statements.append(
                    Function(f"static bool {name}", ("void *device", "void *value"), (copied, return_value("true")))
                )
            else:
                statements.append(self._event_reader(name, type_name, port.type))
        return statements

    def _event_reader(self, name: str, type_name: str, type_: Type) -> Function:
        """The function that reads an event port, and returns whether its value has changed since the last call."""
        present, last = code("signal").at(0), code("signal").at(1)
        changed: Code = infix("!=", EQUALITY, present, last)
        if isinstance(type_, StructType | ArrayType):
            changed = negated(call(f"{self.types.suffix(type_)}_equal", present, last))
        body = (
            Remark("The present and the last value: an event is a change."),
            define(f"{type_name} *const", "signal", "device"),
            define("const bool", "changed", changed),
            store(last, present),
            store(f"*({type_name} *)value", present),
            return_value("changed"),
        )
        return Function(f"static bool {name}", ("void *device", "void *value"), body)

    def _transfer(self, port: ExternalPort) -> str:
        verb = "write" if port.direction == "out" else "poll" if port.medium == "event" else "read"
        return f"{verb}_{self.types.suffix(port.type)}"

    def drivers(self) -> Statement:
        """The table of what is behind each port of the program."""
        members: list[tuple[str | None, Code]] = []
        for name, ports in port_groups(self.network.external_ports):
            entries = [self._driver(port) for port in ports]
            value = entries[0] if ports[0].index is None else Aggregate(tuple((None, entry) for entry in entries))
            members.append((f".{self.types.field(name)}", value))
        drivers = Aggregate(tuple(members) or ((None, code("0")),))
        return define("const struct network_drivers", f"{self.environment}_drivers", drivers)

    def _driver(self, port: ExternalPort) -> Aggregate:
        if port.key in self.devices.connected:
            return self.devices.driver(port)
        member, function = code("present").field(self.members[port.key]), code(self._transfer(port))
        device, nothing = member if port.medium == "event" else address(member), code("NULL")
        parts = (device, nothing, function) if port.direction == "out" else (device, function, nothing)
        return Aggregate(tuple((None, part) for part in parts))
