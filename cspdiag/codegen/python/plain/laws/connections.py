"""What the ports of a program are connected to in an environment: its devices, and signals of its system."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

from cspdiag.base.record import record
from cspdiag.codegen.python.plain.external import ExternalModules
from cspdiag.codegen.python.text.code import Code, Constant, Entry, Items, call, own, tuple_of, typed
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.literals import quoted
from cspdiag.codegen.python.text.names import Names
from cspdiag.codegen.python.text.statements import Assign, Statement, assign
from cspdiag.codegen.python.text.types import annotation, literal
from cspdiag.devices.catalogue import DEVICES
from cspdiag.model.types import BOOL, DOUBLE, INT, TEXT, Type
from cspdiag.network.ir.network import DriverInstance, Environment, Network
from cspdiag.network.ir.zero import zero


@record
class Connections:
    """Writes the statements of the constructor of an environment that connect it."""

    environment: Environment
    network: Network
    names: Names
    modules: ExternalModules
    imports: Imports

    def devices(self) -> Iterable[Statement]:
        """Creates the devices."""
        for device in self.environment.drivers:
            given = dict(self._ports_of(device))
            given |= {name: literal(value, _type_of(value), self.imports) for name, value in device.arguments}
            made = self.modules.construct(device.external, given, self.imports)
            yield assign(own(self.names[device.name]), made)

    def signals(self) -> Iterable[Statement]:
        """Creates the signals, for the ports that no device has."""
        signal = self.imports.runtime("Signal")
        for port in self.network.external_ports:
            if port.key not in self._ports_of_devices:
                initial = literal(zero(port.type), port.type, self.imports)
                made = typed(signal, annotation(port.type, self.imports)).called(initial)
                yield assign(own(self.names[port.key]), made)

    def drivers(self) -> Statement:
        """The driver of each port of the program."""
        entries = tuple(Entry(quoted(port.key), self._driver(port.key)) for port in self.network.external_ports)
        mapping, driver = self.imports.standard("collections.abc", "Mapping"), self.imports.runtime("Driver")
        return Assign(own("drivers"), Items("{}", entries), annotation=f"{mapping}[str, {driver}]")

    def _driver(self, port: str) -> Code:
        if port not in self._ports_of_devices:
            return own(self.names[port])
        device, device_port = self._ports_of_devices[port]
        return call(self.imports.runtime("DevicePort"), own(self.names[device.name]), Constant(quoted(device_port)))

    @cached_property
    def _ports_of_devices(self) -> dict[str, tuple[DriverInstance, str]]:
        """The device of each port of the program that has one, and the port of the device."""
        return {
            external: (device, port) for device in self.environment.drivers for port, external in device.connections
        }

    def _ports_of(self, driver: DriverInstance) -> Iterable[tuple[str, Code]]:
        """The arguments with the ports of a device that has those which its driver declares, and what they are for."""
        if driver.external.language != "device" or DEVICES[driver.external.target].outputs is not None:
            return
        sampled = {port.key: port.sampling is not None for port in self.network.external_ports}
        uses = {own: "sampled" if sampled[key] else "event" for own, key in driver.connections if key in sampled}
        entries = (Entry(quoted(name), Constant(quoted(uses.get(name, "unused")))) for name in driver.outputs)
        yield "outputs", Items("{}", tuple(entries))
        yield "inputs", tuple_of(Constant(quoted(name)) for name in driver.inputs)


def _type_of(value: object) -> Type:
    match value:
        case bool():
            return BOOL
        case int():
            return INT
        case float():
            return DOUBLE
        case _:  # Settings have these types; the rest are texts.
            return TEXT
