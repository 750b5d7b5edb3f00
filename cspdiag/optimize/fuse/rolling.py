"""Steps that are done several times on end, as a loop that counts."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from cspdiag.model.types import BOOL, INT
from cspdiag.network.ir.actions import Action, AssignValue, Repeat, Target
from cspdiag.network.ir.expressions import BinaryOperation, Expression, LiteralValue, VariableValue
from cspdiag.optimize.changes import in_sequence

LEAST_SAVED = 8
"""Steps that a loop has to save."""


def rolled(steps: Sequence[Action], counter: Callable[[], str]) -> list[Action]:
    """The steps, with what repeats in loops; ``counter`` gives the name of a variable for each."""
    numbers: dict[Action, int] = {}
    text = [numbers.setdefault(step, len(numbers)) for step in steps]
    result: list[Action] = []
    position = 0
    while position < len(steps):
        length, times = _best_repetition(text, position)
        if length * (times - 1) >= LEAST_SAVED:
            result += _loop(steps[position : position + length], times, counter())
            position += length * times
        else:
            result.append(steps[position])
            position += 1
    return result


def _best_repetition(text: Sequence[int], start: int) -> tuple[int, int]:
    """The length, and how often it comes on end, of what saves most."""
    best = (0, 1)
    for length in range(1, (len(text) - start) // 2 + 1):
        if text[start] != text[start + length]:
            continue
        part = text[start : start + length]
        times = 1
        while text[start + times * length : start + (times + 1) * length] == part:
            times += 1
        if length * (times - 1) > best[0] * (best[1] - 1):
            best = (length, times)
    return best


def _loop(body: Sequence[Action], times: int, counter: str) -> list[Action]:
    place = body[0]
    counted = VariableValue(type=INT, channel=counter)
    one_more: Expression = BinaryOperation(type=INT, operator="+", left=counted, right=LiteralValue(type=INT, value=1))
    enough = BinaryOperation(type=BOOL, operator="==", left=counted, right=LiteralValue(type=INT, value=times))
    zero = LiteralValue(type=INT, value=0)
    return [
        AssignValue(span=place.span, target=Target(counter), value=zero),
        Repeat(
            span=place.span,
            body=in_sequence([*body, AssignValue(span=place.span, target=Target(counter), value=one_more)], place),
            until=enough,
        ),
    ]
