"""What a process does as instructions with edges between them: one graph that every analysis of control flow follows.

An instruction stands where its step stands in the text, so that indexes go up along every edge but those that close a
loop. What may be abandoned (by an exception, or by an interrupt) lies between two markers; from each instruction there,
the markers among them, an edge of its own (``abandoned``) leads to where it goes on then, with what was so *before* the
instruction.
"""

from __future__ import annotations

from typing import Generic, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import node
from cspdiag.network.ir.actions import (
    A_co,
    AssignValue,
    Branch,
    CatchException,
    Choice,
    CountedLoop,
    IfElse,
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
    WaitStep,
    WhileLoop,
    WriteOutputs,
    WriteValue,
)
from cspdiag.network.ir.expressions import Expression

Computation: TypeAlias = AssignValue | SkipStep | ResetInstance | RunLaw | ResetStates | ReportCommunication
Communication: TypeAlias = ReadValue | WriteValue | ReadInputs | WriteOutputs

Decision: TypeAlias = IfElse[A_co] | WhileLoop[A_co] | Repeat[A_co] | CountedLoop[A_co]

SINGLE_STEPS = Computation | Communication | WaitStep
"""The steps that one ``Compute``, ``Communicate`` or ``Delay`` stands for."""


@node
class Placed:
    """Anything in a process that is executed; it has a place."""

    span: Span


@node
class Compute(Placed):
    """Takes no time and communicates nothing."""

    step: Computation


@node
class Communicate(Placed):
    """Waits for partners, if it has to."""

    step: Communication


@node
class Delay(Placed):
    """Waits for time to pass."""

    step: WaitStep


@node
class Call(Placed):
    """Runs an instance to its end."""

    step: RunInstance


@node
class Select(Placed, Generic[A_co]):
    """Waits until a guard is ready; a ``Take`` for each branch follows."""

    step: Choice[A_co]


@node
class Take(Placed, Generic[A_co]):
    """A guard is chosen: its event happens. Its condition, which is looked at before, counts as read here."""

    branch: Branch[A_co]


@node
class Test(Placed):
    """Goes on in two ways; the first is where the condition holds."""

    condition: Expression


class Loop(Placed):
    """Where the turns of a loop begin."""


class Turn(Placed):
    """The end of a turn of a counted loop: goes back, or on."""


@node
class Fork(Placed, Generic[A_co]):
    """The branches of a parallel begin."""

    step: ParallelSteps[A_co]


@node
class Join(Placed):
    """The branches of a parallel, the instructions before, have all ended; they began at ``fork``."""

    fork: int


class Meet(Placed):
    """Several ways come together, of which one was taken."""


@node
class Watch(Placed, Generic[A_co]):
    """Begins what an exception or an interrupt may abandon."""

    step: CatchException[A_co] | InterruptOn[A_co]


class Unwatch(Placed):
    """It has come to its end by itself."""


@node
class Abandon(Placed, Generic[A_co]):
    """It was abandoned: the handler or the interrupt's branch follows."""

    step: CatchException[A_co] | InterruptOn[A_co]


class Resume(Placed):
    """What is watched has ended (``Unwatch``, the first before it), or what followed when it was abandoned (the
    second).
    """


@node
class Raise(Placed):
    """Ends the process unsuccessfully."""

    step: RaiseException


@node
class Stop(Placed):
    """Never ends."""

    step: StopStep


@node
class Enter(Placed):
    """A process that was flattened into this one begins."""

    step: ProcessScope


@node
class Leave(Placed):
    """It has ended."""

    step: ProcessScope


class ProcessEnd(Placed):
    """The process has ended."""


Instruction: TypeAlias = (
    Compute
    | Communicate
    | Delay
    | Call
    | Select[A_co]
    | Take[A_co]
    | Test
    | Loop
    | Turn
    | Fork[A_co]
    | Join
    | Meet
    | Watch[A_co]
    | Unwatch
    | Abandon[A_co]
    | Resume
    | Raise
    | Stop
    | Enter
    | Leave
    | ProcessEnd
)


@node
class Code(Generic[A_co]):
    """The instructions of a process, the first one its entry and the last one its ``ProcessEnd``, with their edges
    as indexes.
    """

    instructions: list[Instruction[A_co]]
    before: list[tuple[int, ...]]
    back: dict[int, int]
    """The ends of loops, each with the ``Loop`` that it goes back to; the edges from them are among ``before`` as well.
    """
    abandoned: list[int | None]
    """Where it goes on if what it stands in is abandoned: the innermost ``Abandon``."""
    waiting: dict[int, tuple[int, ...]]
    """By the ``Join`` of a parallel of which some branch never ends, and which is never reached therefore: the ends of
    the others, which wait there.
    """
    sequences: list[tuple[SequentialSteps[A_co], list[int]]]
    """Every sequence, with the instruction at which each of its steps begins."""
    decisions: list[tuple[Decision[A_co], range]]
    """Every condition and loop, with its instructions; those inside it come before it."""


def following(code: Code) -> list[list[int]]:
    """The instructions after each: those behind it in the order of the text, then those that it goes back to, from the
    outermost loop; so the first after a ``Test`` is where its condition holds. The ``Join`` comes after every branch
    that may end.
    """
    after: list[list[int]] = [[] for _ in code.instructions]
    for index, before in enumerate(code.before):
        for earlier in (*before, *code.waiting.get(index, ())):
            after[earlier].append(index)
    for index, ways in enumerate(after):
        ways.sort(key=lambda way: (way <= index, way))
    return after
