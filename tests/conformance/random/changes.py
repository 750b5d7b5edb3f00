"""Changes of the parameters of a program at random instants, the same on all targets."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from random import Random
from typing import Any
from zlib import crc32

from cspdiag.model.types import ArrayType, BoolType, EnumType, IntType, RealType, StructType, TimeType, Type
from cspdiag.network.ir.network import Network
from cspdiag.runtime.kernel.parameters import Change

PER_VALUE = 3
LATEST = 100_000_000
"""Nanoseconds: most random programs are over by then."""


_CHOSEN: ContextVar[str | None] = ContextVar("changes", default=None)


@contextmanager
def changes_in(text: str) -> Iterator[None]:
    """Within the block, changes are those of remarks in this text, such as ``// at 5 ns gain = 2.0``, if it has any."""
    token = _CHOSEN.set(text)
    try:
        yield
    finally:
        _CHOSEN.reset(token)


def changes_of(network: Network) -> list[Change]:
    """The chosen changes; without any, some of each number of each parameter, of which some come in the same
    instant.
    """
    lines = _LINE.findall(_CHOSEN.get() or "")
    if lines:
        return [_change(network, int(time), place, value) for time, place, value in lines]
    chosen = Random(crc32(f"{network.name} {len(network.instances)}".encode()))
    found = []
    for parameter in network.parameters:
        if parameter.follows is None:
            for path, kind, value in _numbers(parameter.type, parameter.value):
                for _ in range(PER_VALUE):
                    time = chosen.choice([0, 20_000_000, chosen.randrange(LATEST), chosen.randrange(10 * LATEST)])
                    found.append(Change(time, parameter.name, path, _another(chosen, kind, value)))
    return found


_LINE = re.compile(r"^// at (\d+) ns (\S+) = (.+)$", re.MULTILINE)


def _change(network: Network, time: int, place: str, value: str) -> Change:
    name, *steps = re.findall(r"\w+", place)
    kind = next(parameter.type for parameter in network.parameters if parameter.name == name)
    path = []
    for step in steps:
        match kind:
            case StructType(fields=fields):
                position = [field for field, _ in fields].index(step)
                kind = fields[position][1]
            case ArrayType(element=element):
                position, kind = int(step), element
            case _:
                raise AssertionError(place)
        path.append(position)
    return Change(time, name, tuple(path), _read(kind, value))


def _read(kind: Type, value: str) -> Any:
    match kind:
        case BoolType():
            return value == "true"
        case EnumType(literals=literals):
            return list(literals).index(value)
        case TimeType():
            return int(value.removesuffix(" ns"))
        case RealType():
            return float(value)
        case _:
            return int(value)


def _numbers(kind: Type, value: Any, path: tuple[int, ...] = ()) -> Iterator[tuple[tuple[int, ...], Type, Any]]:
    match kind:
        case StructType(fields=fields):
            for position, (_, inner) in enumerate(fields):
                yield from _numbers(inner, value[position], (*path, position))
        case ArrayType(element=element):
            for position, part in enumerate(value):
                yield from _numbers(element, part, (*path, position))
        case _:
            yield path, kind, value


def _another(chosen: Random, kind: Type, value: Any) -> Any:
    match kind:
        case BoolType():
            return not value
        case IntType():
            return min(max(value + chosen.randint(-3, 3), kind.minimum), kind.maximum)
        case TimeType():
            return max(value * chosen.randint(50, 200) // 100, 0)
        case EnumType(literals=literals):
            return chosen.randrange(len(literals))
        case RealType():
            return value * chosen.choice([0.5, 0.75, 1.25, 2.0]) + chosen.choice([0.0, 0.125])
        case _:
            raise AssertionError(kind)


INSTANTS = (0, 1_000_000, 2_000_000, 5_000_000, 5_700_000, 12_000_000, 20_000_000, 20_700_000, 33_000_000)
"""Nanoseconds, most of them instants of samples."""
VALUES: Mapping[str, Sequence[str]] = {
    "double": ("0.0", "-0.0", "1.0", "-1.5", "2.75", "0.125", "1e-300", "1e300", "-1e155", "inf", "nan", "-inf"),
    "float": ("0.0", "0.5", "-2.5", "8.0", "inf"),
    "int": ("0", "1", "-1", "4", "7", "-3", "9223372036854775807", "-9223372036854775808"),
    "int8": ("0", "1", "-5", "50", "127", "-128"),
    "uint16": ("0", "2", "1000", "65535"),
    "bool": ("true", "false"),
    "time": (
        "0 ns",
        "1 ns",
        "1000000 ns",
        "2000000 ns",
        "300000 ns",
        "4500000 ns",
        "-1000000 ns",
        "9223372036854775807 ns",
    ),
    "Mode": ("slow", "fast", "off"),
}
"""What a parameter may be changed to: some of it is refused, or makes what follows impossible to compute."""


def drawn(draw: Random, places: Sequence[tuple[str, str]], last: int = 60_000_000) -> list[str]:
    """Some changes of parts of parameters, by name and type, up to about the ``last`` nanosecond, as lines for
    ``--tune``; several at one instant.
    """
    time, lines = 0, []
    instants = [instant for instant in INSTANTS if instant <= last]
    for _ in range(draw.randint(3, 14)):
        if draw.random() < 0.7:
            time = draw.choice([*instants, *instants, draw.randrange(last)]) + draw.choice([0, 0, 0, 0, -1, 1])
        place, kind = draw.choice(places)
        lines.append(f"at {max(time, 0)} ns {place} = {draw.choice(VALUES[kind])}")
    return lines
