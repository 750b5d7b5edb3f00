"""Rolls consecutive repetitions of the same steps into loops that count, also in one another."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from cspdiag.model.types import BOOL, INT
from cspdiag.network.ir.actions import Action, AssignValue, Repeat, Target
from cspdiag.network.ir.expressions import BinaryOperation, Expression, LiteralValue, VariableValue
from cspdiag.optimize.changes import in_sequence

LEAST_SAVED = 8
"""The least number of steps that a loop must save."""


def rolled(steps: Sequence[Action], counter: Callable[[], str]) -> list[Action]:
    """The steps with repetitions rolled into loops; ``counter`` returns the name of a new variable for each."""
    numbers: dict[Action, int] = {}
    sequence = [numbers.setdefault(step, len(numbers)) for step in steps]
    result: list[Action] = []
    position = 0
    while position < len(steps):
        length, times = _best_repetition(sequence, position)
        if length * (times - 1) >= LEAST_SAVED:
            name = counter()
            result += _loop(rolled(steps[position : position + length], counter), times, name)
            position += length * times
        else:
            result.append(steps[position])
            position += 1
    return result


def _best_repetition(sequence: Sequence[int], start: int) -> tuple[int, int]:
    """The length and the number of consecutive repetitions that save the most steps."""
    best = (0, 1)
    for length in range(1, (len(sequence) - start) // 2 + 1):
        if sequence[start] != sequence[start + length]:
            continue
        part = sequence[start : start + length]
        times = 1
        while sequence[start + times * length : start + (times + 1) * length] == part:
            times += 1
        if length * (times - 1) > best[0] * (best[1] - 1):
            best = (length, times)
    return best


def _loop(body: Sequence[Action], times: int, counter: str) -> list[Action]:
    place = body[0]
    counted = VariableValue(type=INT, channel=counter)
    before = VariableValue(type=INT, channel=counter, range=(0, times - 1))  # one more is surely a number
    one_more: Expression = BinaryOperation(type=INT, operator="+", left=before, right=LiteralValue(type=INT, value=1))
    is_last = BinaryOperation(type=BOOL, operator="==", left=counted, right=LiteralValue(type=INT, value=times))
    zero = LiteralValue(type=INT, value=0)
    return [
        AssignValue(span=place.span, target=Target(counter), value=zero),
        Repeat(
            span=place.span,
            body=in_sequence([*body, AssignValue(span=place.span, target=Target(counter), value=one_more)], place),
            until=is_last,
        ),
    ]
