"""Devices in C: drivers that are written by hand, behind ports of the program, in an environment.

A driver ``Adc`` has a struct ``adc`` with a member for each of its ports, and functions: ``adc_open`` and
``adc_close``, for each output ``adc_read_PORT``, which stores a value in the member and returns whether there was one,
and for each input ``adc_write_PORT``, which finds the value there. Functions of arrays of ports are passed the index.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

from cspdiag.base.record import record
from cspdiag.codegen.c.laws.by_hand import required_function, required_member, type_of_argument
from cspdiag.codegen.c.laws.external import header_of
from cspdiag.codegen.c.text.code import (
    RELATION,
    Aggregate,
    Code,
    address,
    assign,
    call,
    code,
    infix,
    negated,
    own,
    unsigned,
)
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.names import Names, PackageNames, snake_case
from cspdiag.codegen.c.text.statements import Function, If, Statement, define, return_value, run, store
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.model.types import TextType
from cspdiag.network.ir.network import DriverInstance, Environment, ExternalPort, Network

OPENED = "opened"
"""The member of the environment that counts the devices that are open."""


@record
class _Connected:
    """A port of a driver with the port of the program that it is connected to."""

    driver: DriverInstance
    port: str
    external: ExternalPort

    @property
    def structure(self) -> str:
        return snake_case(self.driver.definition)

    @property
    def name(self) -> str:
        """The name of the port, without its index."""
        return self.port.partition("[")[0]

    @property
    def index(self) -> int | None:
        return int(self.port.partition("[")[2].removesuffix("]")) if "[" in self.port else None

    @property
    def size(self) -> int | None:
        """The number of ports in the array."""
        ports = (*self.driver.inputs, *self.driver.outputs)
        return None if self.index is None else sum(port.startswith(f"{self.name}[") for port in ports)

    @property
    def function(self) -> str:
        """The function of this file that calls that of the driver."""
        verb = "write" if self.external.direction == "out" else "read"
        suffix = "" if self.index is None else f"_{self.index}"
        return f"{verb}_{self.structure}_{self.name}{suffix}"


@record
class Devices:
    """What concerns the devices of one environment, whose ``members`` have names for them."""

    environment: Environment
    network: Network
    names: PackageNames
    types: CTypes
    members: Names

    @cached_property
    def connected(self) -> Mapping[str, _Connected]:
        """The ports of devices, by the keys of the ports of the program."""
        ports = {port.key: port for port in self.network.external_ports}
        return {
            key: _Connected(driver, port, ports[key])
            for driver in self.environment.drivers
            for port, key in driver.connections
            if key in ports
        }

    def headers(self) -> Iterator[str]:
        """The lines that include the headers of the drivers."""
        for header in dict.fromkeys(header_of(driver.external) for driver in self.environment.drivers):
            yield f'#include "{header}"'

    def fields(self) -> Iterator[Statement]:
        """The members of the environment."""
        for driver in self.environment.drivers:
            yield define(f"struct {snake_case(driver.definition)}", self.members[driver.name])
        if self.environment.drivers:
            yield define("uint32_t", OPENED, remark="devices that are open, in this order")

    # ---- Opening and closing

    def opening(self) -> Iterator[Statement]:
        """The statements that open them; the first that cannot be opened ends the run before it begins."""
        if self.environment.drivers:
            yield store(own(OPENED), unsigned(0))
        for number, driver in enumerate(self.environment.drivers):
            place = self.names.place(driver.span.file, driver.span.line)
            opened = call(f"{snake_case(driver.definition)}_open", address(self._device(driver)), *self._given(driver))
            refused = call("csp_device_refused", quoted(driver.name), quoted(place))
            yield If(negated(opened), (return_value(refused),))
            yield store(own(OPENED), unsigned(number + 1))

    def _device(self, driver: DriverInstance) -> Code:
        return own(self.members[driver.name])

    def _given(self, driver: DriverInstance) -> Iterator[Code]:
        for (_, value), type_ in zip(driver.arguments, driver.argument_types, strict=True):
            yield code(quoted(str(value))) if isinstance(type_, TextType) else self.types.literal(value, type_)

    def closing(self, name: str, environment: str) -> Iterator[Statement]:
        """The function that closes those that are open, the last first."""
        if self.environment.drivers:
            body: list[Statement] = [define(f"struct {environment} *const", "self", "state")]
            for number, driver in reversed(list(enumerate(self.environment.drivers))):
                closed = run(call(f"{snake_case(driver.definition)}_close", address(self._device(driver))))
                body.append(If(infix(">", RELATION, own(OPENED), unsigned(number)), (closed,)))
            yield Function(f"static void {name}", ("void *state",), (*body, store(own(OPENED), unsigned(0))))

    # ---- Reading and writing

    def transfers(self) -> Iterator[Statement]:
        """The functions behind the ports: one for each port of a class of drivers."""
        yield from {item.function: self._transfer(item) for item in self.connected.values()}.values()

    def _transfer(self, item: _Connected) -> Function:
        type_name = self.types.type_name(item.external.type)
        arguments = [code("self"), *([] if item.index is None else [unsigned(item.index)])]
        place = own(self.types.field(item.name))
        member = place if item.index is None else place.at(item.index)
        device = define(f"struct {item.structure} *const", "self", "device")
        if item.external.direction == "out":
            called = run(call(f"{item.structure}_write_{item.name}", *arguments))
            body: tuple[Statement, ...] = (device, store(member, f"*(const {type_name} *)value"), called)
            return Function(f"static void {item.function}", ("void *device", "const void *value"), body)
        came = define("const bool", "came", call(f"{item.structure}_read_{item.name}", *arguments))
        stored = If(code("came"), (run(assign(f"*({type_name} *)value", member)),))
        body = (device, came, stored, return_value("came"))
        return Function(f"static bool {item.function}", ("void *device", "void *value"), body)

    def driver(self, port: ExternalPort) -> Aggregate:
        """The entry of a port of the program in the table of drivers."""
        item = self.connected[port.key]
        device, nothing, function = code("present").field(self.members[item.driver.name]), code("NULL"), item.function
        first, second = (nothing, code(function)) if port.direction == "out" else (code(function), nothing)
        return Aggregate(((None, address(device)), (None, first), (None, second)))

    # ---- Checks

    def checks(self) -> list[str]:
        """The lines that do not compile if a member or a function has another type than the program says."""
        required = [check for driver in self.environment.drivers for check in self._checks_of_device(driver)]
        required += [check for item in self.connected.values() for check in self._checks_of_port(item)]
        return [row for check in dict.fromkeys(map(tuple, required)) for row in check]

    def _checks_of_device(self, driver: DriverInstance) -> Iterator[list[str]]:
        header, place, structure = self._by_hand(driver)
        itself = f"struct {structure} *"
        given = [type_of_argument(type_, self.types) for type_ in driver.argument_types]
        yield required_function(header, "bool", f"{structure}_open", (itself, *given), place)
        yield required_function(header, "void", f"{structure}_close", (itself,), place)

    def _checks_of_port(self, item: _Connected) -> Iterator[list[str]]:
        header, place, structure = self._by_hand(item.driver)
        member, expected = self.types.field(item.name), self.types.type_name(item.external.type)
        yield required_member(header, structure, member, expected, place, item.size)
        result, verb = ("void", "write") if item.external.direction == "out" else ("bool", "read")
        parameters = (f"struct {structure} *", *(() if item.size is None else ("uint32_t",)))
        yield required_function(header, result, f"{structure}_{verb}_{item.name}", parameters, place)

    def _by_hand(self, driver: DriverInstance) -> tuple[str, str, str]:
        """The header of a driver, the place of its definition, and the name of its struct."""
        span = driver.external.span
        return header_of(driver.external), self.names.place(span.file, span.line), snake_case(driver.definition)
