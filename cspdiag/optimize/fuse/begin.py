"""What tasks wait for, made from the instructions that ask for it."""

from __future__ import annotations

from typing import Protocol

from cspdiag.network.ir.actions import AfterEvent, Choice, End, InputEvent, OutputEvent, ReadyEvent, SkipEvent
from cspdiag.network.ir.expressions import Expression, LiteralValue
from cspdiag.optimize.folding import is_literal
from cspdiag.optimize.fuse.code import Communicate, Delay, NotStaticError
from cspdiag.optimize.fuse.media import Medium, Offer
from cspdiag.optimize.fuse.requests import Exchange, Selection
from cspdiag.optimize.fuse.tasks import Task, TaskScheduler, Waiting


class FollowedProgram(TaskScheduler, Protocol):
    """What is asked of the program that is followed, where an instruction is begun."""

    def medium_of(self, end: End) -> Medium:
        """What an end belongs to. Raises NotStaticError where that is an input without a period."""

    def folded(self, expression: Expression) -> Expression:
        """The expression, or its value where that is known."""

    def compute_beside(self, offer: Offer) -> None:
        """The value of one of several offers is computed before any of them is made."""


def exchange(world: FollowedProgram, task: Task, instruction: Communicate) -> Exchange:
    """Readers and writers; of several values, each is computed before any is offered."""
    request = Exchange(world, task)
    for end, target in instruction.reads:
        number = len(request.offers)
        request.offers.append(Offer(request, world.medium_of(end), end, number, instruction.span, target=target))
    several = len(instruction.writes) > 1
    for end, value in instruction.writes:
        number = len(request.offers)
        offer = Offer(request, world.medium_of(end), end, number, instruction.span, value=value)
        request.offers.append(offer)
        if several:
            world.compute_beside(offer)
    return request


def delay(world: FollowedProgram, task: Task, instruction: Delay) -> Waiting:
    """A delay. Raises NotStaticError where its length is not known."""
    if instruction.duration is None:
        return Waiting(world, task, None)
    return Waiting(world, task, max(0, _time(world, instruction.duration)))


def _time(world: FollowedProgram, duration: Expression) -> int:
    value = world.folded(duration)
    if not isinstance(value, LiteralValue) or not isinstance(value.value, int):
        raise NotStaticError("the length of a delay is not known", duration.span)
    return value.value


def selection(world: FollowedProgram, task: Task, choice: Choice) -> Selection:
    """The guards that are enabled. Raises NotStaticError where that is not known."""
    request = Selection(world, task, choice.name, choice.prioritized)
    for index, branch in enumerate(choice.branches):
        if branch.condition is not None:
            condition = world.folded(branch.condition)
            if is_literal(condition, False):
                continue
            if not is_literal(condition, True):
                raise NotStaticError("whether a guard is enabled is not known", branch.span)
        event = branch.event
        match event:
            case SkipEvent():
                request.always.add(index)
            case AfterEvent():
                request.timeouts[index] = world.now + _time(world, event.duration)
            case OutputEvent():
                offer = Offer(request, world.medium_of(event.sink), event.sink, index, event.span)
                offer.value, offer.guard = event.value, index
                world.compute_beside(offer)
                request.offers[index] = offer
            case InputEvent() | ReadyEvent():
                offer = Offer(request, world.medium_of(event.source), event.source, index, event.span)
                offer.guard, offer.only_ready = index, isinstance(event, ReadyEvent)
                offer.target = event.target if isinstance(event, InputEvent) else None
                request.offers[index] = offer
    return request
