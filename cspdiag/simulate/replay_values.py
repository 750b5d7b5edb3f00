"""Values that an environment may offer in a replay."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from enum import Enum
from itertools import islice, product
from types import ModuleType
from typing import Any

from cspdiag.diagnostics import Span
from cspdiag.diagnostics.record import field_names, is_record
from cspdiag.model.types import ArrayType, BoolType, EnumType, IntType, RealType, StructType, TimeType, Type
from cspdiag.network.expressions import LiteralValue
from cspdiag.network.ir import Network, ProcessClass

_REALS = (0.0, 1.0, -1.0, 1000.0, -1000.0, 0.001)
_MOST = 64


class Values:
    """Values of the types of a program, as its package has them; ``numbers`` are those that its text compares with."""

    def __init__(self, types: ModuleType | None, numbers: Iterable[int]) -> None:
        self._types = types
        self._integers = tuple(dict.fromkeys((0, 1, *numbers)))

    def candidates(self, type_: Type, told: str | None) -> Sequence[Any]:
        """What may be offered at a port, the simplest first: the value that the trace tells, or a choice of all that there are."""
        found = list(islice(self._all(type_), _MOST))
        if told is None:
            return found
        return [value for value in found if written(value, type_) == told] or self._read(type_, told)

    def _read(self, type_: Type, told: str) -> list[Any]:
        try:
            match type_:
                case IntType():
                    return [int(told)]
                case RealType():
                    return [float(told)]
        except ValueError:
            pass
        return []

    def _all(self, type_: Type) -> Iterable[Any]:
        match type_:
            case BoolType():
                return (False, True)
            case IntType(minimum=minimum, maximum=maximum):
                return [value for value in self._integers if minimum <= value <= maximum]
            case TimeType():
                return (0, 1_000_000)
            case RealType():
                return _REALS
            case EnumType(name=name):
                return list(getattr(self._types, name))
            case StructType(name=name, fields=fields):
                struct = getattr(self._types, name)
                return (struct(*parts) for parts in product(*(self._all(field) for _, field in fields)))
            case ArrayType(element=element, size=size):
                return ((value,) * (size or 0) for value in self._all(element))
            case _:
                return ()


def written(value: Any, type_: Type) -> str:
    """A value as transition systems write it."""
    match type_:
        case BoolType():
            return "true" if value else "false"
        case EnumType(name=name, literals=literals):
            return f"{name}.{literals[int(value)]}"
        case _:
            return str(value)


def told(value: Any) -> str:
    """A value of a running program, as its text would have it."""
    match value:
        case bool():
            return "true" if value else "false"
        case Enum():
            return f"{type(value).__name__}.{value.name}"
        case tuple():
            return f"[{', '.join(map(told, value))}]"
        case _:
            return str(value)


def numbers_of(network: Network) -> Iterable[int]:
    """Whole numbers that a program mentions, and their neighbours: conditions turn on them."""
    found: dict[int, None] = {}
    for constant in network.constants:
        _collect(constant.value, found)
    for instance in network.instances:
        for _, value in instance.arguments:
            _collect(value, found)
    for entry in network.classes:
        if isinstance(entry, ProcessClass):
            _literals(entry.body, found)
    return [near for number in found for near in (number, number + 1, number - 1)]


def _collect(value: object, found: dict[int, None]) -> None:
    if isinstance(value, tuple):
        for part in value:
            _collect(part, found)
    elif type(value) is int and abs(value) < 1 << 31:
        found[value] = None


def _literals(item: object, found: dict[int, None]) -> None:
    pending = [item]
    while pending:
        part = pending.pop()
        if isinstance(part, tuple):
            pending += part
        elif isinstance(part, LiteralValue):
            _collect(part.value, found)
        elif is_record(part) and not isinstance(part, Span):
            pending += [getattr(part, name) for name in field_names(part)]
