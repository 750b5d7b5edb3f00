"""Which communications may wait in a context, for the checks of guards and loops."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache, partial
from typing import assert_never

from cspdiag.model.sampling import Sampling
from cspdiag.model.types import IntType, TimeType
from cspdiag.network.elaborate.constant_value import constant_value
from cspdiag.network.flow import waiting
from cspdiag.network.infer.contexts import Placed, port_facts
from cspdiag.network.ir.actions import (
    AfterEvent,
    AssignValue,
    CatchException,
    Choice,
    CoreAction,
    CountedLoop,
    Event,
    Group,
    IfElse,
    InterruptOn,
    ParallelSteps,
    RaiseException,
    ReadValue,
    Repeat,
    ResetInstance,
    RunInstance,
    SequentialSteps,
    SkipEvent,
    SkipStep,
    StopStep,
    WaitStep,
    WhileLoop,
    WriteValue,
)
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.expressions import BinaryOperation, Expression, FunctionCall, ParameterValue, Value
from cspdiag.network.ir.ranges import ExpressionInput, Range, needs_check, of_instances, value_range
from cspdiag.network.ir.walk import all_actions, may_change
from cspdiag.network.relations import end_key
from cspdiag.network.shapes import UNKNOWN_SAMPLING, InstanceShape, Key, attached_key
from cspdiag.syntax import ast


def read_may_wait(placed: Placed, key: Key) -> bool:
    """Whether reading a port or channel may have to wait for a value."""
    return placed.facts[key][0] not in waiting.READ_AT_ONCE


def write_may_wait(placed: Placed, key: Key) -> bool:
    """Whether writing a port or channel may have to wait for a reader."""
    return placed.facts[key][0] not in waiting.WRITTEN_AT_ONCE


def is_open(placed: Placed, key: Key) -> bool:
    """Whether nothing is known about what is behind a port or channel."""
    return placed.facts[key][0] == "open"


def samples_of(placed: Placed, key: Key) -> Sampling | None:
    """The sample instants of a sampled input; None for other inputs, or if they are not known."""
    kind, sampling = placed.facts[key]
    return sampling if kind == "sampled" and sampling != UNKNOWN_SAMPLING else None


def sample_period(placed: Placed, key: Key) -> int:
    """The period of a sampled input in nanoseconds; 0 for other inputs, or if it is not known."""
    sampling = samples_of(placed, key)
    return 0 if sampling is None else sampling.period


def constant_in(placed: Placed, expression: Expression) -> Value | None:
    """The value of an expression of constants and parameters of a process; None if it depends on anything else."""
    values = {node.name.text: value for node, value in placed.shape.values.items() if isinstance(node, ast.Parameter)}
    return constant_value(expression, lambda name: values.get(name.name))


def known_duration(placed: Placed, expression: Expression) -> int:
    """The duration of a delay in nanoseconds; 0 if it is not known here."""
    value = constant_in(placed, expression)
    return value if isinstance(value, int) and value > 0 else 0


def is_over_at_once(placed: Placed, duration: Expression) -> bool:
    """Whether a delay takes no time in any instance, because its duration is zero or negative and computing it cannot
    fault. A negative constant has been refused already.
    """

    def known(name: ExpressionInput) -> Range | None:
        return placed.parameters.get(name.name) if isinstance(name, ParameterValue) else of_instances(name)

    constant = constant_value(duration, lambda _: None)
    if isinstance(constant, int):
        return constant == 0
    found = constant_in(placed, duration)
    if isinstance(found, int):
        return found <= 0
    is_faultless = not any(_may_fault(part, known) for part in walk(duration))
    return is_faultless and value_range(duration, known)[1] <= 0


def _may_fault(part: Expression, known: Callable[[ExpressionInput], Range | None]) -> bool:
    """Whether an operation on whole numbers or times may overflow or divide by zero."""
    if not isinstance(part.type, IntType | TimeType):
        return False
    if isinstance(part, BinaryOperation) and part.operator in {"/", "%"}:
        low, high = value_range(part.right, known)
        if low <= 0 <= high:
            return True
    return needs_check(part, known)


def is_one_instant(duration: Expression) -> bool:
    """Whether a delay lasts until an instant that is always the same: it lets time pass once, and never again."""
    match duration:
        case FunctionCall(function="until", arguments=(instant, _)):
            return not may_change(instant)
        case _:  # Any other duration is counted from where it begins.
            return False


def is_always_ready(placed: Placed, event: Event) -> bool:
    """Whether a guard is ready whenever its condition holds."""
    return waiting.is_always_ready(event, lambda end: placed.facts[end_key(end)][0], partial(is_over_at_once, placed))


def inputs_of(instance: InstanceShape) -> Iterator[Key | None]:
    """The port or channel that each input of an instance is attached to."""
    for element, attached in instance.attachments.items():
        if instance.shape.ports[element[0]].direction == "in":
            yield attached_key(attached)


class MayWait:
    """Whether each run of a process in a context may wait somewhere, however often it has run before. The contexts of
    instances must come first.
    """

    def __init__(self) -> None:
        self._known: dict[Placed, bool] = {}

    def process(self, placed: Placed) -> bool:
        """Whether a run of the process waits or may wait."""
        known = self._known.get(placed)
        if known is None:
            body = placed.shape.body
            known = self._known[placed] = body is None or self.action(placed, body)
        return known

    def action(self, placed: Placed, action: CoreAction) -> bool:
        """Whether a run of the action waits or may wait: False only if it certainly can run without waiting, whatever
        conditions decide.
        """
        match action:
            case RunInstance():
                return self._run(placed, placed.shape.instances[action.instance])
            case ReadValue():
                return read_may_wait(placed, end_key(action.source))
            case WriteValue():
                return write_may_wait(placed, end_key(action.sink))
            case WaitStep():
                return not self._is_over(placed, action.duration)
            case StopStep() | RaiseException():
                return True
            case AssignValue() | SkipStep() | ResetInstance():
                return False
            case SequentialSteps() | ParallelSteps():
                return any(self.action(placed, step) for step in action.steps)
            case Choice():
                return self._choice(placed, action)
            case Repeat() | WhileLoop() | CountedLoop() | Group():
                return self.action(placed, action.body)
            case IfElse():
                return self.action(placed, action.then) or self.action(placed, action.otherwise)
            case CatchException():
                return self.action(placed, action.body)
            case InterruptOn():
                return self._interrupt(placed, action)
            case _:
                assert_never(action)

    def _choice(self, placed: Placed, choice: Choice[CoreAction]) -> bool:
        """Whether an alternative may wait. One with a branch ``skip -> P`` may take it forever; with other guards that
        are always ready, the other branches are taken in turn.
        """
        branches = choice.branches

        @cache
        def waits(position: int) -> bool:
            # Once for each branch: alternatives inside each other would double the work with each level.
            return self.action(placed, branches[position].body)

        free = [position for position, branch in enumerate(branches) if branch.condition is None]
        if any(isinstance(branches[position].event, SkipEvent) and not waits(position) for position in free):
            return False
        if any(self._is_ready(placed, branches[position].event) for position in free):
            return any(map(waits, range(len(branches))))
        return True

    def _interrupt(self, placed: Placed, interrupt: InterruptOn[CoreAction]) -> bool:
        """Whether an interrupt may wait: a guard that is always ready cancels the body before it waits, unless the body
        fails before that.
        """
        branch = interrupt.branch
        is_cancelled = branch.condition is None and self._is_ready(placed, branch.event)
        if not is_cancelled or self._may_raise(placed, interrupt.body):
            return self.action(placed, interrupt.body)
        return self.action(placed, branch.body)

    def _is_over(self, placed: Placed, duration: Expression) -> bool:
        return is_over_at_once(placed, duration) or is_one_instant(duration)

    def _is_ready(self, placed: Placed, event: Event) -> bool:
        return is_always_ready(placed, event) or (isinstance(event, AfterEvent) and is_one_instant(event.duration))

    def _may_raise(self, placed: Placed, action: CoreAction) -> bool:
        """Whether an exception of the program may end an action."""
        instances = placed.shape.instances
        return any(
            isinstance(part, RaiseException)
            or (isinstance(part, RunInstance) and not instances[part.instance].shape.is_submodel)
            for part in all_actions(action)
        )

    def _run(self, placed: Placed, instance: InstanceShape) -> bool:
        if not instance.shape.is_submodel:
            return self.process(placed.inside[instance.name])
        facts = port_facts(placed.facts, instance)
        return any(
            facts[key][0] not in (waiting.READ_AT_ONCE if port.direction == "in" else waiting.WRITTEN_AT_ONCE)
            for port, _, key in instance.shape.port_elements()
        )
