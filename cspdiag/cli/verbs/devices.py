"""``cspdiag devices``: which devices drivers can name, and what is plugged in."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator

from cspdiag.cli.support.failure import FINE, UsageError
from cspdiag.cli.support.terminal import write_out
from cspdiag.devices.catalogue import DEVICES, Device, OfferedParameter

EXAMPLE = "cspdiag devices\ncspdiag devices gamepad"


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("device", nargs="?", metavar="DEVICE", help="describe this one, and show what is plugged in")


def run(arguments: Namespace) -> int:
    """Print the list, or one device."""
    if arguments.device is None:
        write_out("\n".join(_list()) + "\n")
        return FINE
    device = DEVICES.get(arguments.device)
    if device is None:
        raise UsageError(_unknown(arguments.device))
    write_out("\n".join(_described(device)) + "\n")
    return FINE


def _unknown(name: str) -> str:
    from cspdiag.base.spelling import Speller

    near = Speller().nearest(name, DEVICES)
    return f"there is no device {name!r} ({f'did you mean {near}?' if near else 'there are: ' + ', '.join(DEVICES)})"


def _list() -> Iterator[str]:
    width = max(len(device.summary) for device in DEVICES.values())
    for device in DEVICES.values():
        yield f"{device.name:<9} {device.summary:<{width}}  {_readiness(device)}"
    yield ""
    yield 'A driver names one: driver X device "udp" { ... }. cspdiag devices udp describes it.'


def _readiness(device: Device) -> str:
    """Whether it can be used, or what to install for it."""
    return "ready" if _is_ready(device) else f"pip install 'cspdiag[{device.extra}]'"


def _is_ready(device: Device) -> bool:
    from importlib.metadata import PackageNotFoundError, version

    for requirement in device.requirements:
        try:
            version(requirement.partition(">")[0])
        except PackageNotFoundError:
            return False
    return True


def _described(device: Device) -> Iterator[str]:
    yield f"{device.name}: {device.summary}"
    yield _readiness(device)
    yield ""
    yield "parameters:"
    suffix = device.address
    named = () if suffix is None else ((f"PORT_{suffix.name}", suffix),)
    yield from _table(
        [(_declared(name, p), p.doc) for name, p in ((*((p.name, p) for p in device.parameters), *named))]
    )
    yield ""
    if device.outputs is None:
        types = [name if name != "array" else "arrays of these" for name in device.values]
        yield f"ports: `out` and `in`, with the names that you choose, of the types {', '.join(types)}"
    else:
        yield "ports:"
        rows = [
            (f"out {port.name if not port.count else f'{port.names[0]} ... {port.names[-1]}'} : {port.type}", port.doc)
            for port in device.outputs
        ]
        yield from _table(rows)
    yield from _found(device)


def _declared(name: str, parameter: OfferedParameter) -> str:
    default = "" if not parameter.default else f" = {parameter.default}"
    return f"{name}: {parameter.type}{default}"


def _table(rows: list[tuple[str, str]]) -> Iterator[str]:
    width = max(len(left) for left, _ in rows)
    for left, right in rows:
        yield f"  {left:<{width}}  {right}"


def _found(device: Device) -> Iterator[str]:
    """What is plugged in, of a device of which that can be known."""
    from importlib import import_module

    from cspdiag.devices.failure import DeviceError

    find = getattr(import_module(f"cspdiag.devices.{device.module}"), "found", None)
    if find is None or not _is_ready(device):
        return
    try:
        there = find() or ["nothing"]
    except DeviceError as problem:
        there = [str(problem)]
    yield ""
    yield "plugged in:"
    yield from (f"  {line}" for line in there)
