"""A task that is followed: it goes through the instructions, and asks for what the meaning of the language lets tasks
ask for.
"""

from __future__ import annotations

from typing import Any, Protocol

from cspdiag.network.ir.actions import ProcessScope
from cspdiag.network.ir.expressions import Expression
from cspdiag.optimize.fuse.begin import Surroundings, delay, exchange, selection
from cspdiag.optimize.fuse.code import (
    Close,
    Code,
    Communicate,
    Compute,
    Decide,
    Delay,
    Finish,
    Handler,
    Instruction,
    Jump,
    Raise,
    Scope,
    Select,
    Start,
)
from cspdiag.optimize.fuse.record import Recorder
from cspdiag.semantics.choice import Choose
from cspdiag.semantics.requests import CancelledError, Parallel, Request, Steps, Task, Wait
from cspdiag.semantics.requests import Communicate as Exchange
from cspdiag.semantics.values import RaisedError


class FailureError(RaisedError):
    """An exception of the program, with where it was raised."""

    def __init__(self, instruction: Raise) -> None:
        super().__init__(instruction.action.exception)
        self.instruction = instruction


class FollowedProgram(Surroundings, Protocol):
    """What tasks ask of the program that is followed."""

    code: Code
    record: Recorder

    def holds(self, condition: Expression) -> bool:
        """Whether a condition holds, as far as it is known, or decided."""

    def remember(self) -> None:
        """Stop where the program is in a state for the second time."""

    def close(self, process: ProcessScope) -> None:
        """A process has ended."""


class Walker:
    """A branch of a parallel, or the program; ``position`` is the instruction that it is at."""

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
        """What its future depends on."""
        request = self.task.request
        return (self.key, self.position, self.task.cancelled, None if request is None else request_state(request, now))

    @property
    def _instruction(self) -> Instruction:
        return self._program.code.instructions[self.position]

    def _walk(self) -> Steps:
        try:
            self._end_if_cancelled()
            while not isinstance(self._instruction, Finish):
                try:
                    yield from self._step()
                except FailureError as failure:
                    self._end_if_cancelled()
                    self._handle(failure)
        except CancelledError:
            for item in self._program.code.around[self.position]:
                if isinstance(item, Scope):
                    self._program.close(item.process)
            raise
        finally:
            self._program.record.forget(self.key)

    def _end_if_cancelled(self) -> None:
        """What a task that is cancelled would still compute until its next communication, nobody sees."""
        if self.task.cancelled:
            raise CancelledError

    def _handle(self, failure: FailureError) -> None:
        for item in self._program.code.around[self.position]:
            match item:
                case Scope(process=process):
                    self._program.close(process)
                case Handler(exception=caught, handler=handler) if caught == failure.instruction.action.exception:
                    self.position = handler
                    return
        raise failure

    def _step(self) -> Steps:
        program = self._program
        program.record.count_instruction()
        instruction = self._instruction
        match instruction:
            case Compute(action=action):
                program.record.compute_action(action)
                self.position += 1
            case Decide():
                self._jump(self.position + 1 if program.holds(instruction.condition) else instruction.otherwise)
            case Jump(to=to):
                self._jump(to)
            case Raise():
                raise FailureError(instruction)
            case Close(scope=scope):
                program.close(scope)
                self.position += 1
            case Finish():
                return
            case Start():
                yield from self._asked(Parallel(self._branches(instruction), instruction.prioritized))
                self.position = instruction.after
            case Communicate():
                yield from self._asked(exchange(program, self, instruction))
                self.position += 1
            case Delay():
                yield from self._asked(delay(program, instruction))
                self.position += 1
            case Select():
                index, _ = yield from self._asked(selection(program, self, instruction.choice))
                self.position = instruction.bodies[index]

    def _asked(self, request: Request) -> Steps:
        answer = yield request
        self._end_if_cancelled()
        self._program.record.resumed(self.key)
        return answer

    def _branches(self, start: Start) -> list[Walker]:
        return [
            Walker(self._program, (*self.key, self.position, number), position)
            for number, position in enumerate(start.branches)
        ]

    def _jump(self, to: int) -> None:
        back = to <= self.position
        self.position = to
        if back:
            self._program.remember()


def request_state(request: Request, now: int) -> tuple[object, ...]:
    """What the future depends on of what a task waits for."""
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
            raised = failure.instruction if isinstance(failure, FailureError) else None
            return (request.done, id(raised), request.abandoned, tuple(task.ended for task in request.tasks))
        case _:
            raise AssertionError(request)
