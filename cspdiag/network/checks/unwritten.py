"""Variables that a run may read before they were written, which is then a fault.

The checks of a program follow its composition as if what may be abandoned came to its end; here nothing is taken for granted of the body of a ``catch``
or ``interrupt``. Where a program has neither, every variable is written before it is read.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import reduce

from cspdiag.network.ir.actions import (
    Action,
    AssignValue,
    Branch,
    CatchException,
    ChannelEnd,
    Choice,
    CountedLoop,
    Group,
    IfElse,
    InputEvent,
    InterruptOn,
    OutputEvent,
    ParallelSteps,
    PortEnd,
    ProcessScope,
    RaiseException,
    ReadInputs,
    ReadValue,
    ReadyEvent,
    Repeat,
    SequentialSteps,
    StopStep,
    Target,
    WhileLoop,
    WriteOutputs,
    WriteValue,
)
from cspdiag.network.ir.expressions import VariableValue
from cspdiag.network.ir.network import Network, ProcessClass
from cspdiag.network.ir.walk import parts


def may_be_unwritten(network: Network) -> dict[str, frozenset[str]]:
    """By class, its variables that may be read without a value; a variable that an instance is attached to may whenever it has no initial value."""
    classes = [entry for entry in network.classes if isinstance(entry, ProcessClass)]
    abandoned = any(isinstance(part, CatchException | InterruptOn) for part in parts([entry.body for entry in classes]))
    if not abandoned and not any(entry.external for entry in classes):
        return {entry.name: frozenset() for entry in classes}
    return {entry.name: _in_class(entry) for entry in classes}


def ports_of_unwritten(network: Network) -> dict[str, frozenset[tuple[str, int | None]]]:
    """By class, the input ports (and the index in an array) behind which such a variable may be."""
    variables = may_be_unwritten(network)
    found: dict[str, set[tuple[str, int | None]]] = {entry.name: set() for entry in network.classes}
    inputs = {(entry.name, port.name) for entry in network.classes for port in entry.ports if port.direction == "in"}
    for entry in reversed(network.classes):
        if isinstance(entry, ProcessClass):
            for instance in entry.instances:
                for connection in instance.connections:
                    end = connection.attachment
                    if (instance.class_name, connection.port) not in inputs:
                        continue
                    if (isinstance(end, ChannelEnd) and end.channel in variables[entry.name]) or (
                        isinstance(end, PortEnd) and (end.port, end.index) in found[entry.name]
                    ):
                        found[instance.class_name].add((connection.port, connection.index))
    return {name: frozenset(places) for name, places in found.items()}


def _in_class(entry: ProcessClass) -> frozenset[str]:
    unset = {channel.name for channel in entry.channels if channel.kind == "var" and channel.initial is None}
    attached = {
        connection.attachment.channel
        for instance in entry.instances
        for connection in instance.connections
        if isinstance(connection.attachment, ChannelEnd)
    }
    flow = _Flow(frozenset(unset - attached))
    if entry.body is not None:
        flow.after(entry.body, frozenset())
    return frozenset(flow.read_unwritten | (unset & attached))


class _Flow:
    """Follows a composition with the set of the variables that were surely written."""

    def __init__(self, variables: frozenset[str]) -> None:
        self.variables = variables
        self.read_unwritten: set[str] = set()

    def after(self, action: Action, written: frozenset[str]) -> frozenset[str]:
        """What was written when the action has ended; everything where it never ends by itself."""
        match action:
            case SequentialSteps(steps=steps):
                return reduce(lambda before, step: self.after(step, before), steps, written)
            case ParallelSteps(steps=steps):
                return frozenset().union(*(self.after(step, written) for step in steps))
            case Choice(branches=branches):
                return self._all(self._branch(branch, written) for branch in branches)
            case Repeat(body=body, until=until):
                ended = self.after(body, written)
                self._reads(until, ended)
                return self.variables if until is None else ended
            case WhileLoop(condition=condition, body=body):
                self._reads(condition, written)
                self.after(body, written)
                return written
            case IfElse(condition=condition, then=then, otherwise=otherwise):
                self._reads(condition, written)
                return self._all((self.after(then, written), self.after(otherwise, written)))
            case CatchException(body=body, handler=handler):
                return self._all((self.after(body, written), self.after(handler, written)))
            case InterruptOn(body=body, branch=branch):
                return self._all((self.after(body, written), self._branch(branch, written)))
            case CountedLoop(body=body) | Group(body=body) | ProcessScope(body=body):
                return self.after(body, written)
            case StopStep() | RaiseException():
                return self.variables
            case ReadInputs(reads=reads):
                self._ends((read.source for read in reads), written)
                return written
            case _:
                return self._step(action, written)

    def _all(self, ways: Iterable[frozenset[str]]) -> frozenset[str]:
        return reduce(frozenset.intersection, ways, self.variables)

    def _step(self, action: Action, written: frozenset[str]) -> frozenset[str]:
        self._reads(action, written)
        match action:
            case ReadValue(source=source, target=target):
                self._ends((source,), written)
                return self._set(target, written)
            case AssignValue(target=target):
                return self._set(target, written)
            case WriteValue(sink=ChannelEnd(channel=name)):
                return written | ({name} & self.variables)
            case WriteOutputs(writes=writes):
                return written | ({w.sink.channel for w in writes if isinstance(w.sink, ChannelEnd)} & self.variables)
            case _:
                return written

    def _branch(self, branch: Branch, written: frozenset[str]) -> frozenset[str]:
        event = branch.event
        self._reads((branch.condition, event), written)
        match event:
            case InputEvent(source=source, target=target):
                self._ends((source,), written)
                written = self._set(target, written)
            case ReadyEvent(source=source):
                self._ends((source,), written)
            case OutputEvent(sink=ChannelEnd(channel=name)):
                written |= {name} & self.variables
            case _:
                pass
        return self.after(branch.body, written)

    def _set(self, target: Target, written: frozenset[str]) -> frozenset[str]:
        if target.indexes:
            self._note((target.channel,), written)
            return written
        return written | ({target.channel} & self.variables)

    def _reads(self, item: object, written: frozenset[str]) -> None:
        self._note((part.channel for part in parts(item) if isinstance(part, VariableValue)), written)

    def _ends(self, ends: Iterable[object], written: frozenset[str]) -> None:
        self._note(_channels(ends), written)

    def _note(self, names: Iterable[str], written: frozenset[str]) -> None:
        self.read_unwritten.update(name for name in names if name in self.variables and name not in written)


def _channels(ends: Iterable[object]) -> Iterator[str]:
    return (end.channel for end in ends if isinstance(end, ChannelEnd))
