"""What a recording says of its signals: names, types, units, periods; as it is stored in files, and read from them."""

from __future__ import annotations

import json
import zlib
from typing import Any, Literal, assert_never

from cspdiag.base.record import record
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
from cspdiag.model.units import parse_unit
from cspdiag.network.ir.network import CoreNetwork, Environment
from cspdiag.simulate.record.leaves import leaves


@record
class RecordedPort:
    """A port of the outermost process, or the parameters of the program as one signal. ``period`` and ``offset`` are in
    nanoseconds, 0 for the period of events.
    """

    name: str
    type: Type
    direction: Literal["in", "out", "parameter"]
    period: int = 0
    offset: int = 0

    @property
    def units(self) -> dict[str, str]:
        """The units of its numbers, by name, of those that have one."""
        return {
            name: str(kind.unit) for name, kind, _ in leaves(self.name, self.type) if isinstance(kind, RealType)
        } | {name: "ns" for name, kind, _ in leaves(self.name, self.type) if isinstance(kind, TimeType)}

    @property
    def is_sampled_input(self) -> bool:
        """Whether its samples are recorded, read or not."""
        return self.direction == "in" and self.period > 0


@record
class RecordingHead:
    """What a recording says at its beginning."""

    process: str
    environment: str
    source: str
    ports: tuple[RecordedPort, ...]


def head_of(network: CoreNetwork, environment: Environment | None) -> RecordingHead:
    """The head of the recording of a run."""
    ports = [
        RecordedPort(port.name, port.type, port.direction)
        if port.sampling is None
        else RecordedPort(port.name, port.type, port.direction, port.sampling.period, port.sampling.offset)
        for port in network.external_ports
    ]
    return RecordingHead(network.top, "" if environment is None else environment.name, network.source, tuple(ports))


def head_data(head: RecordingHead) -> dict[str, Any]:
    """The head as JSON has it, with a checksum: what formats add for the values does not cover it."""
    data = {
        "process": head.process,
        "environment": head.environment,
        "source": head.source,
        "ports": [
            {
                "name": port.name, "type": type_data(port.type), "direction": port.direction, "period": port.period,
                "offset": port.offset,
            }
            for port in head.ports
        ],
    }  # fmt: skip
    return data | {"checksum": _checksum(data)}


def _checksum(data: Any) -> int:
    return zlib.crc32(json.dumps(data).encode())


def head_from(data: Any) -> RecordingHead:
    """The head from what JSON has; raises ValueError, KeyError or TypeError for anything else. Recordings of earlier
    versions have no checksum.
    """
    own = dict(data)
    expected = own.pop("checksum", None)
    if expected is not None and expected != _checksum(own):
        raise ValueError("what it says of its signals does not fit its checksum")
    ports = (
        RecordedPort(entry["name"], type_from(entry["type"]), entry["direction"], entry["period"], entry["offset"])
        for entry in data["ports"]
    )
    return RecordingHead(data["process"], data["environment"], data["source"], tuple(ports))


def type_data(kind: Type) -> Any:
    """A type as JSON has it."""
    match kind:
        case BoolType() | TimeType():
            return str(kind)
        case IntType(bits=bits, signed=signed):
            return {"int": bits, "signed": signed}
        case RealType(bits=bits, unit=unit):
            return {"real": bits, "unit": str(unit)}
        case EnumType(name=name, literals=literals):
            return {"enum": name, "literals": list(literals)}
        case StructType(name=name, fields=fields):
            return {"struct": name, "fields": [[field, type_data(inner)] for field, inner in fields]}
        case ArrayType(element=element, size=size):
            return {"array": type_data(element), "size": size}
        case TextType() | UnknownType():
            raise ValueError(f"no port has the type {kind}")
        case _:
            assert_never(kind)


def type_from(data: Any) -> Type:
    """The type from what JSON has; raises ValueError, KeyError or TypeError for anything else."""
    if data == "bool":
        return BoolType()
    if data == "time":
        return TimeType()
    if "int" in data:
        return IntType(int(data["int"]), bool(data["signed"]))
    if "real" in data:
        unit = parse_unit(data["unit"])
        if unit is None:
            raise ValueError(f"unknown unit {data['unit']!r}")
        return RealType(int(data["real"])) if data["unit"] == "1" else RealType(int(data["real"]), unit)
    if "enum" in data:
        return EnumType(data["enum"], tuple(data["literals"]))
    if "struct" in data:
        return StructType(data["struct"], tuple((name, type_from(inner)) for name, inner in data["fields"]))
    return ArrayType(type_from(data["array"]), int(data["size"]))
