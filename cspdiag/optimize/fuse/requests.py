"""The requests that tasks make to the scheduler, built from the instructions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol, assert_never

from cspdiag.network.flow.code import Communication
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Expression, LiteralValue
from cspdiag.optimize.constants.folding import is_literal
from cspdiag.optimize.fuse.code import NotStaticError
from cspdiag.optimize.fuse.media import Medium, Offer, Place
from cspdiag.semantics.choice import Choose
from cspdiag.semantics.media import EndKey
from cspdiag.semantics.requests import Communicate, Wait


class RequestContext(Protocol):
    """What an instruction needs from the program to build its request."""

    now: int

    def medium_of(self, end: ir.End) -> Medium:
        """The medium of an end. Raises NotStaticError if that is an input without a period."""

    def key_of(self, end: ir.End) -> EndKey:
        """The end as one of the process that it belongs to."""

    def alternative(self, name: str, *, prioritized: bool) -> Choose:
        """An alternative without guards."""

    def folded(self, expression: Expression) -> Expression:
        """The expression, or its value if that is known."""

    def compute_in_advance(self, offer: Offer) -> None:
        """Compute the value of one of several offers before any of them is made."""


def exchange(program: RequestContext, place: Place, step: Communication) -> Communicate:
    """The offers of all readers and writers in a step; if there are several, each value is computed before any is
    offered.
    """
    request = Communicate()
    ends = list(_ends(step))
    for number, (end, target, value) in enumerate(ends):
        offer = Offer(
            request=request,
            medium=program.medium_of(end),
            end=program.key_of(end),
            writes=value is not None,
            value=value,
            place=place,
            source=end,
            number=number,
            span=step.span,
            target=target,
        )
        request.offers.append(offer)
        if offer.writes and len(ends) > 1:
            program.compute_in_advance(offer)
    return request


def _ends(step: Communication) -> Iterator[tuple[ir.End, ir.Target | None, Expression | None]]:
    match step:
        case ir.ReadValue():
            yield step.source, step.target, None
        case ir.WriteValue():
            yield step.sink, None, step.value
        case ir.ReadInputs():
            yield from ((read.source, ir.Target(read.name), None) for read in step.reads)
        case ir.WriteOutputs():
            yield from ((write.sink, None, write.value) for write in step.writes)
        case _:
            assert_never(step)


def delay(program: RequestContext, duration: Expression | None) -> Wait:
    """A delay; None: forever. Raises NotStaticError if its length is not known."""
    return Wait(None if duration is None else _time(program, duration))


def _time(program: RequestContext, duration: Expression) -> int:
    value = program.folded(duration)
    if not isinstance(value, LiteralValue) or not isinstance(value.value, int):
        raise NotStaticError("the length of a delay is not known", duration.span)
    return value.value


def selection(program: RequestContext, place: Place, choice: ir.Choice) -> Choose:
    """The guards that are enabled. Raises NotStaticError if that is not known."""
    request = program.alternative(choice.name, prioritized=choice.prioritized)
    for index, branch in enumerate(choice.branches):
        if branch.condition is not None:
            condition = program.folded(branch.condition)
            if is_literal(condition, False):
                continue
            if not is_literal(condition, True):
                raise NotStaticError("whether a guard is enabled is not known", branch.span)
        event = branch.event
        match event:
            case ir.SkipEvent():
                request.always.add(index)
            case ir.AfterEvent():
                request.timeouts[index] = program.now + _time(program, event.duration)
            case ir.OutputEvent() | ir.InputEvent() | ir.ReadyEvent():
                request.offers[index] = _guard(program, place, request, index, event)
    return request


def _guard(
    program: RequestContext,
    place: Place,
    request: Choose,
    index: int,
    event: ir.OutputEvent | ir.InputEvent | ir.ReadyEvent,
) -> Offer:
    end = event.sink if isinstance(event, ir.OutputEvent) else event.source
    offer = Offer(
        request=request,
        medium=program.medium_of(end),
        end=program.key_of(end),
        writes=isinstance(event, ir.OutputEvent),
        value=event.value if isinstance(event, ir.OutputEvent) else None,
        guard=index,
        only_ready=isinstance(event, ir.ReadyEvent),
        place=place,
        source=end,
        number=index,
        span=event.span,
        target=event.target if isinstance(event, ir.InputEvent) else None,
    )
    if offer.writes:
        program.compute_in_advance(offer)
    return offer
