"""Values that an environment may offer in a replay."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice, pairwise, product
from types import ModuleType
from typing import Any, assert_never

from cspdiag.base import Span
from cspdiag.base.record import field_names, is_record
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
from cspdiag.network.dump.expression import value_text
from cspdiag.network.ir.expressions import BinaryOperation, LiteralValue
from cspdiag.network.ir.network import CoreNetwork, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.proofs.transitions.classes.cuts import COMPARISONS, Arguments
from cspdiag.proofs.transitions.ranges import limits_of
from cspdiag.proofs.transitions.values import COPIES
from cspdiag.settings import parse_duration

_REALS = (0.0, 1.0, -1.0)
_OTHER_REALS = (1000.0, -1000.0, 0.001)
_MOST = 64
HANDED_ON = {str(one): part for one, part in zip(COPIES, (slice(1), slice(1, None)), strict=True)}
"""Values that proofs only follow as they are handed on: one of them, and any other."""


class Values:
    """Values of the types of a program, as its package has them; ``numbers`` are those on which the run may
    depend, ``at_faults`` those at which operations may fault.
    """

    def __init__(
        self, types: ModuleType | None, numbers: Iterable[int | float], at_faults: Sequence[int | float] = ()
    ) -> None:
        self._types = types
        given = tuple(numbers)
        self._integers = tuple(dict.fromkeys((0, 1, *(number for number in given if isinstance(number, int)))))
        reals = (number for number in given if isinstance(number, float))
        self._reals = tuple(dict.fromkeys((*_REALS, *reals, *_OTHER_REALS)))
        self._numbers_at_faults = at_faults

    def candidates(self, type_: Type, text: str | None) -> Sequence[Any]:
        """What may be offered at a port, the simplest first: the value of the trace, or a selection of all values.

        Last come those at which operations may fault, whatever range the trace has: proofs do not know in which they
        do.
        """
        found = list(islice(self._all(type_), _MOST))
        if text is None or text in HANDED_ON:
            found = self._and_at_faults(found, type_)
            return found if text is None else found[HANDED_ON[text]]
        try:
            fitting = [value for value in found if is_written_as(value, type_, text)] or self._read(type_, text)
        except ValueError:
            return []
        return self._and_at_faults(fitting, type_)

    def _and_at_faults(self, found: list[Any], type_: Type) -> list[Any]:
        every = list(found)
        for value in self._at_faults(type_):
            if value not in every:
                every.append(value)
        return every

    def _at_faults(self, type_: Type) -> Iterator[Any]:
        if not self._numbers_at_faults:
            return
        match type_:
            case IntType(minimum=minimum, maximum=maximum):
                whole = (number for number in self._numbers_at_faults if isinstance(number, int))
                yield from (number for number in whole if minimum <= number <= maximum)
                yield from (maximum, minimum)
            case TimeType():
                yield from reversed(limits_of(type_) or ())
            case RealType():
                yield from (number for number in self._numbers_at_faults if isinstance(number, float))
            case StructType(name=name, fields=fields):
                simplest = [next(iter(self._all(field)), None) for _, field in fields]
                for at, (_, field) in enumerate(fields):
                    for value in self._at_faults(field):
                        yield getattr(self._types, name)(*simplest[:at], value, *simplest[at + 1 :])
            case ArrayType(element=element, size=size):
                yield from ((value,) * (size or 0) for value in self._at_faults(element))
            case BoolType() | EnumType() | TextType() | UnknownType():
                return
            case _:
                assert_never(type_)

    def _read(self, type_: Type, text: str) -> list[Any]:
        ends = _ends(type_, text)
        if ends is not None:
            return [min(ends, key=abs)]
        match type_:
            case IntType() | TimeType():
                return [_number(type_, text)]
            case RealType():
                return [float(text)]
            case BoolType() | TextType() | EnumType() | StructType() | ArrayType() | UnknownType():
                return []
            case _:
                assert_never(type_)

    def _all(self, type_: Type) -> Iterable[Any]:
        match type_:
            case BoolType():
                return (False, True)
            case IntType(minimum=minimum, maximum=maximum):
                return [value for value in self._integers if minimum <= value <= maximum]
            case TimeType():
                return (0, 1_000_000)
            case RealType():
                return self._reals
            case EnumType(name=name):
                return list(getattr(self._types, name))
            case StructType(name=name, fields=fields):
                struct = getattr(self._types, name)
                return (struct(*parts) for parts in product(*(self._all(field) for _, field in fields)))
            case ArrayType(element=element, size=size):
                return ((value,) * (size or 0) for value in self._all(element))
            case TextType() | UnknownType():
                return ()
            case _:
                assert_never(type_)


def types_of(network: CoreNetwork) -> Mapping[str, Type]:
    """The types of the channels and external ports of a program, by hierarchical name."""
    types = {net.path: net.type for net in network.nets}
    return types | {f"{network.top}.{port.name}": port.type for port in network.external_ports}


def is_written_as(value: Any, type_: Type, text: str) -> bool:
    """Whether a value is the one, or in the range, that a transition system writes in this form."""
    ends = _ends(type_, text)
    return value_text(value, type_) == text if ends is None else ends[0] <= value <= ends[1]


def _ends(type_: Type, text: str) -> tuple[int, int] | None:
    """The smallest and the greatest number of a range as transition systems write it; None for other values."""
    limits = limits_of(type_)
    if limits is None or ".." not in text:
        return None
    low, high = (_number(type_, end) if end else limit for end, limit in zip(text.split(".."), limits, strict=True))
    return low, high


def _number(type_: Type, text: str) -> int:
    """Raises ValueError."""
    if isinstance(type_, TimeType):
        return parse_duration(text)
    return int(text)


def numbers_of(network: CoreNetwork) -> Iterator[int | float]:
    """The whole numbers in a program, and their neighbours; thresholds of floating-point numbers, and numbers between
    them: conditions depend on them.
    """
    found: dict[int, None] = {}
    for constant in network.constants:
        _collect(constant.value, found)
    for instance in network.instances:
        for _, value in instance.arguments:
            _collect(value, found)
    for entry in network.classes:
        if isinstance(entry, ProcessClass):
            _literals(entry.body, found)
    yield from (near for number in found for near in (number, number + 1, number - 1))
    thresholds = sorted(set(_thresholds(network)))
    if thresholds:
        yield from (thresholds[0] - 1, thresholds[-1] + 1)
    yield from ((low + high) / 2 for low, high in pairwise(thresholds))
    yield from thresholds


def _thresholds(network: CoreNetwork) -> Iterator[float]:
    """The floating-point numbers with which processes and control laws compare."""
    arguments = Arguments(network)
    for entry in network.classes:
        for part in parts(entry):
            if isinstance(part, BinaryOperation) and part.operator in COMPARISONS:
                for side in (part.left, part.right):
                    yield from (value for value in arguments.values(side, entry.name) if isinstance(value, float))


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
