"""Which branches of an alternative are possible: guards that are always ready, never hold, or are always too late."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import partial

from cspdiag.base.record import record, replaced
from cspdiag.network.elaborate.constant_value import constant_value
from cspdiag.network.infer.contexts import Placed
from cspdiag.network.infer.waiting import constant_in, is_always_ready, known_duration, sample_period
from cspdiag.network.ir.actions import AfterEvent, Branch, Choice, CoreAction, Event, InputEvent, ReadyEvent, Target
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.expressions import Expression, ParameterValue, SignalValue, UnaryOperation, Value, VariableValue
from cspdiag.network.ir.walk import parts
from cspdiag.network.relations import end_key
from cspdiag.network.shapes import Key


@record
class Overtaken:
    """A time-out of ``waits`` nanoseconds that never happens, since the guard ``by`` is ready within ``period``
    nanoseconds: a sample of ``port``, another time-out, or a guard that is always ready.

    ``place`` is the position of the branch in its alternative, since all branches of a replicated one have the same
    span.
    """

    place: int
    waits: int
    by: Branch[CoreAction]
    port: Key | None
    period: int
    has_priority: bool
    """Whether ``by`` precedes it in a prioritized alternative."""


def decided(placed: Placed, condition: Expression | None) -> bool | None:
    """Whether a condition always holds or never does; None if that depends on more than constants."""
    if condition is None:
        return True
    value = constant_in(placed, condition)
    return value if isinstance(value, bool) else None


def decided_by_instance(placed: Placed, condition: Expression) -> set[bool | None]:
    """Whether a condition always holds or never does, for each instance; None if in an instance that depends on more
    than its parameters.

    Empty if a parameter of the condition is not known.
    """
    if not any(isinstance(part, ParameterValue) for part in walk(condition)):
        return {decided(placed, condition)}
    found = {constant_value(condition, partial(_parameter, given)) for given in placed.given}
    return {value if isinstance(value, bool) else None for value in found}


def _parameter(given: Mapping[str, Value], name: ParameterValue | SignalValue) -> Value | None:
    return given.get(name.name)


def overtaken(placed: Placed, choice: Choice[CoreAction]) -> Iterator[Overtaken]:
    """The time-outs of an alternative that never happen, because samples of an input, another time-out, or a guard that
    is always ready come first.
    """
    soonest: tuple[int, int, Key | None] | None = None
    for place, branch in enumerate(choice.branches):
        found = _ready_within(placed, branch) if decided(placed, branch.condition) else None
        if found is not None and (soonest is None or found[0] < soonest[0]):
            soonest = found[0], place, found[1]
    if soonest is None:
        return
    period, first, port = soonest
    for place, branch in enumerate(choice.branches):
        waits = known_duration(placed, branch.event.duration) if isinstance(branch.event, AfterEvent) else 0
        is_behind = choice.prioritized and first < place
        if place != first and (waits > period or (period and waits == period and is_behind)):
            yield Overtaken(place, waits, choice.branches[first], port, period, is_behind)


def _ready_within(placed: Placed, branch: Branch[CoreAction]) -> tuple[int, Key | None] | None:
    """The number of nanoseconds within which a guard is certainly ready, and the input if it waits for a sample; None
    if that is not known.
    """
    event = branch.event
    if is_always_ready(placed, event):
        return 0, None
    if isinstance(event, ReadyEvent | InputEvent):
        key = end_key(event.source)
        period = sample_period(placed, key)
        return (period, key) if period else None
    waits = known_duration(placed, event.duration) if isinstance(event, AfterEvent) else 0
    return (waits, None) if waits else None


def possible_branches(placed: Placed, choice: Choice[CoreAction]) -> tuple[Branch[CoreAction], ...]:
    """The branches that can be chosen."""
    late = {found.place for found in overtaken(placed, choice)}
    possible: list[Branch[CoreAction]] = []
    for place, branch in enumerate(choice.branches):
        holds = decided(placed, branch.condition)
        if holds is False or place in late:
            continue
        possible.append(branch)
        if holds and choice.prioritized and is_always_ready(placed, branch.event):
            break
    return tuple(possible)


def variants_by_sample_condition(placed: Placed, choice: Choice[CoreAction]) -> tuple[Choice[CoreAction], ...]:
    """The cases of an alternative: with the branches that are possible if the condition of its samples holds, and with
    those that are if it does not; only the alternative itself if its samples have no common condition.

    Of the other conditions, those are known to hold in the second case that always hold or that negate the condition.
    There are two cases only if the condition can change both ways: some variable of it is written both in branches with
    samples and in others.
    """
    of_samples = {branch.condition for branch in choice.branches if _is_sample(placed, branch.event)}
    conditions = [condition for condition in of_samples if decided(placed, condition) is None]
    if len(conditions) != 1:
        return (choice,)
    condition = conditions[0]
    assert condition is not None
    holds = [replaced(one, condition=None) if one.condition == condition else one for one in choice.branches]
    others = [
        one for one in choice.branches if decided(placed, one.condition) or _are_contrary(one.condition, condition)
    ]
    ways = [replaced(choice, branches=tuple(holds))]
    changed = _written(one for one in choice.branches if one.condition == condition) & _written(others)
    if not any(isinstance(part, VariableValue) and part.channel in changed for part in walk(condition)):
        return (choice,)
    # If the second case has samples too, or no branches, it adds no waiting to that of the first case.
    if others and not any(_is_sample(placed, one.event) for one in others):
        ways.append(replaced(choice, branches=tuple(others)))
    return tuple(ways)


def _is_sample(placed: Placed, event: Event) -> bool:
    return isinstance(event, ReadyEvent | InputEvent) and bool(sample_period(placed, end_key(event.source)))


def _written(branches: Iterable[Branch[CoreAction]]) -> set[str]:
    """The variables that branches and their guards write."""
    return {part.channel for branch in branches for part in parts(branch) if isinstance(part, Target)}


def _are_contrary(one: Expression | None, other: Expression | None) -> bool:
    return any(
        isinstance(a, UnaryOperation) and a.operator == "not" and a.operand == b
        for a, b in ((one, other), (other, one))
    )
