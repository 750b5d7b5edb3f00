"""Loops of computation that terminate: their counter approaches the bound in their condition, or all their values are
known.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import inf
from typing import TypeAlias, assert_never

from cspdiag.analyses.timing.threads.offers import ChannelEnds
from cspdiag.base.record import record
from cspdiag.model.types import IntType, TimeType
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expressions import (
    ArrayElements,
    BinaryOperation,
    ConditionalValue,
    Conversion,
    ElementValue,
    Expression,
    FieldValue,
    FunctionCall,
    LiteralValue,
    ParameterValue,
    PresentTime,
    SignalValue,
    StructValue,
    TunableValue,
    UnaryOperation,
    Value,
    VariableValue,
)
from cspdiag.network.ir.network import CoreClass
from cspdiag.network.ir.walk import parts

Values: TypeAlias = Mapping[str, Value]
"""The known values of the variables of a process, by name; a variable that is not in it may have any value."""

LARGEST_NUMBER_OF_ITERATIONS = 1_000
"""Iterations of loops that are evaluated with their values."""

_NEGATED = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}


@record
class Loop:
    """A loop of the process at ``path``; ``before`` gives the values that are known when it begins."""

    path: str
    action: ir.Repeat[ir.CoreAction] | ir.WhileLoop[ir.CoreAction]
    before: Callable[[], Values]


class _TooManyIterationsError(Exception):
    """More iterations than are evaluated."""


class Termination:
    """Decides whether loops terminate. Only the loop itself changes its variables: parallel parts share none."""

    def __init__(self, ends: ChannelEnds) -> None:
        self._channel_ends = ends

    def initial(self, path: str, entry: CoreClass) -> dict[str, Value]:
        """The values of variables when a process begins for the first time."""
        found = {}
        for channel in entry.channels:
            if channel.initial is not None and self._channel_ends.is_own(path, channel.name):
                value = self._channel_ends.constant(path, channel.initial)
                if value is not None:
                    found[channel.name] = value
        return found

    def ends(self, loop: Loop) -> bool:
        """Whether the loop is certain to end if nothing in it waits forever. A fault ends it, too."""
        return self._approaches_bound(loop) or self._ends_by_evaluation(loop)

    # Evaluation.

    def after(self, path: str, action: ir.CoreAction, values: Values) -> Values:
        """The values that are known after an action has ended."""
        try:
            return self._after(path, action, values, [LARGEST_NUMBER_OF_ITERATIONS])
        except _TooManyIterationsError:
            return without_changed(values, action)

    def before_each(self, path: str, steps: Sequence[ir.CoreAction], values: Values) -> list[Values]:
        """The values that are known before each of several steps."""
        found = [values]
        for step in steps[:-1]:
            found.append(self.after(path, step, found[-1]))
        return found

    def _after(self, path: str, action: ir.CoreAction, values: Values, remaining: list[int]) -> Values:
        match action:
            case ir.AssignValue(target=ir.Target(channel=name, indexes=())) if self._channel_ends.is_own(path, name):
                value = self._value(path, action.value, values)
                return {**without_changed(values, action), **({} if value is None else {name: value})}
            case ir.SequentialSteps(steps=steps):
                for step in steps:
                    values = self._after(path, step, values, remaining)
                return values
            case ir.IfElse():
                decided = self._value(path, action.condition, values)
                if decided is None:
                    one, other = (
                        self._after(path, side, values, remaining) for side in (action.then, action.otherwise)
                    )
                    return {name: value for name, value in one.items() if repr(other.get(name)) == repr(value)}
                return self._after(path, action.then if decided else action.otherwise, values, remaining)
            case ir.Group(body=body):
                return self._after(path, body, values, remaining)
            case ir.Repeat() | ir.WhileLoop():
                return self._after_loop(path, action, values, remaining)
            case ir.CountedLoop(body=body, iterations=iterations):
                for _ in range(iterations):
                    remaining[0] -= 1
                    if remaining[0] < 0:
                        raise _TooManyIterationsError
                    values = self._after(path, body, values, remaining)
                return values
            case (
                ir.RunInstance() | ir.ReadValue() | ir.WriteValue() | ir.AssignValue() | ir.SkipStep() | ir.StopStep()
                | ir.WaitStep() | ir.ResetInstance() | ir.RaiseException() | ir.ParallelSteps() | ir.Choice()
                | ir.CatchException() | ir.InterruptOn()
            ):  # fmt: skip
                return without_changed(values, action)
            case _:
                assert_never(action)

    def _after_loop(
        self,
        path: str,
        loop: ir.Repeat[ir.CoreAction] | ir.WhileLoop[ir.CoreAction],
        values: Values,
        remaining: list[int],
    ) -> Values:
        """The values known after a loop if all its conditions are known; otherwise those that it does not change."""
        initially = values
        if isinstance(loop, ir.Repeat):
            values = self._after(path, loop.body, values, remaining)
        while True:
            continues = self._continues(path, loop, values)
            if continues is None:
                return without_changed(initially, loop)
            if not continues:
                return values
            remaining[0] -= 1
            if remaining[0] < 0:
                raise _TooManyIterationsError
            values = self._after(path, loop.body, values, remaining)

    def _continues(
        self, path: str, loop: ir.Repeat[ir.CoreAction] | ir.WhileLoop[ir.CoreAction], values: Values
    ) -> Value | None:
        if isinstance(loop, ir.WhileLoop):
            return self._value(path, loop.condition, values)
        ends = False if loop.until is None else self._value(path, loop.until, values)
        return None if ends is None else not ends

    def _value(self, path: str, expression: Expression, values: Values) -> Value | None:
        def known(part: object) -> object:
            if isinstance(part, VariableValue) and part.channel in values:
                return LiteralValue(span=part.span, type=part.type, value=values[part.channel])
            return part

        return self._channel_ends.constant(path, rewritten(expression, known))

    def _ends_by_evaluation(self, loop: Loop) -> bool:
        """Whether the loop ends when its iterations are evaluated one after another."""
        remaining = [LARGEST_NUMBER_OF_ITERATIONS]
        values = loop.before()
        try:
            if isinstance(loop.action, ir.Repeat):
                values = self._after(loop.path, loop.action.body, values, remaining)
            while continues := self._continues(loop.path, loop.action, values):
                remaining[0] -= 1
                values = self._after(loop.path, loop.action.body, values, remaining)
                if remaining[0] < 0:
                    return False
        except _TooManyIterationsError:
            return False
        return continues is False

    # Counters.

    def _approaches_bound(self, loop: Loop) -> bool:
        action = loop.action
        condition = action.condition if isinstance(action, ir.WhileLoop) else action.until
        return condition is not None and self._fails_eventually(loop, condition, holds=isinstance(action, ir.WhileLoop))

    def _fails_eventually(self, loop: Loop, condition: Expression, *, holds: bool) -> bool:
        """Whether a condition becomes false and then stays false; with ``holds`` False, whether it becomes true."""
        match condition:
            case UnaryOperation(operator="not", operand=operand):
                return self._fails_eventually(loop, operand, holds=not holds)
            case BinaryOperation(operator="and" | "or" as operator, left=left, right=right):
                sides = (self._fails_eventually(loop, side, holds=holds) for side in (left, right))
                return any(sides) if (operator == "and") == holds else all(sides)
            case BinaryOperation(operator="<" | "<=" | ">" | ">=" as operator, left=left, right=right):
                if not isinstance(left.type, IntType | TimeType):
                    return False
                is_less = (operator if holds else _NEGATED[operator]) in ("<", "<=")
                low, high = (left, right) if is_less else (right, left)
                return self._least_increase(loop, low, 1) + self._least_increase(loop, high, -1) > 0
            case (
                LiteralValue() | ParameterValue() | TunableValue() | VariableValue() | SignalValue() | PresentTime()
                | UnaryOperation() | BinaryOperation() | ConditionalValue() | FunctionCall() | Conversion()
                | FieldValue() | ElementValue() | StructValue() | ArrayElements()
            ):  # fmt: skip
                return False
            case _:
                assert_never(condition)

    def _least_increase(self, loop: Loop, expression: Expression, sign: int) -> float:
        """By how much at least ``sign`` times the expression increases in each iteration."""
        if any(isinstance(part, TunableValue) for part in parts(expression)):
            # A change of a parameter may move a bound away from what approaches it.
            return -inf
        if not any(isinstance(part, VariableValue) for part in parts(expression)):
            return 0
        match expression:
            case VariableValue(channel=name):
                return self._least_increase_of(loop.path, loop.action.body, name, sign)
            case UnaryOperation(operator="-", operand=operand):
                return self._least_increase(loop, operand, -sign)
            case BinaryOperation(operator="+" | "-" as operator, left=left, right=right):
                return self._least_increase(loop, left, sign) + self._least_increase(
                    loop, right, sign if operator == "+" else -sign
                )
            case (
                LiteralValue() | ParameterValue() | TunableValue() | SignalValue() | PresentTime() | UnaryOperation()
                | BinaryOperation() | ConditionalValue() | FunctionCall() | Conversion() | FieldValue()
                | ElementValue() | StructValue() | ArrayElements()
            ):  # fmt: skip
                names = {part.channel for part in parts(expression) if isinstance(part, VariableValue)}
                others = any(not self._channel_ends.is_own(loop.path, name) for name in names)
                return -inf if names & written(loop.action.body) or others else 0
            case _:
                assert_never(expression)

    def _least_increase_of(self, path: str, action: ir.CoreAction, name: str, sign: int) -> float:
        """By how much at least ``sign`` times a variable increases during an action; infinite if the action
        never ends.
        """

        def of(inner: ir.CoreAction) -> float:
            return self._least_increase_of(path, inner, name, sign)

        if not self._channel_ends.is_own(path, name):
            return -inf
        match action:
            case ir.StopStep() | ir.RaiseException():
                return inf
            case ir.AssignValue(target=ir.Target(channel=channel, indexes=())) if channel == name:
                return self._added(path, action.value, name, sign)
            case ir.SequentialSteps(steps=steps) | ir.ParallelSteps(steps=steps):
                rises = [of(step) for step in steps]
                return inf if inf in rises else sum(rises)
            case ir.IfElse(then=then, otherwise=otherwise):
                return min(of(then), of(otherwise))
            case ir.Choice(branches=branches):
                return min(-inf if name in written(branch.event) else of(branch.body) for branch in branches)
            case ir.Group(body=body):
                return of(body)
            case ir.Repeat(body=body):
                return of(body) if of(body) >= 0 else -inf
            case ir.CountedLoop(body=body, iterations=iterations):
                return iterations * of(body)
            case ir.WhileLoop(body=body):
                return 0 if of(body) >= 0 else -inf
            case ir.CatchException(body=body, handler=handler):
                return min(of(body), self._least_increase_if_left(path, body, name, sign) + of(handler))
            case ir.InterruptOn(body=body, branch=branch):
                if name in written(branch.event):
                    return -inf
                return min(of(body), self._least_increase_if_left(path, body, name, sign) + of(branch.body))
            case (
                ir.RunInstance() | ir.ReadValue() | ir.WriteValue() | ir.AssignValue() | ir.SkipStep() | ir.WaitStep()
                | ir.ResetInstance() | ir.ReadInputs() | ir.WriteOutputs() | ir.RunLaw() | ir.ResetStates()
                | ir.ProcessScope() | ir.ReportCommunication()
            ):  # fmt: skip
                return -inf if name in written(action) else 0
            case _:
                assert_never(action)

    def _least_increase_if_left(self, path: str, action: ir.CoreAction, name: str, sign: int) -> float:
        """The least increase of a variable where an action is left before its end: 0 if no step of it decreases the
        variable.
        """
        for part in parts(action):
            match part:
                case ir.AssignValue(target=ir.Target(channel=channel, indexes=()), value=value) if channel == name:
                    if self._added(path, value, name, sign) < 0:
                        return -inf
                case ir.AssignValue(target=target) | ir.ReadValue(target=target) | ir.InputEvent(target=target):
                    if target.channel == name:
                        return -inf
                case _:
                    pass  # No other action assigns a variable.
        return 0

    def _added(self, path: str, value: Expression, name: str, sign: int) -> float:
        """What ``name := value`` adds to the variable, times ``sign``; minus infinity where it is unknown."""
        match value:
            case VariableValue(channel=channel) if channel == name:
                return 0
            case BinaryOperation(operator="+", left=VariableValue(channel=channel), right=added) if channel == name:
                return self._number(path, added, sign)
            case BinaryOperation(operator="+", left=added, right=VariableValue(channel=channel)) if channel == name:
                return self._number(path, added, sign)
            case BinaryOperation(operator="-", left=VariableValue(channel=channel), right=added) if channel == name:
                return self._number(path, added, -sign)
        return -inf

    def _number(self, path: str, expression: Expression, sign: int) -> float:
        known = self._channel_ends.constant(path, expression)
        return sign * known if isinstance(known, int) and not isinstance(known, bool) else -inf


def written(*actions: ir.CoreAction | ir.Event) -> set[str]:
    """The variables of a process that actions, or events of guards, may change."""
    return {part.channel for part in parts(actions) if isinstance(part, ir.Target)}


def without_changed(values: Values, *actions: ir.CoreAction | ir.Event) -> Values:
    """The values that remain known after actions of which only a part may have been executed."""
    changed = written(*actions)
    return {name: value for name, value in values.items() if name not in changed}
