"""Builds the instructions of a composition."""

from __future__ import annotations

from typing import assert_never, overload

from cspdiag.base.record import kept_for_same
from cspdiag.network.flow.code import (
    Abandon,
    Call,
    Code,
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
from cspdiag.network.ir.actions import (
    Action,
    AssignValue,
    Branch,
    CatchException,
    Choice,
    CoreAction,
    CountedLoop,
    Group,
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


@overload
def flow_of(body: CoreAction) -> Code[CoreAction]: ...
@overload
def flow_of(body: Action) -> Code[Action]: ...
def flow_of(body: Action) -> Code[Action]:
    """The instructions of a composition, which several passes ask for one after the other: nobody changes them."""
    return _flow_of(body)


@kept_for_same(8)
def _flow_of(body: Action) -> Code[Action]:
    builder = _Builder()
    builder.action(body)
    builder.add(ProcessEnd(span=body.span))
    return builder.code


class _Builder:
    """Adds instructions in the order of the text."""

    def __init__(self) -> None:
        self.code = Code[Action](
            instructions=[], before=[], back={}, abandoned=[], waiting={}, sequences=[], decisions=[]
        )
        self._open: tuple[int, ...] = ()
        """The instructions before the next one: several where paths join, none if it is unreachable."""
        self._watched: list[list[int]] = []
        """The instructions of each watched part around the present place, from the outermost inwards."""

    def add(self, instruction: Instruction) -> int:
        """Adds an instruction after those that are open; then it alone is open. Returns its index."""
        code, index = self.code, len(self.code.instructions)
        code.instructions.append(instruction)
        code.before.append(self._open)
        code.abandoned.append(None)
        if self._watched:
            self._watched[-1].append(index)
        self._open = (index,)
        return index

    def action(self, action: Action) -> None:
        """Adds the instructions of an action."""
        span, first = action.span, len(self.code.instructions)
        match action:
            case RunInstance():
                self.add(Call(span=span, step=action))
            case ReadValue() | WriteValue() | ReadInputs() | WriteOutputs():
                self.add(Communicate(span=span, step=action))
            case AssignValue() | SkipStep() | ResetInstance() | RunLaw() | ResetStates() | ReportCommunication():
                self.add(Compute(span=span, step=action))
            case WaitStep():
                self.add(Delay(span=span, step=action))
            case StopStep():
                self.add(Stop(span=span, step=action))
                self._open = ()
            case RaiseException():
                self.add(Raise(span=span, step=action))
                self._open = ()
            case SequentialSteps():
                starts = []
                for step in action.steps:
                    starts.append(len(self.code.instructions))
                    self.action(step)
                self.code.sequences.append((action, starts))
            case ParallelSteps():
                self._parallel(action)
            case Choice():
                self._choice(action)
            case Repeat():
                start = self.add(Loop(span=span))
                self.action(action.body)
                if action.until is not None:
                    self.add(Test(span=span, condition=action.until))
                self._back(start)
                if action.until is None:
                    self._open = ()
            case WhileLoop():
                start = self.add(Loop(span=span))
                test = self.add(Test(span=span, condition=action.condition))
                self.action(action.body)
                self._back(start)
                self._open = (test,)
            case CountedLoop():
                start = self.add(Loop(span=span))
                self.action(action.body)
                self.add(IterationEnd(span=span))
                self._back(start)
            case IfElse():
                test = self.add(Test(span=span, condition=action.condition))
                self.action(action.then)
                then, self._open = self._open, (test,)
                self.action(action.otherwise)
                self._open = then + self._open
                self.add(Merge(span=span))
            case CatchException():
                ended = self._watch(action)
                self.action(action.handler)
                self._resume(action, ended)
            case InterruptOn():
                ended = self._watch(action)
                self._branch(action.branch)
                self._resume(action, ended)
            case Group():
                self.action(action.body)
            case ProcessScope():
                self.add(Enter(span=span, step=action))
                self.action(action.body)
                self.add(Leave(span=span, step=action))
            case _:
                assert_never(action)
        if isinstance(action, IfElse | WhileLoop | Repeat | CountedLoop):
            self.code.decisions.append((action, range(first, len(self.code.instructions))))

    def _back(self, start: int) -> None:
        self.code.before[start] += self._open
        self.code.back.update((last, start) for last in self._open)

    def _parallel(self, parallel: ParallelSteps) -> None:
        fork = self.add(Fork(span=parallel.span, step=parallel))
        ends: list[int] = []
        beginning = (fork,)
        for step in parallel.steps:
            self._open = beginning
            self.action(step)
            ends += self._open
        every_branch_ends = len(ends) == len(parallel.steps)
        self._open = tuple(ends) if every_branch_ends else ()
        join = self.add(Join(span=parallel.span, fork=fork))
        if not every_branch_ends:
            self.code.waiting[join] = tuple(ends)

    def _choice(self, choice: Choice) -> None:
        select = self.add(Select(span=choice.span, step=choice))
        ends: list[int] = []
        for branch in choice.branches:
            self._open = (select,)
            self._branch(branch)
            ends += self._open
        self._open = tuple(ends)
        self.add(Merge(span=choice.span))

    def _branch(self, branch: Branch) -> None:
        self.add(Take(span=branch.event.span, branch=branch))
        self.action(branch.body)

    def _watch(self, watching: CatchException | InterruptOn) -> int:
        """Adds the part that may be abandoned, up to the instruction after it has been. Returns the index of its normal
        end.
        """
        self.add(Watch(span=watching.span, step=watching))
        self._watched.append([])
        self.action(watching.body)
        ended = self.add(Unwatch(span=watching.span))
        inside = self._watched.pop()
        self._open = ()
        abandon = self.add(Abandon(span=watching.span, step=watching))
        for index in inside:
            self.code.abandoned[index] = abandon
        return ended

    def _resume(self, watching: CatchException | InterruptOn, ended: int) -> None:
        self._open = (ended, *self._open)
        self.add(Resume(span=watching.span))
