"""Where the variables of a process live: as local variables of its code where that can be, as objects where not."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from functools import lru_cache
from typing import assert_never

from cspdiag.model.types import has_unit
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
    InputEvent,
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
from cspdiag.network.ir.expressions import VariableValue
from cspdiag.network.ir.network import Network, ProcessClass
from cspdiag.network.ir.walk import instances_run, parts


def local_variables(process: ProcessClass, again: bool, probed: bool) -> frozenset[str]:
    """The variables that can be local: no instance has them, no guard, and every read surely comes after a write.

    ``again`` tells that the process may be run more than once, with its variables as they were left; ``probed`` that those with a unit
    are watched from outside.
    """
    variables = {channel.name: channel for channel in process.channels if channel.kind == "var"}
    shared = {
        connection.attachment.channel
        for instance in process.instances
        for connection in instance.connections
        if isinstance(connection.attachment, ChannelEnd)
    }
    for part in parts(process.body):
        if isinstance(part, Choice | InterruptOn):
            branches = part.branches if isinstance(part, Choice) else (part.branch,)
            events = (branch.event for branch in branches)
            ends = (getattr(event, "source", None) or getattr(event, "sink", None) for event in events)
            shared |= {end.channel for end in ends if isinstance(end, ChannelEnd)}
    written = frozenset(name for name, channel in variables.items() if channel.initial is not None and not again)
    flow = _Flow()
    if process.body is not None:
        flow.after(process.body, written)
    watched = {name for name, channel in variables.items() if probed and has_unit(channel.type)}
    return frozenset(variables) - shared - flow.read_early - watched


class _Flow:
    """Finds what may be read before it was written."""

    def __init__(self) -> None:
        self.read_early: set[str] = set()

    def _reads(self, item: object, written: frozenset[str]) -> None:
        self.read_early |= {part.channel for part in parts(item) if isinstance(part, VariableValue)} - written

    def _comes_from(self, source: End, written: frozenset[str]) -> None:
        if isinstance(source, ChannelEnd) and source.channel not in written:
            self.read_early.add(source.channel)

    def _set(self, target: Target, written: frozenset[str]) -> frozenset[str]:
        self._reads(target.indexes, written)
        if target.indexes and target.channel not in written:
            self.read_early.add(target.channel)
        return written | {target.channel}

    def after(self, action: Action, written: frozenset[str] | None) -> frozenset[str] | None:
        """What surely has a value after ``action``, given what had before; None if nothing comes after it."""
        if written is None:
            return None
        match action:
            case SkipStep() | RunInstance() | ResetInstance() | ResetStates():
                return written
            case StopStep() | RaiseException():
                return None
            case AssignValue(target=target, value=value):
                self._reads(value, written)
                return self._set(target, written)
            case ReadValue(source=source, target=target):
                self._comes_from(source, written)
                return self._set(target, written)
            case WriteValue(sink=sink, value=value):
                self._reads(value, written)
                return written | {sink.channel} if isinstance(sink, ChannelEnd) else written
            case WaitStep() | RunLaw() | ReportCommunication():
                self._reads(action, written)
                return written
            case ReadInputs(reads=reads):
                for read in reads:
                    self._comes_from(read.source, written)
                return written
            case WriteOutputs(writes=writes):
                self._reads(action, written)
                return written | {w.sink.channel for w in writes if isinstance(w.sink, ChannelEnd)}
            case SequentialSteps(steps=steps):
                reached: frozenset[str] | None = written
                for step in steps:
                    reached = self.after(step, reached)
                return reached
            case ParallelSteps(steps=steps):
                ends = [self.after(step, written) for step in steps]
                return None if None in ends else written.union(*(end for end in ends if end is not None))
            case Choice(branches=branches):
                for branch in branches:
                    self._reads(branch.condition, written)
                return _either(*(self._branch(branch.event, branch.body, written) for branch in branches))
            case InterruptOn(body=body, branch=branch):
                self._reads(branch.condition, written)
                return _either(self.after(body, written), self._branch(branch.event, branch.body, written))
            case Repeat(body=body, until=until):
                end = self.after(body, written)
                if until is None or end is None:
                    return None
                self._reads(until, end)
                return end
            case WhileLoop(condition=condition, body=body):
                self._reads(condition, written)
                self.after(body, written)
                return written
            case IfElse(condition=condition, then=then, otherwise=otherwise):
                self._reads(condition, written)
                return _either(self.after(then, written), self.after(otherwise, written))
            case CatchException(body=body, handler=handler):
                return _either(self.after(body, written), self.after(handler, written))
            case CountedLoop(body=body) | Group(body=body) | ProcessScope(body=body):
                return self.after(body, written)
        assert_never(action)

    def _branch(self, event: object, body: Action, written: frozenset[str]) -> frozenset[str] | None:
        self._reads(event, written)
        if isinstance(event, InputEvent):
            written = self._set(event.target, written)
        return self.after(body, written)


def _either(*ends: frozenset[str] | None) -> frozenset[str] | None:
    reached = [end for end in ends if end is not None]
    return frozenset.intersection(*reached) if reached else None


@lru_cache(maxsize=1)
def run_again(network: Network) -> frozenset[str]:
    """The process classes of which an instance may be run more than once; every class of a package asks."""
    classes = {entry.name: entry for entry in network.classes if isinstance(entry, ProcessClass)}
    found: set[str] = set()
    pending: list[str] = []
    for process in classes.values():
        of = {instance.name: instance.class_name for instance in process.instances}
        runs = Counter(() if process.body is None else instances_run(process.body))
        looped = {name for loop in _loops(process) for name in instances_run(loop)}
        pending += [of[name] for name, count in runs.items() if count > 1 or name in looped]
    while pending:
        name = pending.pop()
        if name in classes and name not in found:
            found.add(name)
            pending += [instance.class_name for instance in classes[name].instances]
    return frozenset(found)


def _loops(process: ProcessClass) -> Iterator[Action]:
    for part in parts(process.body):
        if isinstance(part, Repeat | WhileLoop | CountedLoop):
            yield part
