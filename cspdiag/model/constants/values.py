"""Values that are given outside of a program, as in ``--set Tsh=10ms``."""

from __future__ import annotations

import re

from cspdiag.model.constants.arithmetic import OutOfRangeError, UndefinedError, checked
from cspdiag.model.program import Value
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
from cspdiag.model.units import conversion_factor, parse_unit
from cspdiag.syntax.parse.numbers import nanoseconds

_PART = re.compile(r"\.([A-Za-z_][A-Za-z0-9_]*)|\[([0-9]{1,9})\]")
_QUANTITY = re.compile(r"([+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(?:<([^<>]*)>|([A-Za-z%].*))?")
_DURATIONS = ("ns", "us", "ms", "s", "min")
_FREQUENCIES = ("Hz", "kHz", "MHz")
_UNITS_OF_TIME = f"{', '.join(_DURATIONS)}, or the period of a frequency in Hz, kHz, MHz"


def parse_value(type_: Type, text: str) -> Value:
    """A value of a type: ``10ms``, ``1kHz``, ``2e-3``, ``0.5<rad>``, ``0.5 rad``, ``true``, ``Mode.run``, ``[1, 2]``.

    A number without a unit has that of the type. Raises ValueError, with a message for users, if ``text`` is not such
    a value.
    """
    text = text.strip()
    match type_:
        case BoolType():
            if text in {"true", "false"}:
                return text == "true"
            raise ValueError(f"`{text}` is neither true nor false")
        case TimeType():
            return _time(text)
        case IntType():
            if not re.fullmatch(r"[+-]?[0-9]{1,30}", text):
                raise ValueError(f"`{text}` is not of type {type_}")
            return _checked(int(text), type_, text)
        case RealType():
            return _real(type_, text)
        case EnumType():
            name = text.removeprefix(f"{type_.name}.")
            if name not in type_.literals:
                raise ValueError(f"`{text}` is not one of {', '.join(type_.literals)}")
            return type_.literals.index(name)
        case ArrayType():
            return _array(type_, text)
        case TextType():
            return text
        case StructType():
            raise ValueError(f"a value of the struct {type_.name} cannot be given here")
        case UnknownType():
            raise ValueError("its type is not known")


class NoPartError(ValueError):
    """A type has no field or element with a certain path; the message is one line. ``before`` is the part of the path
    that exists.
    """

    def __init__(self, message: str, before: str, fields: tuple[str, ...] = ()) -> None:
        super().__init__(message)
        self.before = before
        self.fields = fields


def part_of(type_: Type, path: str) -> tuple[Type, tuple[int, ...]]:
    """The type of a field or element with a path, such as ``.gains[1].kp``, and the positions along the path. Raises
    NoPartError.
    """
    positions: list[int] = []
    at = 0
    while at < len(path):
        step = _PART.match(path, at)
        name, index = step.groups() if step is not None else (None, None)
        match type_:
            case StructType():
                names = tuple(field for field, _ in type_.fields)
                if name not in names:
                    raise NoPartError(f"{type_} has the fields {', '.join(names)}", path[:at], names)
                positions.append(names.index(name))
                type_ = type_.fields[positions[-1]][1]
            case ArrayType():
                if index is None or (type_.size is not None and int(index) >= type_.size):
                    last = f" to [{type_.size - 1}]" if type_.size is not None and type_.size > 1 else ""
                    raise NoPartError(f"it has the elements [0]{last}", path[:at])
                positions.append(int(index))
                type_ = type_.element
            case _:
                raise NoPartError(f"{path[:at].lstrip('.') or 'it'} is {type_}, without fields or elements", path[:at])
        assert step is not None
        at = step.end()
    return type_, tuple(positions)


def with_part(type_: Type, value: Value, path: str, part: Value) -> Value:
    """A struct or array with another value at ``path``; unchanged if there is no such field or element."""
    try:
        positions = part_of(type_, path)[1]
    except NoPartError:
        return value
    return _replaced(value, positions, part)


def _replaced(value: Value, positions: tuple[int, ...], part: Value) -> Value:
    if not positions:
        return part
    first, *others = positions
    if not isinstance(value, tuple) or first >= len(value):
        return value
    return (*value[:first], _replaced(value[first], tuple(others), part), *value[first + 1 :])


def _checked(value: float, type_: Type, text: str) -> int | float:
    try:
        return checked(value, type_)
    except (OutOfRangeError, UndefinedError, OverflowError):
        raise ValueError(f"`{text}` does not fit {type_}") from None


def _quantity(text: str, what: str) -> tuple[str, str | None]:
    """The number and the unit of a quantity."""
    found = _QUANTITY.fullmatch(text)
    if found is None:
        raise ValueError(f"`{text}` is not {what}")
    number, bracketed, plain = found.groups()
    return number, bracketed if bracketed is not None else plain


def _time(text: str) -> int:
    number, unit = _quantity(text, "a time, such as 10 ms")
    if unit is None or (unit not in _DURATIONS and (unit not in _FREQUENCIES or float(number) <= 0)):
        raise ValueError(f"`{text}` is not a time; write it with a unit, such as 10ms (there are {_UNITS_OF_TIME})")
    duration = nanoseconds(number.lstrip("+-"), unit)
    if duration is None:
        raise ValueError(f"`{text}` does not fit {TimeType()}")
    return int(_checked(-duration if number.startswith("-") else duration, TimeType(), text))


def _real(type_: RealType, text: str) -> float:
    number, unit = _quantity(text, f"of type {type_}")
    value = float(number)
    if unit is not None:
        found = parse_unit(unit)
        if found is None:
            raise ValueError(f"`{unit}` is not a unit")
        factor = conversion_factor(found, type_.unit)
        if factor is None:
            raise ValueError(f"`{text}` is not of type {type_}: the units do not agree")
        value *= factor
    return float(_checked(value, type_, text))


def _array(type_: ArrayType, text: str) -> Value:
    if not (text.startswith("[") and text.endswith("]")) or isinstance(type_.element, ArrayType):
        raise ValueError(f"`{text}` is not of type {type_}; write it as [a, b, c]")
    values = tuple(parse_value(type_.element, part) for part in text[1:-1].split(","))
    if type_.size is not None and type_.size != len(values):
        elements = "one element" if len(values) == 1 else f"{len(values)} elements"
        raise ValueError(f"`{text}` has {elements}, not {type_.size}")
    return values
