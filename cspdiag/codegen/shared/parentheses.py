"""Which operands need parentheses: decided once, with a table of the operators of each language."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Generic, Protocol, TypeVar

from cspdiag.base.record import record


class Ranked(Protocol):
    """An expression of a generated language."""

    @property
    def precedence(self) -> int:
        """How tightly its operator binds."""


T = TypeVar("T", bound=Ranked)


@record
class Operands:
    """How tightly the operands of an operator with two of them bind at least if they have no parentheses.

    Of operators that ``chain``, the first may also be a row of operators of the same precedence: ``a - b + c``.
    """

    first: int
    second: int
    chain: bool = True


class Parentheses(Generic[T]):
    """Those of one language; ``operators`` has what its operators want, by precedence."""

    def __init__(self, around: Callable[[T], T], operators: Mapping[int, Operands]) -> None:
        self._around = around
        self._operators = operators

    def at_least(self, item: T, precedence: int) -> T:
        """``item``, in parentheses if it binds more loosely than ``precedence``."""
        return item if item.precedence >= precedence else self._around(item)

    def operands(self, precedence: int, first: T, second: T) -> tuple[T, T]:
        """The operands of an operator, in parentheses where it wants them."""
        wanted = self._operators[precedence]
        stays = wanted.chain and first.precedence == precedence
        return first if stays else self.at_least(first, wanted.first), self.at_least(second, wanted.second)
