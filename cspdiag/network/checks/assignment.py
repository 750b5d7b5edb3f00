"""Definite assignment: no variable is read before it was written, and no part stands where nothing ever comes.

One walk through the composition of a shape in the order of its run, with the set of what was surely written so far. Parallel
branches share it, for a variable written in one and read in another is a race already. Of a part that may be abandoned
(``interrupt``, ``catch``) it is assumed that it came to its end: how far it came cannot be told.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from typing import TypeAlias, assert_never

from cspdiag.base import Report, Span
from cspdiag.base.record import node
from cspdiag.network.checks.agreement import Agreement
from cspdiag.network.diagnostics.runs import ReadBeforeWrite, Unreachable
from cspdiag.network.ir.actions import (
    Action,
    AfterEvent,
    AssignValue,
    Branch,
    CatchException,
    Choice,
    CountedLoop,
    Group,
    IfElse,
    InputEvent,
    InterruptOn,
    OptimizedStep,
    OutputEvent,
    ParallelSteps,
    RaiseException,
    ReadValue,
    ReadyEvent,
    Repeat,
    ResetInstance,
    RunInstance,
    SequentialSteps,
    SkipEvent,
    SkipStep,
    StopStep,
    Target,
    WaitStep,
    WhileLoop,
    WriteValue,
)
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.relations import UsesByKey, end_key, variables_read
from cspdiag.network.shapes import InstanceShape, Key, Shape, attached_key, element_name


@node
class Flow:
    """What a run of a shape reads and writes, seen from outside.

    ``reads``: inputs that it reads, each with the outputs that it has surely written before. ``writes``: outputs that
    it has surely written when it ends. ``ends``: whether it can end.
    """

    reads: Mapping[Key, frozenset[Key]]
    writes: frozenset[Key]
    ends: bool


def check_assignment(
    shape: Shape, uses: UsesByKey, inside: Mapping[Shape, Flow], report: Report, agreement: Agreement
) -> Flow:
    """Report reads before writes, and find unreachable parts of a shape; ``inside`` has the flows of its process instances."""
    inputs = {key for port, _, key in shape.port_elements() if port.direction == "in"}
    outputs = frozenset(key for port, _, key in shape.port_elements() if port.direction == "out")
    if shape.is_submodel or shape.is_external:
        return Flow(reads=dict.fromkeys(inputs, frozenset()), writes=outputs, ends=True)
    if shape.body is None or shape.incomplete:
        return Flow(reads={}, writes=outputs, ends=True)
    walk = _Walk(shape, uses, inside, inputs, outputs, report, agreement)
    ends = walk.action(shape.body)
    return Flow(reads=_Reads(walk.reads), writes=frozenset(walk.written & outputs) if ends else outputs, ends=ends)


_Chain: TypeAlias = "tuple[Key, _Chain] | None"
"""Outputs that were written, the last one first."""


class _Reads(Mapping[Key, frozenset[Key]]):
    """By input, the outputs that were written before every read of it, put together when they are asked for: a process may have thousands of both."""

    def __init__(self, before: Mapping[Key, list[_Chain]]) -> None:
        self._before = before
        self._known: dict[Key, frozenset[Key]] = {}

    def __getitem__(self, key: Key) -> frozenset[Key]:
        known = self._known.get(key)
        if known is None:
            known = self._known[key] = frozenset.intersection(*map(_written, self._before[key]))
        return known

    def __iter__(self) -> Iterator[Key]:
        return iter(self._before)

    def __len__(self) -> int:
        return len(self._before)

    def __contains__(self, key: object) -> bool:
        return key in self._before


def _written(chain: _Chain) -> frozenset[Key]:
    found = []
    while chain is not None:
        key, chain = chain
        found.append(key)
    return frozenset(found)


class _Walk:
    def __init__(
        self,
        shape: Shape,
        uses: UsesByKey,
        inside: Mapping[Shape, Flow],
        inputs: set[Key],
        outputs: frozenset[Key],
        report: Report,
        agreement: Agreement,
    ) -> None:
        self.shape = shape
        self.uses = uses
        self.inside = inside
        self.inputs = inputs
        self.outputs = outputs
        self.report = report
        self.agreement = agreement
        self.reads: dict[Key, list[_Chain]] = {}
        self.written: set[Key] = set()
        self._trail: list[Key] = []
        """What was added to ``written``, in order, so that branches can begin again from where they part."""
        self._chains: list[_Chain] = [None]
        """The outputs among them, from the last one back, after each."""

    def action(self, action: Action) -> bool:
        """Follow an action; returns whether it can end."""
        match action:
            case RunInstance():
                return self._run(self.shape.instances[action.instance], action.span)
            case ReadValue():
                self._read(end_key(action.source), action.span)
                self._assign(action.target)
                return True
            case WriteValue():
                self._values(action.value)
                self._write(end_key(action.sink))
                return True
            case AssignValue():
                self._values(action.value)
                self._assign(action.target)
                return True
            case WaitStep():
                self._values(action.duration)
                return True
            case SkipStep() | ResetInstance():
                return True
            case StopStep() | RaiseException():
                return False
            case SequentialSteps():
                return self._sequence(action.steps)
            case ParallelSteps():
                ends = [self.action(step) for step in action.steps]
                return all(ends)
            case Choice():
                return self._branches([partial(self._branch, branch) for branch in action.branches])
            case Repeat():
                body_ends = self.action(action.body)
                if action.until is not None and body_ends:
                    self._values(action.until)
                return body_ends and action.until is not None
            case WhileLoop():
                self._values(action.condition)
                self._branches([lambda: self.action(action.body), lambda: True])
                return True
            case IfElse():
                self._values(action.condition)
                return self._branches([lambda: self.action(action.then), lambda: self.action(action.otherwise)])
            case CatchException():
                return self._abandoned(lambda: self.action(action.body), lambda: self.action(action.handler))
            case InterruptOn():
                return self._abandoned(lambda: self.action(action.body), lambda: self._branch(action.branch))
            case CountedLoop() | Group():
                return self.action(action.body)
            case OptimizedStep():
                raise AssertionError("made by the optimizer, later")
            case _:
                assert_never(action)

    def _sequence(self, steps: tuple[Action, ...]) -> bool:
        for position, step in enumerate(steps):
            self.agreement.refuted(Unreachable, step.span)
            if not self.action(step):
                if position + 1 < len(steps):
                    self.agreement.found(Unreachable(span=steps[position + 1].span, endless=step.span))
                return False
        return True

    def _branch(self, branch: Branch) -> bool:
        if branch.condition is not None:
            self._values(branch.condition)
        event = branch.event
        match event:
            case ReadyEvent():
                self._read(end_key(event.source), event.span)
            case InputEvent():
                self._read(end_key(event.source), event.span)
                self._assign(event.target)
            case OutputEvent():
                self._values(event.value)
                self._write(end_key(event.sink))
            case AfterEvent():
                self._values(event.duration)
            case SkipEvent():
                pass
            case _:
                assert_never(event)
        return self.action(branch.body)

    def _branches(self, branches: Iterable[Callable[[], bool]]) -> bool:
        """Follow each from the same state; what all that end have written is written."""
        start = len(self._trail)
        common: set[Key] | None = None
        for branch in branches:
            ends = branch()
            added = set(self._trail[start:])
            self._undo(start)
            if ends:
                common = added if common is None else common & added
        for key in common or ():
            self._write(key)
        return common is not None

    def _abandoned(self, body: Callable[[], bool], handler: Callable[[], bool]) -> bool:
        start = len(self._trail)
        ends = body()
        added = self._trail[start:]
        self._undo(start)
        handler_ends = handler()
        if ends:
            self._undo(start)
            for key in added:
                self._write(key)
        return ends or handler_ends

    def _undo(self, start: int) -> None:
        self.written.difference_update(self._trail[start:])
        del self._trail[start:]
        del self._chains[start + 1 :]

    def _run(self, instance: InstanceShape, span: Span) -> bool:
        flow = self.inside.get(instance.shape)
        attached = {element_name(*element): attached_key(a) for element, a in instance.attachments.items()}
        for port, _, key in instance.shape.port_elements():
            outer = attached.get(key)
            if outer is None or port.direction != "in" or (flow is not None and key not in flow.reads):
                continue
            before = flow.reads[key] if flow is not None else frozenset()
            if not any(attached.get(output) == outer for output in before):
                self._read(outer, span, instance)
        for port, _, key in instance.shape.port_elements():
            outer = attached.get(key)
            if outer is not None and port.direction == "out" and (flow is None or key in flow.writes):
                self._write(outer)
        return flow is None or flow.ends

    def _values(self, expression: Expression) -> None:
        for value in variables_read(expression):
            assert value.span is not None
            self._read(value.channel, value.span)

    def _assign(self, target: Target) -> None:
        """An element of an array is as good as the whole: which ones were written cannot be told."""
        for index in target.indexes:
            self._values(index)
        self._write(target.channel)

    def _write(self, key: Key) -> None:
        if key not in self.written:
            self.written.add(key)
            self._trail.append(key)
            last = self._chains[-1]
            self._chains.append((key, last) if key in self.outputs else last)

    def _read(self, key: Key, span: Span, instance: InstanceShape | None = None) -> None:
        if key in self.inputs:
            self.reads.setdefault(key, []).append(self._chains[-1])
            return
        channel = self.shape.channels.get(key)
        if channel is None or channel.kind != "var" or channel.excused or channel.initial is not None:
            return
        if key in self.written:
            return
        channel.excused = True
        writer = self.uses[key].writer if key in self.uses else None
        self.report.add(
            ReadBeforeWrite(
                span=span,
                variable=key,
                reader="" if instance is None else instance.name,
                is_variable=channel.is_variable,
                declared=channel.span,
                writer=writer,
            )
        )
