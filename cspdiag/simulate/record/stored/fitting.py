"""Numbers that other programs have written as values of the types of a program."""

from __future__ import annotations

from typing import TYPE_CHECKING, assert_never

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
from cspdiag.simulate.record.leaves import leaf_of_each, leaves
from cspdiag.simulate.record.stored.recording import assembled

if TYPE_CHECKING:
    import numpy


class NoValueError(ValueError):
    """A number is no value of its type: the one at ``position``. ``name`` is that of the number within its port."""

    def __init__(self, position: int, number: object, kind: Type, name: str = "") -> None:
        super().__init__(f"{number} is no {_described(kind)}")
        self.position = position
        self.name = name


def as_values(numbers: numpy.ndarray, kind: Type, name: str = "") -> numpy.ndarray:
    """Numbers as values of a type that is not an array or a struct: of a ``float``, they are rounded to it.

    Raises NoValueError for the first that is too large, too small, or not the number of a literal.
    """
    import numpy

    match kind:
        case RealType(bits=32):
            with numpy.errstate(over="ignore"):
                rounded = numbers.astype(numpy.float32).astype(float)
            wrong = numpy.isinf(rounded) & numpy.isfinite(numbers.astype(float))
        case IntType(minimum=low, maximum=high):
            rounded, wrong = numbers, (numbers < low) | (numbers > high)
        case TimeType():
            rounded, wrong = numbers, (numbers < IntType().minimum) | (numbers > IntType().maximum)
        case EnumType(literals=literals):
            rounded, wrong = numbers, (numbers < 0) | (numbers >= len(literals))
        case BoolType() | RealType() | TextType() | UnknownType() | StructType() | ArrayType():
            return numbers
        case _:
            assert_never(kind)
    if wrong.any():
        position = int(wrong.argmax())
        raise NoValueError(position, numbers[position], kind, name)
    return rounded


def fitted(values: numpy.ndarray, name: str, kind: Type) -> numpy.ndarray:
    """The same for values of any type: those of a port of this name."""
    import numpy

    numbers = [
        as_values(numpy.asarray(leaf_of_each(values, path)), inner, full) for full, inner, path in leaves(name, kind)
    ]
    return assembled(numbers, kind, len(values))


def _described(kind: Type) -> str:
    match kind:
        case IntType(minimum=low, maximum=high):
            return f"{kind}: those are from {low} to {high}"
        case EnumType(literals=literals):
            return f"{kind}: those are {', '.join(f'{at} ({name})' for at, name in enumerate(literals))}"
        case _:  # Of the others, the name says it.
            return str(kind)
