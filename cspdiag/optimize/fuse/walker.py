"""A task in symbolic execution: it proceeds through the instructions and makes the requests that the
semantics defines.
"""

from __future__ import annotations

from typing import Any, Protocol, assert_never

from cspdiag.base.record import replaced
from cspdiag.network.flow.code import (
    Abandon,
    Call,
    Communicate,
    Compute,
    Delay,
    Enter,
    Fork,
    Instruction,
    IterationEnd,
    Join,
    Leave,
    Loop,
    Merge,
    ProcessEnd,
    Raise,
    Resume,
    Select,
    Stop,
    Take,
    Test,
    Unwatch,
    Watch,
)
from cspdiag.network.ir.actions import CatchException, ProcessScope, SkipStep
from cspdiag.network.ir.expressions import Expression
from cspdiag.optimize.fuse.code import Code, Failure
from cspdiag.optimize.fuse.record import Recorder
from cspdiag.optimize.fuse.requests import RequestContext, delay, exchange, selection
from cspdiag.semantics.choice import Choose
from cspdiag.semantics.requests import CancelledError, Parallel, Request, Steps, Task, Wait
from cspdiag.semantics.requests import Communicate as Exchange
from cspdiag.semantics.values import RaisedError


class FailureError(RaisedError):
    """An exception of the program, with the place where it was raised."""

    def __init__(self, failure: Failure) -> None:
        super().__init__(failure.action.exception)
        self.failure = failure


class FollowedProgram(RequestContext, Protocol):
    """What tasks need from the program that is executed."""

    code: Code
    record: Recorder

    def holds(self, condition: Expression) -> bool:
        """Whether a condition holds, by its value if it is known, otherwise by the next decision."""

    def remember(self) -> None:
        """Stop if the program has been in this state before."""

    def close(self, process: ProcessScope) -> None:
        """A process has ended."""


class Walker:
    """The outermost process, or a branch of a parallel; ``position`` is its current instruction."""

    task: Task

    def __init__(self, program: FollowedProgram, key: tuple[int, ...], position: int) -> None:
        self.key = key
        self.position = position
        self._program = program
        self._steps = self._walk()

    def send(self, answer: Any, /) -> Request:
        """See ``Run.send``."""
        return self._steps.send(answer)

    def throw(self, error: RaisedError, /) -> Request:
        """See ``Run.throw``."""
        return self._steps.throw(error)

    def state(self, now: int) -> tuple[object, ...]:
        """The part of the state on which its future depends."""
        request = self.task.request
        return (self.key, self.position, self.task.cancelled, None if request is None else request_state(request, now))

    @property
    def _instruction(self) -> Instruction:
        return self._program.code.instructions[self.position]

    def _walk(self) -> Steps:
        try:
            self._end_if_cancelled()
            while not isinstance(self._instruction, Join | ProcessEnd):
                try:
                    yield from self._step()
                except FailureError as failure:
                    self._end_if_cancelled()
                    self._handle(failure)
        except CancelledError:
            self._leave(None)
            raise
        finally:
            self._program.record.forget(self.key)

    def _end_if_cancelled(self) -> None:
        """End a cancelled task immediately: what it would compute until its next communication cannot be observed."""
        if self.task.cancelled:
            raise CancelledError

    def _handle(self, failure: FailureError) -> None:
        if not self._leave(failure.failure.action.exception):
            raise failure

    def _leave(self, exception: str | None) -> bool:
        """Close the processes around, up to the handler of an exception; whether there is such a handler."""
        code = self._program.code
        for place in code.around[self.position]:
            match code.instructions[place]:
                case Enter(step=process):
                    self._close(process)
                case Abandon(step=CatchException(exception=caught)) if caught == exception:
                    self.position = place
                    return True
                case _:  # It catches another one.
                    pass
        return False

    def _close(self, process: ProcessScope) -> None:
        self._program.close(replaced(process, body=SkipStep(span=process.span)))

    def _step(self) -> Steps:
        program = self._program
        code = program.code
        program.record.count_instruction()
        if self.position in code.computations:
            action, after = code.computations[self.position]
            program.record.compute_action(action)
            self._go(after)
            return
        instruction = self._instruction
        successor = 0
        match instruction:
            case Compute(step=step):
                if not isinstance(step, SkipStep):
                    program.record.compute_action(step)
            case Communicate(step=step):
                if code.is_done_at_once(step):
                    program.record.compute_action(step)
                else:
                    yield from self._answer_to(exchange(program, self, step))
            case Delay(step=step):
                yield from self._answer_to(delay(program, step.duration))
            case Stop():
                yield from self._answer_to(delay(program, None))
            case Select(step=step):
                successor, _ = yield from self._answer_to(selection(program, self, step))
            case Test():
                successor = 0 if program.holds(instruction.condition) else 1
            case Fork(step=step):
                yield from self._answer_to(Parallel(self._branches(), step.prioritized))
                self._go(code.after[code.joins[self.position]][0])
                return
            case Raise():
                raise FailureError(code.failures[self.position])
            case Leave(step=process):
                self._close(process)
            case Loop() | Take() | Merge() | Enter() | Watch() | Unwatch() | Abandon() | Resume():
                pass
            case Call() | IterationEnd() | Join() | ProcessEnd():
                raise AssertionError(instruction)
            case _:
                assert_never(instruction)
        self._go(code.after[self.position][successor])

    def _answer_to(self, request: Request) -> Steps:
        answer = yield request
        self._end_if_cancelled()
        self._program.record.resumed(self.key)
        return answer

    def _branches(self) -> list[Walker]:
        return [
            Walker(self._program, (*self.key, self.position, number), first)
            for number, first in enumerate(self._program.code.after[self.position])
        ]

    def _go(self, to: int) -> None:
        back = to <= self.position
        self.position = to
        if back:
            self._program.remember()


def request_state(request: Request, now: int) -> tuple[object, ...]:
    """The part of a request on which the future depends."""
    match request:
        case Exchange(offers=offers):
            return (request.done, *(offer.done for offer in offers))
        case Choose(offers=guards):
            timeouts = tuple((index, deadline - now) for index, deadline in request.timeouts.items())
            done = tuple(offer.done for offer in guards.values())
            always = tuple(sorted(request.always))
            return (request.done, request.chosen, request.parked, timeouts, tuple(guards), done, always)
        case Wait(duration=duration):
            return (request.done, None if duration is None else request.until - now)
        case Parallel(failure=failure):
            raised = failure.failure if isinstance(failure, FailureError) else None
            return (request.done, id(raised), request.abandoned, tuple(task.ended for task in request.tasks))
        case _:
            raise AssertionError(request)
