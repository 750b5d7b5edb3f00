"""A composition as a list of instructions, for following at compile time what all processes of a program do.

An instruction is what a process does between two points at which it could stop: a computation, a communication, a
delay, an alternative, or a decision where to go on. What only computes is one instruction, however large; outputs to
the environment never wait, and count as computing.
"""

from __future__ import annotations

from collections.abc import Container
from typing import TypeAlias, assert_never

from cspdiag.base import Span
from cspdiag.base.record import record, replaced
from cspdiag.network.flow.waiting import WRITTEN_AT_ONCE
from cspdiag.network.ir.actions import (
    Action,
    AssignValue,
    CatchException,
    ChannelEnd,
    Choice,
    CountedLoop,
    End,
    Group,
    IfElse,
    InputRead,
    InterruptOn,
    ParallelSteps,
    ProcessScope,
    RaiseException,
    ReadInputs,
    ReadValue,
    Repeat,
    ReportCommunication,
    ResetInstance,
    ResetStates,
    RunInstance,
    RunLaw,
    SequentialSteps,
    SkipStep,
    StopStep,
    Target,
    WaitStep,
    WhileLoop,
    WriteOutputs,
    WriteValue,
)
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import MediumKind, ProcessClass

MOST_TURNS = 1_000
"""A loop of more turns that communicate stays one."""


class NotStaticError(Exception):
    """The order of communications cannot be told at compile time; the text says why."""

    def __init__(self, reason: str, span: Span | None = None) -> None:
        super().__init__(reason if span is None else f"{reason} ({span})")


@record(eq=False)
class Compute:
    """Anything without waiting."""

    action: Action


@record(eq=False)
class Communicate:
    """Reads or writes, begun all at once."""

    reads: tuple[tuple[End, Target], ...]
    writes: tuple[tuple[End, Expression], ...]
    span: Span


@record(eq=False)
class Delay:
    """Waits for a time; None: for ever."""

    duration: Expression | None
    span: Span


@record(eq=False)
class Select:
    """An alternative; branch n goes on at ``bodies[n]``."""

    choice: Choice
    bodies: tuple[int, ...]


@record(eq=False)
class Decide:
    """Goes on with the next instruction where the condition holds, else at ``otherwise``."""

    condition: Expression
    otherwise: int
    span: Span


@record(eq=False)
class Jump:
    """Goes on elsewhere."""

    to: int


@record(eq=False)
class Start:
    """A parallel, whose branches begin at these instructions; then it goes on at ``after``."""

    branches: tuple[int, ...]
    prioritized: bool
    after: int


@record(eq=False)
class Raise:
    """Raises an exception in a process, None for the outermost."""

    action: RaiseException
    process: ProcessScope | None


@record(eq=False)
class Close:
    """A process has ended; ``scope`` is it, without what it did."""

    scope: ProcessScope


@record(eq=False)
class Finish:
    """The end of a branch, or of the program."""


Instruction: TypeAlias = Compute | Communicate | Delay | Select | Decide | Jump | Start | Raise | Close | Finish


@record
class Handler:
    """A ``catch`` around an instruction."""

    exception: str
    handler: int


@record
class Scope:
    """A process around an instruction, without what it does."""

    process: ProcessScope


Around: TypeAlias = tuple[Handler | Scope, ...]
"""What is around an instruction within its task, innermost first."""


