"""Checks that drivers of devices declare what their device offers."""

from __future__ import annotations

from typing import assert_never

from cspdiag.base import Report, Span
from cspdiag.base.spelling import Speller
from cspdiag.devices.catalogue import (
    DEVICES,
    Device,
    OfferedPort,
    TypeName,
    parameter,
    parameter_names,
    port_names,
)
from cspdiag.model.program import PortSymbol, Program, Scope
from cspdiag.model.types import (
    ArrayType,
    BoolType,
    EnumType,
    IntType,
    RealType,
    StructType,
    TextType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.network.diagnostics.devices import (
    DeviceParameterDiffers,
    DevicePortDiffers,
    MissingDeviceParameter,
    UnknownDevice,
    UnknownDeviceParameter,
    UnknownDevicePort,
)
from cspdiag.syntax import ast


def check_device(program: Program, driver: ast.DriverDefinition, external: ast.External, report: Report) -> None:
    """Reports what a driver declares and its device does not offer, and an unknown device."""
    device = DEVICES.get(external.target)
    if device is None:
        span = external.target_span
        inside = Span(span.source, span.start + 1, span.end - 1)
        suggestion = Speller().nearest(external.target, DEVICES)
        report.add(UnknownDevice(span, external.target, tuple(DEVICES), suggestion, inside))
        return
    ports = program.scopes.get(driver, Scope()).ports
    for symbol in ports.values():
        _check_port(device, symbol, report)
    _check_parameters(program, driver, device, tuple(ports), report)


def _check_port(device: Device, symbol: PortSymbol, report: Report) -> None:
    span, name = symbol.port.span, symbol.name
    offered = device.output(name)
    if device.outputs is None:
        _check_value(device, symbol, report)
    elif offered is None:
        suggestion = Speller().nearest(name, port_names(device))
        if suggestion and suggestion.rstrip("0123456789") == name.rstrip("0123456789"):
            suggestion = None  # It has fewer of them.
        report.add(UnknownDevicePort(span, device.name, name, _shown(device.outputs), suggestion))
    elif symbol.declaration.direction != "out" or not _is(symbol.type, offered.type, exact=True):
        declared = f"{symbol.declaration.direction} {name} : {symbol.type}"
        right = f"out {name} : {offered.type}"
        report.add(DevicePortDiffers(span, device.name, name, declared, f"`{right}`", f"write `{right}`"))


def _check_value(device: Device, symbol: PortSymbol, report: Report) -> None:
    type_ = symbol.type
    element = type_.element if isinstance(type_, ArrayType) and "array" in device.values else type_
    if not any(name != "array" and _is(element, name) for name in device.values):
        taken = [name if name != "array" else "arrays of these" for name in device.values]
        listed = f"{', '.join(taken[:-1])} and {taken[-1]}" if len(taken) > 1 else taken[0]
        declared = f"{symbol.declaration.direction} {symbol.name} : {type_}"
        advice = (
            "use a port for each value" if len(device.values) > 1 else f"write `{symbol.name} : {device.values[0]}`"
        )
        report.add(
            DevicePortDiffers(symbol.port.span, device.name, symbol.name, declared, f"only {listed} values", advice)
        )


def _shown(ports: tuple[OfferedPort, ...]) -> tuple[str, ...]:
    return tuple(f"`{port.name}`" if not port.count else f"`{port.names[0]}` to `{port.names[-1]}`" for port in ports)


def _check_parameters(
    program: Program, driver: ast.DriverDefinition, device: Device, ports: tuple[str, ...], report: Report
) -> None:
    names = parameter_names(device, ports)
    for declared in driver.parameters:
        name = declared.name.text
        offered = parameter(device, name, ports)
        type_ = program.types.get(declared)
        if offered is None:
            suggestion = Speller().nearest(name, names)
            report.add(UnknownDeviceParameter(declared.name.span, device.name, name, names, suggestion))
        elif type_ is not None and not _is(type_, offered.type, exact=True):
            report.add(DeviceParameterDiffers(declared.name.span, device.name, name, str(type_), offered.type))
    given = {declared.name.text for declared in driver.parameters}
    for name in names:
        needed = parameter(device, name, ports)
        if needed is not None and needed.default is None and name not in given:
            report.add(
                MissingDeviceParameter(driver.name.span, driver.name.text, device.name, name, needed.type, needed.doc)
            )


def _is(type_: Type, name: TypeName, *, exact: bool = False) -> bool:
    """Whether values of a type can be values of a device; ``exact``: and are no quantities with a unit, nor of another
    size.
    """
    match type_:
        case BoolType():
            return name == "bool"
        case IntType() | EnumType():
            return name == "int" and (not exact or isinstance(type_, IntType))
        case RealType(unit=unit):
            return name == "double" and not (exact and unit.text)
        case TextType():
            return name == "text"
        case TimeType():
            return name == "time"
        case UnknownType():
            return True
        case StructType() | ArrayType():
            return False
        case _:
            assert_never(type_)
