"""The instructions of a program, prepared for following all its processes at compile time.

Parts that only compute are executed as a unit, however large; outputs to the environment never wait, and count as
computation.
"""

from __future__ import annotations

from collections.abc import Container
from typing import assert_never

from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.network.flow import code as flow
from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.waiting import WRITTEN_AT_ONCE
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.network import MediumKind, ProcessClass
from cspdiag.optimize.changes import with_inner_actions

LARGEST_NUMBER_OF_ITERATIONS = 1_000
"""A loop that communicates in more iterations is not unrolled."""


class NotStaticError(Exception):
    """The order of communications is not known at compile time; the message gives the reason."""

    def __init__(self, reason: str, span: Span | None = None) -> None:
        super().__init__(reason if span is None else f"{reason} ({span})")


@record(eq=False)
class Failure:
    """An exception that is raised, and the process that raises it, None for the outermost."""

    action: ir.RaiseException
    process: ir.ProcessScope | None


class Code:
    """The instructions of a process class whose composition runs no instances, and their successors.

    ``whole`` are the conditions and loops that may be computed as a unit, including everything inside them; None: all
    that only compute.
    """

    def __init__(self, entry: ProcessClass, whole: Container[ir.Action] | None = None) -> None:
        assert entry.body is not None
        self.entry = entry
        self._whole = whole
        self.kinds: dict[str, MediumKind] = {channel.name: channel.kind for channel in entry.channels}
        self._media = {port.name: port.media for port in entry.ports}
        code = flow_of(self._unrolled(entry.body))
        self.instructions = code.instructions
        self.after = flow.following(code)
        self.computations = self._computations(code)
        """What is computed as a unit, by its first instruction, with the instruction after it."""
        self.joins = {i.fork: index for index, i in enumerate(code.instructions) if isinstance(i, flow.Join)}
        """The ``Join`` of each ``Fork``."""
        self._refuse(code)
        self.around: list[tuple[int, ...]] = []
        """The scopes around each instruction within its branch, innermost first: the ``Enter`` of processes, and the
        ``Abandon`` of handlers.
        """
        self.failures: dict[int, Failure] = {}
        self._nest(code)

    def _unrolled(self, action: ir.Action) -> ir.Action:
        """The action with loops that communicate unrolled into their iterations."""
        action = with_inner_actions(action, self._unrolled)
        if (
            not isinstance(action, ir.CountedLoop)
            or action.iterations > LARGEST_NUMBER_OF_ITERATIONS
            or 0 in self._computations(flow_of(action))
        ):
            return action
        return ir.SequentialSteps(span=action.span, steps=(action.body,) * action.iterations)

    def _computations(self, code: flow.Code) -> dict[int, tuple[ir.Action, int]]:
        after = flow.following(code)
        computes = [self._computes(instruction) for instruction in code.instructions]
        found: dict[int, tuple[ir.Action, int]] = {}
        for action, inside in code.decisions:
            out = next((target for index in inside for target in after[index] if target not in inside), None)
            if out is None or not all(computes[inside.start : inside.stop]):
                computes[inside.start] = False
            elif self._whole is None or isinstance(action, ir.CountedLoop) or action in self._whole:
                found[inside.start] = (action, out)
        return found

    def _computes(self, instruction: flow.Instruction) -> bool:
        """Whether an instruction never waits, and is followed by the next one in every case (except for a fault)."""
        match instruction:
            case flow.Compute():
                return not isinstance(instruction.step, ir.ResetInstance)
            case flow.Communicate():
                return self.is_done_at_once(instruction.step)
            case _:  # Of the others, these only transfer control.
                return isinstance(instruction, flow.Test | flow.Loop | flow.IterationEnd | flow.Merge)

    def is_done_at_once(self, step: flow.Communication) -> bool:
        """Whether a communication never waits, and no other process can have waited for it."""
        match step:
            case ir.ReadValue():
                return False
            case ir.ReadInputs():
                return not step.reads
            case ir.WriteValue():
                return self._never_waits(step.sink)
            case ir.WriteOutputs():
                return all(self._never_waits(write.sink) for write in step.writes)
            case _:
                assert_never(step)

    def _never_waits(self, sink: ir.End) -> bool:
        return self._medium(sink) in WRITTEN_AT_ONCE - {"overwrite"}

    def _medium(self, end: ir.End) -> MediumKind:
        if isinstance(end, ir.ChannelEnd):
            return self.kinds[end.channel]
        media = self._media[end.port]
        if not media:
            raise NotStaticError("classes are not specialized")
        return media[end.index or 0].kind

    def _refuse(self, code: flow.Code) -> None:
        counted = {inside.start: action for action, inside in code.decisions if isinstance(action, ir.CountedLoop)}
        for index, instruction in enumerate(code.instructions):
            match instruction:
                case flow.Call(step=step) | flow.Compute(step=ir.ResetInstance() as step):
                    raise NotStaticError(f"{step.instance} is a separate process or control law", step.span)
                case flow.Watch(step=ir.CatchException(exception="Fault" | "Timeout" as exception)):
                    raise NotStaticError(f"a {exception} that is caught may come at any time", instruction.span)
                case flow.Watch(step=step) if not isinstance(step, ir.CatchException):
                    raise NotStaticError("an interrupt may come at any time", instruction.span)
                case flow.Loop() if index in counted and index not in self.computations:
                    raise NotStaticError(
                        f"{counted[index].iterations} iterations are too many to unroll", instruction.span
                    )
                case _:  # Every other instruction can be followed.
                    pass

    def _nest(self, code: flow.Code) -> None:
        around: list[tuple[int, ...]] = [()]
        for index, instruction in enumerate(code.instructions):
            match instruction:
                case flow.Join():
                    around.pop()
                case flow.Leave() | flow.Unwatch():
                    around[-1] = around[-1][1:]
                case _:  # No other instruction ends a scope.
                    pass
            self.around.append(around[-1])
            match instruction:
                case flow.Fork():
                    around.append(())
                case flow.Enter():
                    around[-1] = (index, *around[-1])
                case flow.Watch():
                    abandon = code.abandoned[index + 1]
                    assert abandon is not None
                    around[-1] = (abandon, *around[-1])
                case flow.Raise():
                    scopes = (code.instructions[place] for branch in reversed(around) for place in branch)
                    process = next((scope.step for scope in scopes if isinstance(scope, flow.Enter)), None)
                    self.failures[index] = Failure(instruction.step, process)
                case _:  # No other instruction begins a scope.
                    pass