class Code:
    """The instructions of a process class whose composition runs no instances any more.

    ``whole`` are the conditions and loops that may be computed as a whole; None: all that only compute.
    """

    def __init__(self, entry: ProcessClass, whole: Container[Action] | None = None) -> None:
        assert entry.body is not None
        self.entry = entry
        self._whole = whole
        self.instructions: list[Instruction] = []
        self.around: list[Around] = []
        self.kinds: dict[str, MediumKind] = {channel.name: channel.kind for channel in entry.channels}
        self._process: ProcessScope | None = None
        self._media = {port.name: port.media for port in entry.ports}
        self._add_action(entry.body, ())
        self._add(Finish(), ())

    def medium(self, end: End) -> MediumKind:
        """What an end belongs to."""
        if isinstance(end, ChannelEnd):
            return self.kinds[end.channel]
        media = self._media[end.port]
        if not media:
            raise NotStaticError("classes are not specialized")
        return media[end.index or 0].kind

    def _add(self, instruction: Instruction, around: Around) -> int:
        self.instructions.append(instruction)
        self.around.append(around)
        return len(self.instructions) - 1

    @property
    def _next(self) -> int:
        return len(self.instructions)

    def _add_action(self, action: Action, around: Around) -> None:
        if not isinstance(action, SequentialSteps | Group) and self.computes(action):
            if not isinstance(action, SkipStep):
                self._add(Compute(action), around)
            return
        match action:
            case SequentialSteps(steps=steps):
                for step in steps:
                    self._add_action(step, around)
            case Group(body=body):
                self._add_action(body, around)
            case ReadValue(source=source, target=target):
                self._add(Communicate(((source, target),), (), action.span), around)
            case WriteValue(sink=sink, value=value):
                self._add(Communicate((), ((sink, value),), action.span), around)
            case ReadInputs(reads=reads):
                self._add(Communicate(tuple(map(_target, reads)), (), action.span), around)
            case WriteOutputs(writes=writes):
                pairs = tuple((write.sink, write.value) for write in writes)
                self._add(Communicate((), pairs, action.span), around)
            case WaitStep(duration=duration):
                self._add(Delay(duration, action.span), around)
            case StopStep():
                self._add(Delay(None, action.span), around)
            case RaiseException():
                self._add(Raise(action, self._process), around)
            case ProcessScope(body=body):
                process = replaced(action, body=SkipStep(span=action.span))
                outer, self._process = self._process, process
                self._add_action(body, (Scope(process), *around))
                self._process = outer
                self._add(Close(process), around)
            case IfElse() | WhileLoop() | Repeat():
                self._add_decision(action, around)
            case CountedLoop():
                self._add_turns(action, around)
            case Choice():
                self._add_choice(action, around)
            case ParallelSteps():
                self._add_parallel(action, around)
            case CatchException():
                self._add_catch(action, around)
            case InterruptOn():
                raise NotStaticError("an interrupt may come at any time", action.span)
            case RunInstance() | ResetInstance():
                raise NotStaticError(f"{action.instance} is a process or control law of its own", action.span)
            case _:
                raise NotStaticError("a step without an order", action.span)

    def _add_decision(self, action: IfElse | WhileLoop | Repeat, around: Around) -> None:
        start = self._next
        match action:
            case IfElse():
                decision = self._add(Jump(0), around)
                self._add_action(action.then, around)
                leave = self._add(Jump(0), around)
                self.instructions[decision] = Decide(action.condition, self._next, action.span)
                self._add_action(action.otherwise, around)
                self.instructions[leave] = Jump(self._next)
            case WhileLoop():
                self._add(Jump(0), around)
                self._add_action(action.body, around)
                self._add(Jump(start), around)
                self.instructions[start] = Decide(action.condition, self._next, action.span)
            case Repeat(until=None):
                self._add_action(action.body, around)
                self._add(Jump(start), around)
            case Repeat(until=until):
                assert until is not None
                self._add_action(action.body, around)
                self._add(Decide(until, start, action.span), around)

    def _add_turns(self, loop: CountedLoop, around: Around) -> None:
        if loop.turns > MOST_TURNS:
            raise NotStaticError(f"{loop.turns} turns are too many to write down", loop.span)
        for _ in range(loop.turns):
            self._add_action(loop.body, around)

    def _add_choice(self, choice: Choice, around: Around) -> None:
        place = self._add(Jump(0), around)
        bodies, leaves = [], []
        for branch in choice.branches:
            bodies.append(self._next)
            self._add_action(branch.body, around)
            leaves.append(self._add(Jump(0), around))
        for leave in leaves:
            self.instructions[leave] = Jump(self._next)
        self.instructions[place] = Select(choice, tuple(bodies))

    def _add_parallel(self, action: ParallelSteps, around: Around) -> None:
        place = self._add(Jump(0), around)
        branches = []
        for step in action.steps:
            branches.append(self._next)
            self._add_action(step, ())
            self._add(Finish(), ())
        self.instructions[place] = Start(tuple(branches), action.prioritized, self._next)

    def _add_catch(self, action: CatchException, around: Around) -> None:
        if action.exception in ("Fault", "Timeout"):
            raise NotStaticError(f"a {action.exception} that is caught may come at any time", action.span)
        before = self._next
        handler = Handler(action.exception, -1)
        self._add_action(action.body, (handler, *around))
        leave = self._add(Jump(0), around)
        known = Handler(action.exception, self._next)
        for position in range(before, leave):
            self.around[position] = tuple(known if item is handler else item for item in self.around[position])
        self._add_action(action.handler, around)
        self.instructions[leave] = Jump(self._next)

    def computes(self, action: Action) -> bool:
        """Whether an action never waits, and goes on after it in every case (but a fault)."""
        match action:
            case SkipStep() | AssignValue() | RunLaw() | ResetStates() | ReportCommunication():
                return True
            case WriteValue(sink=sink):
                return self.never_waits(sink)
            case WriteOutputs(writes=writes):
                return all(self.never_waits(write.sink) for write in writes)
            case ReadInputs(reads=()):
                return True
            case SequentialSteps(steps=steps):
                return all(map(self.computes, steps))
            case IfElse() | WhileLoop() | Repeat() if self._whole is not None and action not in self._whole:
                return False
            case IfElse():
                return self.computes(action.then) and self.computes(action.otherwise)
            case WhileLoop(body=body) | CountedLoop(body=body) | Group(body=body):
                return self.computes(body)
            case Repeat(body=body, until=until):
                return until is not None and self.computes(body)
            case (
                RunInstance() | ReadValue() | StopStep() | WaitStep() | ResetInstance() | RaiseException()
                | ParallelSteps() | Choice() | CatchException() | InterruptOn() | ReadInputs() | ProcessScope()
            ):  # fmt: skip
                return False
            case _:
                assert_never(action)

    def never_waits(self, sink: End) -> bool:
        """Whether writing to it is over at once, and nobody can have waited to read it."""
        return self.medium(sink) in WRITTEN_AT_ONCE - {"overwrite"}


def _target(read: InputRead) -> tuple[End, Target]:
    return read.source, Target(read.name)
