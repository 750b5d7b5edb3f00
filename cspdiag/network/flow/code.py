"""The control-flow graph of a process: instructions with edges between them, for all analyses of control flow.

Instructions are in the order of the text, so indexes increase along every edge except those that close a loop. A part
that may be abandoned (by an exception, or by an interrupt) lies between two markers; from each instruction in it,
including the markers, an edge of its own (``abandoned``) leads to where execution continues in that case, with the
state *before* the instruction.
"""

from __future__ import annotations

from typing import Generic, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import Slotted, node
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
"""The steps that become one ``Compute``, ``Communicate`` or ``Delay``."""


@node
class BaseInstruction(Slotted):
    """An instruction, with its place in the text."""

    span: Span


@node
class Compute(BaseInstruction):
    """A step that takes no time and does not communicate."""

    step: Computation


@node
class Communicate(BaseInstruction):
    """A communication, which may wait for its partners."""

    step: Communication


@node
class Delay(BaseInstruction):
    """Waits for time to pass."""

    step: WaitStep


@node
class Call(BaseInstruction):
    """Runs an instance to its end."""

    step: RunInstance


@node
class Select(BaseInstruction, Generic[A_co]):
    """Waits until a guard is ready; a ``Take`` for each branch follows."""

    step: Choice[A_co]


@node
class Take(BaseInstruction, Generic[A_co]):
    """A guard is chosen, and its event happens. Its condition, which is evaluated earlier, counts as read here."""

    branch: Branch[A_co]


@node
class Test(BaseInstruction):
    """Tests a condition; the first edge is for the case that it holds."""

    condition: Expression


class Loop(BaseInstruction):
    """The beginning of each iteration of a loop."""


class IterationEnd(BaseInstruction):
    """The end of an iteration of a counted loop: goes back, or ends the loop."""


@node
class Fork(BaseInstruction, Generic[A_co]):
    """The branches of a parallel begin."""

    step: ParallelSteps[A_co]


@node
class Join(BaseInstruction):
    """All branches of a parallel, the instructions before this one, have ended; they began at ``fork``."""

    fork: int


class Merge(BaseInstruction):
    """Joins several paths of which one was taken."""


@node
class Watch(BaseInstruction, Generic[A_co]):
    """The beginning of a part that an exception or an interrupt may abandon."""

    step: CatchException[A_co] | InterruptOn[A_co]


class Unwatch(BaseInstruction):
    """The watched part has ended normally."""


@node
class Abandon(BaseInstruction, Generic[A_co]):
    """The watched part was abandoned: the handler, or the branch of the interrupt, follows."""

    step: CatchException[A_co] | InterruptOn[A_co]


class Resume(BaseInstruction):
    """Continues after the watched part has ended (``Unwatch``, the first instruction before it), or after the handler
    or branch that followed its abandonment (the second).
    """


@node
class Raise(BaseInstruction):
    """Raises an exception."""

    step: RaiseException


@node
class Stop(BaseInstruction):
    """A step that never ends."""

    step: StopStep


@node
class Enter(BaseInstruction):
    """A process that was flattened into this one begins."""

    step: ProcessScope


@node
class Leave(BaseInstruction):
    """A process that was flattened into this one has ended."""

    step: ProcessScope


class ProcessEnd(BaseInstruction):
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
    | IterationEnd
    | Fork[A_co]
    | Join
    | Merge
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
    """The ends of loops, each with the ``Loop`` that it goes back to; these edges are in ``before``, too."""
    abandoned: list[int | None]
    """For each instruction the innermost ``Abandon`` around it, where execution continues if the part is abandoned."""
    waiting: dict[int, tuple[int, ...]]
    """For each ``Join`` that is never reached, because some branch of its parallel never ends, the ends of the other
    branches, which wait there.
    """
    sequences: list[tuple[SequentialSteps[A_co], list[int]]]
    """Every sequence, with the indexes at which its steps begin."""
    decisions: list[tuple[Decision[A_co], range]]
    """Every condition and loop, with its instructions; inner ones come before outer ones."""


def following(code: Code) -> list[list[int]]:
    """The successors of each instruction: those after it in the order of the text, then those that it goes back to,
    from the outermost loop inwards. So the first successor of a ``Test`` is where its condition holds. The ``Join`` is
    a successor of every branch that may end.
    """
    after: list[list[int]] = [[] for _ in code.instructions]
    for index, before in enumerate(code.before):
        for earlier in (*before, *code.waiting.get(index, ())):
            after[earlier].append(index)
    for index, ways in enumerate(after):
        ways.sort(key=lambda way: (way <= index, way))
    return after
