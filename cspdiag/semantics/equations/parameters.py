"""Parameters of the program: values that may change between two instants. «Parameters»"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

from cspdiag.model.types import ArrayType, StructType, Type
from cspdiag.network.ir.network import ProgramParameter
from cspdiag.semantics.values import Cell, FaultError, fitting, value_of


class Change(NamedTuple):
    """A new value of a parameter, or of the part of it at ``path`` (positions of fields and elements), that takes
    effect at the first instant at or after ``time`` (nanoseconds). «Parameters»
    """

    time: int
    parameter: str
    path: tuple[int, ...]
    value: Any


class Parameters:
    """The parameters of a program, and the changes that are still to come. «Parameters»"""

    def __init__(self, declared: Sequence[ProgramParameter], changes: Iterable[Change] = ()) -> None:
        self.declared = declared
        self.cells = {parameter.name: Cell(parameter.value) for parameter in declared}
        self.coming = sorted(changes, key=lambda change: change.time)

    def reach(self, instant: int) -> list[tuple[Change, str]]:
        """Make the changes up to an instant, before anything else happens at it; return them, each with the reason why
        it was not made, if it was not.
        """
        due = [change for change in self.coming if change.time <= instant]
        self.coming = self.coming[len(due) :]
        return [(change, self._make(change)) for change in due]

    def _make(self, change: Change) -> str:
        before = {name: cell.value for name, cell in self.cells.items()}
        cell = self.cells[change.parameter]
        cell.value = with_part(cell.value, change.path, change.value)
        try:
            for parameter in self.declared:
                own = self.cells[parameter.name]
                if parameter.follows is not None:
                    own.value = value_of(parameter.follows, self.cells, _no_name, _no_name)
                own.value = _finite(parameter.type, own.value)
        except FaultError as fault:
            for name, value in before.items():
                self.cells[name].value = value
            return str(fault)
        return ""


def _finite(kind: Type, value: Any) -> Any:
    """A value of this type, with all its real numbers finite. Raises FaultError."""
    match kind:
        case StructType(fields=fields):
            return tuple(_finite(inner, part) for (_, inner), part in zip(fields, value, strict=True))
        case ArrayType(element=element):
            return tuple(_finite(element, part) for part in value)
        case _:  # A single value.
            fitted = fitting(kind, value)
            if isinstance(fitted, float) and not math.isfinite(fitted):
                raise FaultError(f"{fitted} is not finite")
            return fitted


def with_part(whole: Any, path: Sequence[int], part: Any) -> Any:
    """A value with another part at a path of positions. «Parameters»"""
    if not path:
        return part
    first, *rest = path
    return (*whole[:first], with_part(whole[first], rest, part), *whole[first + 1 :])


def _no_name(name: str) -> Any:
    raise AssertionError(f"a parameter does not follow from {name}")
