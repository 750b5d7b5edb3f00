"""Values that a port takes from its driver: functions that make a value of the port's type of what a driver has
returned, or refuse it.

Values of numpy are taken by the kind of their elements: ``dtype.kind``, of a scalar or an array without dimensions.
numpy need not be imported for that.
"""

from __future__ import annotations

import operator
import reprlib
from collections.abc import Callable
from enum import IntEnum
from functools import partial
from math import isinf
from typing import Any, TypeAlias, TypeVar

from ..compiled.arithmetic import finite, float32
from ..kernel.exceptions import Fault

Enumerator = TypeVar("Enumerator", bound=IntEnum)

Accept: TypeAlias = Callable[[Any], Any]
"""Raises TypeError, ValueError or Fault for what is not a value of the type."""

_SHORT = reprlib.Repr()
_SHORT.maxstring = _SHORT.maxother = 60


def double(value: Any) -> float:
    """A number; NaN and infinities are numbers."""
    if type(value) is float:
        return value
    if _kind(value) not in ("", "i", "u", "f") or not hasattr(type(value), "__float__"):
        raise TypeError(f"{_shown(value)} is not a number")
    try:
        return float(value)
    except OverflowError:
        raise Fault(f"{_shown(value)} is too large for double precision") from None


def single(value: Any) -> float:
    """A number, rounded to 32 bits; NaN and infinities are numbers. Raises Fault for one that is too large."""
    number = double(value)
    rounded = float32(number)
    if isinf(rounded) and not isinf(number):
        raise Fault(f"{number!r} is too large for single precision")
    return rounded


def calculated(value: Any, accept: Accept) -> Any:
    """What a hand-written law has calculated, as a value of its output. Raises Fault for a NaN or an infinity in it."""
    taken = accept(value)
    _require_finite(taken)
    return taken


def _require_finite(value: Any) -> None:
    if isinstance(value, float):
        finite(value)
    elif isinstance(value, tuple):
        for part in value:
            _require_finite(part)


def boolean(value: Any) -> bool:
    """True or False, or the integers 1 or 0."""
    if _kind(value) == "b" or (_is_integer(value) and operator.index(value) in (0, 1)):
        return bool(value)
    raise TypeError(f"{_shown(value)} is neither True nor False")


def integer(of: Callable[[int], int]) -> Accept:
    """An integer that ``of``, such as ``int8``, takes."""
    return partial(take_integer, of)


def take_integer(of: Callable[[int], int], value: Any) -> int:
    """See ``integer``."""
    if not _is_integer(value):
        raise TypeError(f"{_shown(value)} is no integer")
    return of(operator.index(value))


def enumeration(of: type[Enumerator]) -> Callable[[Any], Enumerator]:
    """A member of an enum of the program, or its number."""
    return partial(take_member, of)


def take_member(of: type[Enumerator], value: Any) -> Enumerator:
    """See ``enumeration``."""
    if not _is_integer(value):
        raise TypeError(f"{_shown(value)} is no {of.__name__}")
    return of(operator.index(value))


def text(value: Any) -> str:
    """A text."""
    if not isinstance(value, str):
        raise TypeError(f"{_shown(value)} is no text")
    return value


def array(element: Accept, size: int) -> Accept:
    """A sequence of ``size`` elements, as a tuple."""
    return partial(take_elements, element, size)


def take_elements(element: Accept, size: int, value: Any) -> tuple[Any, ...]:
    """See ``array``."""
    parts = _parts(value, size)
    return tuple([element(part) for part in parts])


def record(made: Callable[..., Any], *fields: Accept) -> Accept:
    """A sequence of the fields of a struct, as the struct; ``made`` is its class."""
    return partial(take_fields, made, fields)


def take_fields(made: Callable[..., Any], fields: tuple[Accept, ...], value: Any) -> Any:
    """See ``record``."""
    parts = _parts(value, len(fields))
    return made(*[field(part) for field, part in zip(fields, parts, strict=True)])


def _shown(value: Any) -> str:
    """A value for a message: not all of it if it is long, or nested deeply."""
    return _SHORT.repr(value)


def _kind(value: Any) -> str:
    """The kind of a value of numpy: ``b`` for True and False, ``i``, ``u`` and ``f`` for numbers, others for anything
    else; empty for a value whose class decides.
    """
    if isinstance(value, bool):
        return "b"
    if isinstance(value, str | bytes):
        return "U"
    if getattr(value, "ndim", 0):
        return "V"
    return str(getattr(getattr(value, "dtype", None), "kind", ""))


def _is_integer(value: Any) -> bool:
    return type(value) is int or (_kind(value) in ("", "i", "u") and hasattr(type(value), "__index__"))


def _parts(value: Any, size: int) -> list[Any]:
    # Only what has an order: not a set, nor a dict, whose elements are accessed by keys.
    ordered = hasattr(type(value), "__iter__") and hasattr(type(value), "__getitem__")
    parts = list(value) if ordered and not isinstance(value, str | bytes | dict) else None
    if parts is None or len(parts) != size:
        raise TypeError(f"{_shown(value)} is no sequence of {size} value{'s' * (size != 1)}")
    return parts
