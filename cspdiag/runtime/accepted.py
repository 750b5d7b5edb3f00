"""Values that a port takes from its driver: functions that make a value of the port's type of what a driver has returned, or refuse it.

An enum of the program is such a function itself.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any, TypeAlias

from .arithmetic import float32

Accept: TypeAlias = Callable[[Any], Any]
"""Raises TypeError, ValueError, OverflowError or Fault for what is no value of the type."""


def double(value: Any) -> float:
    """A number; NaN and infinities are numbers."""
    if isinstance(value, str | bytes) or _is_bool(value) or not hasattr(type(value), "__float__"):
        raise TypeError(f"{value!r} is no number")
    return float(value)


def single(value: Any) -> float:
    """A number, rounded to 32 bits."""
    return float32(double(value))


def boolean(value: Any) -> bool:
    """True or False, or the integers 1 or 0."""
    if _is_bool(value) or (hasattr(type(value), "__index__") and operator.index(value) in (0, 1)):
        return bool(value)
    raise TypeError(f"{value!r} is neither True nor False")


def integer(of: Callable[[int], int]) -> Accept:
    """An integer that ``of``, such as ``int8``, takes."""

    def accept(value: Any) -> int:
        if _is_bool(value) or not hasattr(type(value), "__index__"):
            raise TypeError(f"{value!r} is no integer")
        return of(operator.index(value))

    return accept


def text(value: Any) -> str:
    """A text."""
    if not isinstance(value, str):
        raise TypeError(f"{value!r} is no text")
    return value


def array(element: Accept, size: int) -> Accept:
    """A sequence of ``size`` elements, as a tuple."""

    def accept(value: Any) -> tuple[Any, ...]:
        parts = _parts(value, size)
        return tuple([element(part) for part in parts])

    return accept


def record(made: Callable[..., Any], *fields: Accept) -> Accept:
    """A sequence of the fields of a struct, as the struct; ``made`` is its class."""

    def accept(value: Any) -> Any:
        parts = _parts(value, len(fields))
        return made(*[field(part) for field, part in zip(fields, parts, strict=True)])

    return accept


def _is_bool(value: Any) -> bool:
    """Whether it is True or False, of Python or of numpy, which is not imported for that: neither is a number."""
    return isinstance(value, bool) or type(value).__name__ in ("bool", "bool_")


def _parts(value: Any, size: int) -> list[Any]:
    parts = None if isinstance(value, str | bytes | dict) or not hasattr(type(value), "__iter__") else list(value)
    if parts is None or len(parts) != size:
        raise TypeError(f"{value!r} is no sequence of {size} values")
    return parts
