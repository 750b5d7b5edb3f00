"""Checks the composition of a process: ends, variables and instances that do not exist, and types that do not agree."""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from cspdiag.base import Span
from cspdiag.model.types import BOOL, TIME, ArrayType, IntType, Type
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.external import external_calls
from cspdiag.network.ir.network import Direction, ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.optimize.check.expressions import Names, agrees, expression_problems, types_of

PREDECLARED_EXCEPTIONS = frozenset({"Fault", "Timeout"})
"""The exceptions that a program need not declare."""


class CompositionCheck:
    """The composition of a process class; each method yields the problems of one part of it, in words."""

    def __init__(self, process: ProcessClass, exceptions: frozenset[str]) -> None:
        self.process = process
        self.exceptions = exceptions
        self.ports = {port.name: port for port in process.ports}
        self.channels = {channel.name: channel for channel in process.channels}
        self.instances = {instance.name for instance in process.instances}
        self.names = Names(
            parameters=types_of(process.parameters, tunable=False),
            tunable=types_of(process.parameters, tunable=True),
            variables={channel.name: channel.type for channel in process.channels if channel.kind == "var"},
            signals=_signals(process),
            time=TIME,
        )

    def problems(self) -> Iterator[str]:
        """All problems, from the initial values of what the process owns to the last step."""
        for constant in self.process.constants:
            yield from self._value(constant.value, constant.type)
        for state in self.process.states:
            yield from self._value(state.initial, state.type)
        for channel in self.process.channels:
            if channel.initial is not None:
                yield from self._value(channel.initial, channel.type)
        if self.process.body is not None:
            yield from self._action(self.process.body)

    def end(self, end: ir.End, direction: Direction | None = None) -> Iterator[str]:
        """The problems of a port or channel that is read (``in``), written (``out``) or, with None, passed to an
        instance.
        """
        match end:
            case ir.ChannelEnd():
                if end.channel not in self.channels:
                    yield f"there is no channel `{end.channel}`"
            case ir.PortEnd():
                port = self.ports.get(end.port)
                if port is None:
                    yield f"there is no port `{end.port}`"
                elif direction not in (None, port.direction):
                    yield f"the port `{end.port}` is of the other direction"
                elif (end.index is None) != (port.size is None) or not 0 <= (end.index or 0) < (port.size or 1):
                    yield f"the port `{end.port}` has no element {end.index}"
            case _:
                assert_never(end)

    def type_of(self, end: ir.End) -> Type | None:
        """The type of the values that are passed; None if there is no such end."""
        found = self.ports.get(end.port) if isinstance(end, ir.PortEnd) else self.channels.get(end.channel)
        return None if found is None else found.type

    def _action(self, action: ir.Action) -> Iterator[str]:
        yield from _place(action)
        match action:
            case ir.RunInstance() | ir.ResetInstance():
                if action.instance not in self.instances:
                    yield f"there is no instance `{action.instance}`"
            case ir.ReadValue():
                yield from self._read(action.source, action.target)
            case ir.WriteValue():
                yield from self._written(action.sink, action.value)
            case ir.AssignValue():
                yield from self._target(action.target, action.value.type)
                yield from self._value(action.value)
            case ir.SkipStep() | ir.StopStep():
                pass
            case ir.WaitStep():
                yield from self._value(action.duration, TIME)
            case ir.RaiseException():
                if action.exception not in self.exceptions:
                    yield f"there is no exception `{action.exception}`"
            case ir.SequentialSteps() | ir.ParallelSteps():
                if not action.steps:
                    yield f"{type(action).__name__} is empty"
                for step in action.steps:
                    yield from self._action(step)
            case ir.Choice():
                if not action.branches:
                    yield "an alternative has no branches"
                for branch in action.branches:
                    yield from self._branch(branch)
            case ir.Repeat():
                yield from self._action(action.body)
                if action.until is not None:
                    yield from self._value(action.until, BOOL)
            case ir.WhileLoop():
                yield from self._value(action.condition, BOOL)
                yield from self._action(action.body)
            case ir.CountedLoop():
                if action.iterations < 2:
                    yield f"a counted loop has {action.iterations} iterations"
                yield from self._action(action.body)
            case ir.IfElse():
                yield from self._value(action.condition, BOOL)
                yield from self._action(action.then)
                yield from self._action(action.otherwise)
            case ir.CatchException():
                if action.exception not in self.exceptions | PREDECLARED_EXCEPTIONS:
                    yield f"there is no exception `{action.exception}`"
                yield from self._action(action.body)
                yield from self._action(action.handler)
            case ir.InterruptOn():
                yield from self._action(action.body)
                yield from self._branch(action.branch)
            case ir.Group():
                yield from self._action(action.body)
            case ir.ReadInputs():
                for read in action.reads:
                    yield from self._passing(read.source, "in", read.type)
            case ir.WriteOutputs():
                for write in action.writes:
                    yield from self._written(write.sink, write.value)
            case ir.RunLaw():
                yield from self._law(action)
            case ir.ResetStates():
                calls = {call.name for call in external_calls(self.process)}
                for name in action.states:
                    if name not in calls and name not in {state.name for state in self.process.states}:
                        yield f"there is no state `{name}`"
            case ir.ProcessScope():
                for end in action.ends:
                    yield from self.end(end, "in")
                yield from self._action(action.body)
            case ir.ReportCommunication():
                yield from self._value(action.value)
            case _:
                assert_never(action)

    def _branch(self, branch: ir.Branch) -> Iterator[str]:
        yield from _place(branch)
        if branch.condition is not None:
            yield from self._value(branch.condition, BOOL)
        yield from self._event(branch.event)
        yield from self._action(branch.body)

    def _event(self, event: ir.Event) -> Iterator[str]:
        yield from _place(event)
        match event:
            case ir.ReadyEvent():
                yield from self.end(event.source, "in")
            case ir.InputEvent():
                yield from self._read(event.source, event.target)
            case ir.OutputEvent():
                yield from self._written(event.sink, event.value)
            case ir.AfterEvent():
                yield from self._value(event.duration, TIME)
            case ir.SkipEvent():
                pass
            case _:
                assert_never(event)

    def _law(self, law: ir.RunLaw) -> Iterator[str]:
        for equation in (*law.equations, *law.derivative_equations):
            if isinstance(equation, ExternalCall):
                for _, value in (*equation.arguments, *equation.inputs):
                    yield from self._value(value)
            else:
                yield from self._value(equation.value, equation.type)
        states = {state.name: state for state in self.process.states}
        for continuous, values in ((False, law.next_values), (True, law.derivatives)):
            for name, value in values:
                if name not in states or states[name].continuous != continuous:
                    yield f"there is no {'continuous' if continuous else 'discrete'} state `{name}`"
                else:
                    yield from self._value(value, states[name].type if not continuous else None)
        if law.sample is not None:
            yield from self._value(law.sample)

    def _read(self, source: ir.End, target: ir.Target) -> Iterator[str]:
        yield from self.end(source, "in")
        kind = self.type_of(source)
        if kind is not None:
            yield from self._target(target, kind)

    def _written(self, sink: ir.End, value: Expression) -> Iterator[str]:
        yield from self._passing(sink, "out", value.type)
        yield from self._value(value)

    def _passing(self, end: ir.End, direction: Direction, kind: Type) -> Iterator[str]:
        yield from self.end(end, direction)
        passing = self.type_of(end)
        if passing is not None and not agrees(passing, kind):
            yield f"{kind} passes an end of {passing}"

    def _target(self, target: ir.Target, value: Type) -> Iterator[str]:
        kind = self.names.variables.get(target.channel)
        if kind is None:
            yield f"there is no variable `{target.channel}`"
            return
        for index in target.indexes:
            if not isinstance(kind, ArrayType) or not isinstance(index.type, IntType):
                yield f"`{target.channel}` has no such element"
                return
            yield from self._value(index)
            kind = kind.element
        if not agrees(kind, value):
            yield f"`{target.channel}` is {kind} and is given {value}"

    def _value(self, value: Expression, wanted: Type | None = None) -> Iterator[str]:
        return expression_problems(value, self.names, wanted)


def _place(step: ir.Step) -> Iterator[str]:
    if not isinstance(step.span, Span):
        yield f"{type(step).__name__} has no place in the text"


def _signals(process: ProcessClass) -> dict[str, Type]:
    """The signals of the laws that are inlined in a process, by name."""
    found: dict[str, Type] = {constant.name: constant.type for constant in process.constants}
    found.update((state.name, state.type) for state in process.states)
    for part in parts(process.body):
        if isinstance(part, ir.ReadInputs):
            found.update((read.name, read.type) for read in part.reads)
        elif isinstance(part, ir.RunLaw):
            for equation in (*part.equations, *part.derivative_equations):
                if isinstance(equation, ExternalCall):
                    found.update((name, kind) for _, name, kind in equation.outputs)
                else:
                    found[equation.name] = equation.type
    return found
