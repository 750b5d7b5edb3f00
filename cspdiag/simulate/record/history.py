"""What passed a channel during a run: instants and values, compactly."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol, TypeAlias, assert_never

from cspdiag.base.record import record, replaced
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
from cspdiag.simulate.record.leaves import Path, column, leaf, leaf_of_each, leaves

if TYPE_CHECKING:
    import numpy

Instants: TypeAlias = "array[int] | numpy.ndarray"
"""Nanoseconds, in ascending order."""
Values: TypeAlias = "list[Any] | array[Any] | numpy.ndarray"
"""Values of one type: as they were passed, or as the numbers that they are."""


@record
class History:
    """What a recording has of a channel: all values that were passed, or, of a sampled input, all samples, read or not.

    ``read`` are the instants at which samples were read; it is empty for other channels.
    """

    time: Instants
    value: Values
    read: Instants
    sampled: bool = False

    def leaf(self, path: Path, start: int, stop: int) -> list[Any]:
        """One number of some of the values, as Python has them."""
        part = self.value[start:stop]
        found = part if isinstance(part, array) else leaf_of_each(part, path)
        return found if isinstance(found, list) else found.tolist()

    def array(self, type_: Type) -> numpy.ndarray:
        """The values as an array of the type of the channel."""
        import numpy

        if isinstance(self.value, list):
            return column(self.value, type_)
        return numpy.asarray(self.value).astype(column([], type_).dtype, copy=False)

    def with_safe_value(self, time: int, value: object, type_: Type) -> History:
        """The same with the safe value at the end, if it changes the output."""
        if not len(self.time):
            return self
        count = len(self.time)
        if all(self.leaf(path, count - 1, count) == [leaf(value, path)] for _, _, path in leaves("", type_)):
            return self
        return replaced(self, time=_and_one(self.time, time), value=_and_one(self.value, value, type_))


NOTHING = History(array("q"), [], array("q"))
"""The history of a channel through which nothing was passed."""


def _and_one(values: Any, value: Any, type_: Type | None = None) -> Any:
    if isinstance(values, list):
        return [*values, value]
    if isinstance(values, array):
        return values + array(values.typecode, [value])
    import numpy

    added = numpy.array([value], dtype=values.dtype) if type_ is None else column([value], type_)
    return numpy.concatenate([values, added])


class Passed(Protocol):
    """What was passed during a run."""

    @property
    def communications(self) -> Iterable[tuple[int, str, object, str, str]]:
        """All communications in order, each as the fields of ``Communication``."""
        ...

    @property
    def samples(self) -> Iterable[tuple[int, str, object]]:
        """All samples of sampled inputs in order, read or not: time in nanoseconds, port, value."""
        ...

    def histories(self, types: Mapping[str, Type]) -> Mapping[str, History]:
        """The history of each channel through which something was passed, in the order of the first communication;
        ``types`` are those of the channels.
        """
        ...


def series(type_: Type) -> list[Any] | array[Any]:
    """A sequence to which values of a type are added: numbers in as little memory as possible."""
    match type_:
        case RealType():
            return array("d")
        case IntType() | TimeType() | EnumType():
            return array("q")
        case BoolType():
            return array("b")
        case ArrayType() | StructType() | TextType() | UnknownType():
            return []
        case _:
            assert_never(type_)


def histories_of(
    communications: Iterable[tuple[int, str, object, str, str]], samples: Iterable[tuple[int, str, object]]
) -> dict[str, History]:
    """Histories from what happened in order; ``samples`` are those of sampled inputs, read or not."""
    passed = _by_channel((time, channel, value) for time, channel, value, _, _ in communications)
    sampled = _by_channel(samples)
    found = {}
    for channel in (*sampled, *(channel for channel in passed if channel not in sampled)):
        times, values = (sampled if channel in sampled else passed)[channel]
        read = passed.get(channel, ((), ()))[0] if channel in sampled else ()
        found[channel] = History(array("q", times), values, array("q", read), channel in sampled)
    return found


def _by_channel(entries: Iterable[tuple[int, str, object]]) -> dict[str, tuple[Sequence[int], list[Any]]]:
    found: dict[str, tuple[list[int], list[Any]]] = {}
    for time, channel, value in entries:
        own = found.get(channel)
        if own is None:
            own = found[channel] = ([], [])
        own[0].append(time)
        own[1].append(value)
    return found  # type: ignore[return-value]
