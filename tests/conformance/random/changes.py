"""Changes of the parameters of a program at random instants, the same on all targets."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any
from zlib import crc32

from cspdiag.model.types import ArrayType, BoolType, EnumType, IntType, RealType, StructType, TimeType, Type
from cspdiag.network.ir.network import Network
from cspdiag.runtime.kernel.parameters import Change

PER_VALUE = 3
LATEST = 100_000_000
"""Nanoseconds: most random programs are over by then."""


def changes_of(network: Network) -> list[Change]:
    """Some changes of each number of each parameter, of which some come in the same instant."""
    chosen = Random(crc32(f"{network.name} {len(network.instances)}".encode()))
    found = []
    for parameter in network.parameters:
        if parameter.follows is None:
            for path, kind, value in _numbers(parameter.type, parameter.value):
                for _ in range(PER_VALUE):
                    time = chosen.choice([0, 20_000_000, chosen.randrange(LATEST), chosen.randrange(10 * LATEST)])
                    found.append(Change(time, parameter.name, path, _another(chosen, kind, value)))
    return found


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
