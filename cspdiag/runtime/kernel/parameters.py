"""The parameters of a program: values that may change between two instants of a run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from math import isfinite
from threading import Lock
from typing import Any, Generic, NamedTuple, TypeVar

from .exceptions import fault_of

T = TypeVar("T")


class Parameter(Generic[T]):
    """A parameter, or a constant that follows from some; what uses it sees its new ``value`` at once.

    ``accepts`` makes a value of its type of what it is given, or raises; None for a constant that follows.
    """

    __slots__ = ("accepts", "name", "value")

    def __init__(self, name: str, value: T, accepts: Callable[[Any], T] | None = None) -> None:
        self.name = name
        self.value = value
        self.accepts = accepts


class Change(NamedTuple):
    """A new value of a parameter, or of the part of it at a path of positions of fields and elements.

    It takes effect at the first instant at or after ``time`` (in nanoseconds), before anything else happens at it.
    """

    time: int
    parameter: str
    path: tuple[int, ...]
    value: Any


class ProgramParameters:
    """The parameters of one running program, with the changes that are still to come.

    A generated subclass has them as attributes, and computes in ``follow`` the constants that follow from them.
    """

    def __init__(self) -> None:
        self._coming: list[Change] = []
        self._lock = Lock()
        self.refused: list[tuple[Change, str]] = []
        """Changes that were not made, and why."""

    @property
    def names(self) -> list[str]:
        """The names of the parameters, without those of the constants that follow."""
        declared = (one for one in vars(self).values() if isinstance(one, Parameter))
        return [one.name for one in declared if one.accepts is not None]

    def follow(self) -> None:
        """Compute the constants that follow from the parameters."""

    def plan(self, changes: Iterable[Change]) -> None:
        """Add changes, from any thread; those of one instant are made in the order in which they were added."""
        with self._lock:
            self._coming = sorted((*self._coming, *changes), key=lambda change: change.time)

    def next_change(self) -> int | None:
        """The time of the next change that is planned."""
        return self._coming[0].time if self._coming else None

    def reach(self, instant: int) -> list[Change]:
        """Make the changes up to an instant, and return those that were made.

        One that gives a parameter a value that it cannot have, or from which something cannot be computed, is refused.
        """
        if not self._coming or self._coming[0].time > instant:
            return []
        with self._lock:
            due = [change for change in self._coming if change.time <= instant]
            self._coming = self._coming[len(due) :]
        return [change for change in due if self._made(change)]

    def _made(self, change: Change) -> bool:
        declared = {one.name: one for one in vars(self).values() if isinstance(one, Parameter)}
        before = [(one, one.value) for one in declared.values()]
        try:
            parameter = declared[change.parameter]
            if parameter.accepts is None:
                raise ValueError(f"{change.parameter} follows from parameters")
            parameter.value = parameter.accepts(with_part(parameter.value, change.path, change.value))
            self.follow()
            for one in declared.values():
                _require_finite(one.value)
        except Exception as problem:
            for one, value in before:
                one.value = value
            reason = fault_of(problem, None) if isinstance(problem, ArithmeticError) else problem
            self.refused.append((change, str(reason)))
            return False
        return True


def with_part(whole: Any, path: Sequence[int], part: Any) -> Any:
    """A value as a tuple of its parts, with another part at a path of positions."""
    if not path:
        return part
    first, *rest = path
    return (*whole[:first], with_part(whole[first], rest, part), *whole[first + 1 :])


def _require_finite(value: Any) -> None:
    if isinstance(value, float) and not isfinite(value):
        raise ValueError(f"{value} is not finite")
    if isinstance(value, tuple):
        for part in value:
            _require_finite(part)
