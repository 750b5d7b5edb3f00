"""Folding in steps that repeat: what one turn of a loop becomes, all become, or it stays as it is.

The network has the turns of ``seq i < 16 : sum := sum + taps[i] * line[i]`` one after another. If each were folded by
itself, each would get a number of its own in place of ``taps[i]``, and ``c + i`` would be ``c`` in the first turn only:
a target that has loops could not write them as one.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Hashable, Sequence
from operator import sub
from typing import Any, TypeAlias, cast

from cspdiag.base.record import field_names, is_record, replaced
from cspdiag.model.types import ArrayType
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.everywhere import fields_inside, rewritten
from cspdiag.network.ir.expression_walk import operands
from cspdiag.network.ir.expressions import (
    BinaryOperation,
    ElementValue,
    Expression,
    LiteralValue,
    Typed,
    UnaryOperation,
    VariableValue,
)
from cspdiag.network.ir.walk import parts

Change: TypeAlias = "Callable[[Any], Any]"
"""Folds an expression whose operands have been folded, or decides an action."""

LEAST = 3
"""Fewer turns are not a loop in any target."""

_ROLLED = (
    ir.RunInstance, ir.SkipStep, ir.StopStep, ir.ReadValue, ir.WriteValue, ir.AssignValue, ir.WaitStep,
    ir.RaiseException, ir.SequentialSteps, ir.ParallelSteps, ir.Repeat, ir.WhileLoop, ir.CountedLoop, ir.IfElse,
    ir.Branch, ir.ReadyEvent, ir.InputEvent, ir.OutputEvent, ir.AfterEvent, ir.SkipEvent,
)  # fmt: skip
"""Steps of turns, or of branches, that a target may write once."""

_INDEX = re.compile(r"\[\d+\]")


def folded_alike(action: ir.Action, change: Change) -> ir.Action:
    """``action`` with ``change`` applied to every record in it, innermost first. Steps of a sequence, a parallel or an
    alternative that differ only in numbers that count still do afterwards.
    """
    (result,) = _Folding(change).together([action])
    return cast("ir.Action", result)


class _Folding:
    def __init__(self, change: Change) -> None:
        self._change = change

    def together(self, items: Sequence[Any]) -> list[Any]:
        """Parts of one shape, all changed in the same way."""
        first = items[0]
        if len(items) == 1 and isinstance(first, Typed):
            return [rewritten(first, self._change)]
        if isinstance(first, tuple):
            if any(isinstance(step, ir.Step) for step in first):
                return self._steps(items)
            columns = [self.together(column) for column in zip(*items, strict=True)]
            return [tuple([column[at] for column in columns]) for at in range(len(items))]
        names = fields_inside(first)
        if names is None:
            return list(items)
        inside = {name: self.together([getattr(item, name) for item in items]) for name in names}
        changed = [_with(item, {name: new[at] for name, new in inside.items()}) for at, item in enumerate(items)]
        if isinstance(first, Typed):
            results = [self._change(item) for item in changed]
            return results if _count(changed, results) else changed
        return [self._change(item if len(items) == 1 else self._with_decision(item)) for item in changed]

    def _steps(self, several: Sequence[tuple[ir.Step, ...]]) -> list[tuple[ir.Step, ...]]:
        """Sequences of steps, or one: steps that come from one place in the text and differ only in numbers are changed
        in the same way, in whichever sequence they are.
        """
        all_steps = [step for steps in several for step in steps]
        groups: dict[Hashable, list[int]] = {}
        for at, step in enumerate(all_steps):
            groups.setdefault((step.span, _shape(step)) if len(all_steps) >= LEAST else at, []).append(at)
        results = all_steps[:]
        for group in groups.values():
            for at, result in zip(group, self._group([all_steps[at] for at in group]), strict=True):
                results[at] = result
        found = iter(results)
        return [tuple([next(found) for _ in steps]) for steps in several]

    def _group(self, steps: Sequence[ir.Step]) -> list[ir.Step]:
        inside = (part for part in parts(steps[0]) if isinstance(part, ir.Step))
        if len(steps) >= LEAST and all(isinstance(step, _ROLLED) for step in inside):
            alike = self.together(steps)
            if len(set(map(_shape, alike))) == 1 and not any(map(_has_table_without_name, parts(alike[0]))):
                return alike
        return [result for step in steps for result in self.together([step])]

    def _with_decision(self, action: Any) -> Any:
        """An action with its condition folded by itself: in each turn it is decided by itself which steps there are."""
        match action:
            case ir.IfElse(condition=Typed()) | ir.WhileLoop(condition=Typed()) | ir.Branch(condition=Typed()):
                name = "condition"
            case ir.Repeat(until=Typed()):
                name = "until"
            case _:  # It has no condition.
                return action
        condition = rewritten(getattr(action, name), self._change)
        return replaced(action, **{name: condition}) if isinstance(condition, LiteralValue) else action


def _with(item: Any, inside: dict[str, Any]) -> Any:
    """The record with other parts; the same one if all parts are the same."""
    changes = {name: new for name, new in inside.items() if not _is_same(getattr(item, name), new)}
    return replaced(item, **changes) if changes else item


def _is_same(old: Any, new: Any) -> bool:
    if isinstance(old, tuple):
        return all(one is other for one, other in zip(old, new, strict=True))
    return old is new


def _shape(item: Any) -> Hashable:
    """What parts have in common that differ only in numbers that may count."""
    match item:
        case str():
            return _INDEX.sub("[]", item) if "[" in item else item
        case tuple():
            return tuple([_shape(part) for part in item])
        case LiteralValue(value=value):
            return LiteralValue, item.type, item.name, "counts" if _is_number(item) else repr(value)
        case ir.PortEnd(port=port, index=int(), end=end):
            return ir.PortEnd, port, end
        case _ if is_record(item):
            names = (name for name in field_names(item) if name not in ("span", "doc"))
            return type(item), tuple([_shape(getattr(item, name)) for name in names])
        case _:  # Nothing that counts.
            return cast("Hashable", item)


def _is_number(expression: Expression) -> bool:
    return isinstance(expression, LiteralValue) and type(expression.value) is int and expression.name is None


def _has_table_without_name(part: object) -> bool:
    """Whether a part is an element of an array that is written out where it is used, in each turn."""
    return isinstance(part, ElementValue) and isinstance(part.operand, LiteralValue) and part.operand.name is None


def _count(before: Sequence[Expression], after: Sequence[Expression]) -> bool:
    """Whether expressions that differ only in numbers that count still do after they have been folded."""
    if len(set(map(_shape, after))) > 1:
        return False
    if isinstance(before[0], VariableValue) and isinstance(before[0].type, ArrayType):
        return after[0] is before[0]  # Its elements may be different in each turn.
    if not _is_number(after[0]) or _is_number(before[0]):
        return True  # It is a part of what it was.
    values = [one.value for one in after if isinstance(one, LiteralValue)]
    if len(set(values)) == 1:
        return True
    given = [
        [one.value for one in operand if isinstance(one, LiteralValue)]
        for operand in zip(*map(operands, before), strict=True)
    ]
    constant = [len(set(numbers)) == 1 for numbers in given]
    match before[0]:
        case BinaryOperation(operator="+" | "-") | UnaryOperation(operator="-"):
            return True
        case BinaryOperation(operator="*") if any(constant):
            return True
        case _:  # Such as the element of a table, which counts if it is its own index.
            whole = [numbers for numbers in given if all(type(number) is int for number in numbers)]
            return any(len(set(map(sub, values, numbers))) == 1 for numbers in whole)
