"""What can be wrong with a driver that names a device."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Edit, Span
from cspdiag.base.edits import slip
from cspdiag.base.record import record


@record
class UnknownDevice(Diagnostic):
    code = "E0830"
    title = "an unknown device"

    device: str
    devices: tuple[str, ...]
    suggestion: str | None
    name_span: Span
    """Of the name without its quotes."""

    @property
    def message(self) -> str:
        return f'there is no device "{self.device}"'

    @property
    def help(self) -> str:
        if self.suggestion:
            return f'did you mean "{self.suggestion}"?'
        return f'there are {", ".join(self.devices)}; another one is a class in Python: `python "module.py:Class"`'

    @property
    def edits(self) -> tuple[Edit, ...]:
        return slip(self.name_span, self.device, self.suggestion)


@record
class UnknownDevicePort(Diagnostic):
    code = "E0831"
    title = "a port that the device does not have"

    device: str
    port: str
    ports: tuple[str, ...]
    """As the device describes them, those that are counted as one: `axis0` ... `axis7`."""
    suggestion: str | None

    @property
    def message(self) -> str:
        return f'the device "{self.device}" has no port `{self.port}`'

    @property
    def help(self) -> str:
        if self.suggestion:
            return f"did you mean `{self.suggestion}`?"
        return f"it has {', '.join(self.ports)}"

    @property
    def edits(self) -> tuple[Edit, ...]:
        return slip(self.span, self.port, self.suggestion)


@record
class DevicePortDiffers(Diagnostic):
    code = "E0832"
    title = "a port that is different at the device"

    device: str
    port: str
    declared: str
    offered: str
    advice: str
    """How to write it, or what to write instead."""

    @property
    def message(self) -> str:
        return f'`{self.port}` is `{self.declared}`, but the device "{self.device}" has {self.offered}'

    @property
    def help(self) -> str:
        return self.advice


@record
class UnknownDeviceParameter(Diagnostic):
    code = "E0833"
    title = "a parameter that the device does not have"

    device: str
    parameter: str
    parameters: tuple[str, ...]
    suggestion: str | None

    @property
    def message(self) -> str:
        return f'the device "{self.device}" has no parameter `{self.parameter}`'

    @property
    def help(self) -> str:
        if self.suggestion:
            return f"did you mean `{self.suggestion}`?"
        return "it has " + ", ".join(f"`{name}`" for name in self.parameters)


@record
class DeviceParameterDiffers(Diagnostic):
    code = "E0834"
    title = "a parameter that is different at the device"

    device: str
    parameter: str
    declared: str
    offered: str

    @property
    def message(self) -> str:
        return f'`{self.parameter}` is of type `{self.declared}`, but the device "{self.device}" takes `{self.offered}`'

    @property
    def help(self) -> str:
        return f"write `{self.parameter}: {self.offered}`"


@record
class MissingDeviceParameter(Diagnostic):
    code = "E0835"
    title = "a device without a parameter that it needs"

    driver: str
    device: str
    parameter: str
    type: str
    doc: str

    @property
    def message(self) -> str:
        return f'the device "{self.device}" needs the parameter `{self.parameter}`: {self.doc}'

    @property
    def help(self) -> str:
        return f"declare it: `driver {self.driver}({self.parameter}: {self.type})`"
