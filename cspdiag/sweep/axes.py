"""What a sweep varies: names with the values that each takes, from texts such as ``0.8e-3:1.2e-3:5``."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias, assert_never

from cspdiag.base.record import record
from cspdiag.settings import SettingError, Target, target_of, value_of

if TYPE_CHECKING:
    from cspdiag.model.program import Program, Value
    from cspdiag.model.types import Type
    from cspdiag.network.lower.setting_paths import Root

MOST_RUNS = 10_000_000
"""A grid with more runs is taken for a mistake."""

Cell: TypeAlias = "bool | int | float | str"
"""A value as tables have it: times in seconds, literals of enums as texts."""

_RANGE = re.compile(r"(?P<first>[^:]+):(?P<last>[^:]+):(?P<count>[^:]+?)(?P<log>:\s*log\s*)?")


@record
class AxisValue:
    """A value: the setting as a text that gives it exactly, the value of the language, and what tables have."""

    text: str
    value: Value
    cell: Cell


@record
class Axis:
    """A name that is varied, what it sets, and the values."""

    name: str
    target: Target
    values: tuple[AxisValue, ...]


@record
class Grid:
    """All combinations of the values of the axes; those of the last one change fastest."""

    axes: tuple[Axis, ...]

    def __len__(self) -> int:
        return math.prod(len(axis.values) for axis in self.axes)

    def positions(self, run: int) -> tuple[int, ...]:
        """For each axis, which of its values a run has."""
        found = []
        for axis in reversed(self.axes):
            run, position = divmod(run, len(axis.values))
            found.append(position)
        return tuple(reversed(found))

    def values(self, run: int) -> Iterator[tuple[Axis, AxisValue]]:
        """The values of a run."""
        for axis, position in zip(self.axes, self.positions(run), strict=True):
            yield axis, axis.values[position]


def grid_of(program: Program, given: Mapping[str, str | Sequence[str]], roots: Sequence[Root]) -> Grid:
    """The grid that settings describe: a text as on the command line, or a sequence of values.

    Raises SettingError for a name that cannot be set, for values that do not fit, and for a grid that is too large.
    """
    grid = Grid(tuple(_axis(program, name, values, roots) for name, values in given.items()))
    if len(grid) > MOST_RUNS:
        sizes = " x ".join(str(len(axis.values)) for axis in grid.axes)
        raise SettingError(f"the grid has {sizes} = {len(grid)} runs, more than {MOST_RUNS}: take fewer values")
    return grid


def _axis(program: Program, name: str, given: str | Sequence[str], roots: Sequence[Root]) -> Axis:
    target = target_of(program, name, roots)
    if _is_struct(target.type):
        value_of(name, "", target.type, is_constant=not target.roots)  # It says that fields are set one by one.
    values = _spread(name, given, target) if isinstance(given, str) else [_value(name, text, target) for text in given]
    if not values:
        raise SettingError(f"{name}: a sweep needs at least one value")
    return Axis(name, target, tuple(values))


def _is_struct(type_: Type) -> bool:
    from cspdiag.model.types import StructType

    return isinstance(type_, StructType)


def _spread(name: str, text: str, target: Target) -> list[AxisValue]:
    """The values of a text: ``first:last:count``, with ``:log`` in equal ratios, or a list with commas."""
    from cspdiag.model.types import ArrayType, TextType

    if isinstance(target.type, ArrayType | TextType):
        return [_value(name, text, target)]
    if ":" not in text:
        return [_value(name, part, target) for part in text.split(",")]
    found = _RANGE.fullmatch(text)
    if found is None:
        raise SettingError(f"{name}: `{text}` is not FIRST:LAST:COUNT, such as 1:5:9, nor FIRST:LAST:COUNT:log")
    count = found["count"].strip()
    if not re.fullmatch(r"[0-9]+", count):
        raise SettingError(
            f"{name}: `{text}` is not FIRST:LAST:COUNT, such as 1:5:9: {count} is not a number of values"
        )
    count = count.lstrip("0") or "0"
    if count == "0":
        raise SettingError(f"{name}: a sweep needs at least one value")
    if len(count) > len(str(MOST_RUNS)) or int(count) > MOST_RUNS:
        raise SettingError(f"{name}: {count} values are too many: a sweep has at most {MOST_RUNS} runs")
    first, last = (_value(name, part, target) for part in (found["first"], found["last"]))
    return _between(name, target, first, last, int(count), logarithmic=found["log"] is not None)


def _between(
    name: str, target: Target, first: AxisValue, last: AxisValue, count: int, *, logarithmic: bool
) -> list[AxisValue]:
    from cspdiag.model.types import IntType, RealType, TimeType

    type_ = target.type
    if not isinstance(type_, RealType | TimeType | IntType):
        raise SettingError(f"{name}: there are no values between two of type {type_}: list them, such as a,b,c")
    low, high = first.value, last.value
    assert isinstance(low, int | float)
    assert isinstance(high, int | float)
    if logarithmic and not low * high > 0:
        raise SettingError(f"{name}: equal ratios need two values of one sign, not {first.text} and {last.text}")
    inner = range(1, count - 1)
    if logarithmic:
        numbers = [low, *(low * (high / low) ** (at / (count - 1)) for at in inner)]
    else:
        # The mean of the ends, weighted: 0.1, 0.2, 0.3 instead of 0.30000000000000004.
        numbers = [low, *((low * (count - 1 - at) + high * at) / (count - 1) for at in inner)]
    numbers += [high] if count > 1 else []
    if isinstance(type_, IntType) and any(number != int(number) for number in numbers):
        raise SettingError(f"{name}: {count} values from {low} to {high} are not whole numbers")
    return [_value(name, _text(number, type_), target) for number in numbers]


def _text(number: float, type_: Type) -> str:
    """A number as a setting that gives it exactly."""
    from cspdiag.model.types import IntType, TimeType

    if isinstance(type_, TimeType):
        return f"{round(number)} ns"
    return str(int(number)) if isinstance(type_, IntType) else repr(float(number))


def _value(name: str, text: str, target: Target) -> AxisValue:
    text = text.strip() if type(text) is str else text
    value = value_of(name, text, target.type, is_constant=not target.roots)
    return AxisValue(text, value, _cell(value, target.type, text))


def _cell(value: Value, type_: Type, text: str) -> Cell:
    from cspdiag.model.types import (
        ArrayType,
        BoolType,
        EnumType,
        IntType,
        RealType,
        StructType,
        TextType,
        TimeType,
        UnknownType,
    )

    match type_:
        case BoolType():
            return bool(value)
        case IntType():
            assert isinstance(value, int)
            return value
        case RealType():
            assert isinstance(value, int | float)
            return float(value)
        case TimeType():
            assert isinstance(value, int)
            return value / 1e9
        case EnumType():
            assert isinstance(value, int)
            return type_.literals[value]
        case ArrayType() | StructType() | TextType() | UnknownType():
            return text
        case _:
            assert_never(type_)
