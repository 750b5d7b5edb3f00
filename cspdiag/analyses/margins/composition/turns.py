"""What the composition of a program does with values: its statements, and the turns of its sampled loops.

A turn is one iteration of a loop that takes its samples, computes and writes in one line of statements, without
conditions or waits in between. What is not part of a turn is a statement with the reason why it is not followed.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import ClassVar

from cspdiag.base import Span
from cspdiag.base.record import record, replaced
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Expression, LiteralValue, VariableValue
from cspdiag.network.ir.network import CoreNetwork, ProcessClass
from cspdiag.network.ir.walk import actions_inside, parts
from cspdiag.network.relations import end_key

Branching = tuple[str, int]
"""A step down the composition: ``parallel``, ``loop`` or ``other``, and the number of the part."""
Position = tuple[Branching, ...]


@record
class Statement:
    """One thing that the composition does: it runs a law, or moves a value from ``sources`` to ``target``.

    Sources and targets are paths of nets and variables. ``value`` is what is assigned or written; None where a value is
    read. ``deciding`` are the variables of the conditions that it depends on. ``branch`` is the number of its branch of
    the turn's alternative.
    """

    uncompared: ClassVar[frozenset[str]] = frozenset()

    process: str
    position: Position
    priority: tuple[int, ...]
    turn: Position | None
    reason: str
    """Why it is not followed; empty if it is."""
    span: Span
    law: str | None = None
    sources: tuple[str, ...] = ()
    target: str | None = None
    value: Expression | None = None
    deciding: tuple[str, ...] = ()
    branch: int = 0


@record
class Loop:
    """A loop whose iterations are turns: its position, and the order of the branches of its alternative."""

    position: Position
    process: str
    priority: tuple[int, ...]
    span: Span
    branches: int
    prioritized: bool


@record
class _Context:
    """The place of a statement."""

    process: str
    position: Position = ()
    priority: tuple[int, ...] = ()
    turn: Position | None = None
    reason: str = ""
    deciding: tuple[str, ...] = ()
    branch: int = 0
    is_in_loop: bool = False


class Composition:
    """The statements of a program and its loops, by position."""

    def __init__(self, network: CoreNetwork) -> None:
        self._classes = {entry.name: entry for entry in network.classes}
        self._class_of = {instance.path: instance.class_name for instance in network.instances}
        self.net_of = {end: net.path for net in network.nets for end in (*net.writers, *net.readers)}
        """The path of the net at a port or channel, by the paths of processes and names."""
        self._sampled = {net.path for net in network.nets if net.external == "in" and net.sampling is not None}
        self.loops: dict[Position, Loop] = {}
        self.statements: list[Statement] = []
        self.written_by_hand: dict[str, Span] = {}
        """The processes that are written in another language, by path."""
        self._run(network.top, _Context(network.top), self._classes[network.top].span)

    def laws_run(self) -> dict[str, list[Statement]]:
        """The statements that run each law."""
        found: dict[str, list[Statement]] = {}
        for statement in self.statements:
            if statement.law is not None:
                found.setdefault(statement.law, []).append(statement)
        return found

    def place(self, process: str, end: ir.End) -> str:
        """The path of the net or variable behind a port or channel of a process."""
        name = end_key(end)
        return self.net_of.get((process, name), f"{process}.{name}")

    def variable(self, process: str, name: str) -> str:
        """The path of a variable of a process."""
        return self.place(process, ir.ChannelEnd(name))

    def variables(self, process: str, *items: object) -> tuple[str, ...]:
        """The paths of the variables of a process that expressions read, each once."""
        names = (part.channel for part in parts(items) if isinstance(part, VariableValue))
        return tuple(self.variable(process, name) for name in dict.fromkeys(names))

    def _run(self, path: str, context: _Context, span: Span) -> None:
        entry = self._classes[self._class_of[path]]
        if not isinstance(entry, ProcessClass):
            self._add(context, span, law=path)
        elif entry.body is None:
            self.written_by_hand[path] = entry.span
        else:
            self._action(replaced(context, process=path), entry.body)

    def _add(
        self,
        context: _Context,
        span: Span,
        *,
        law: str | None = None,
        sources: tuple[str, ...] = (),
        target: str | None = None,
        value: Expression | None = None,
        reason: str = "",
    ) -> None:
        reason = context.reason or reason or ("" if context.turn is not None else "it is not in a loop")
        self.statements.append(
            Statement(
                context.process, context.position, context.priority, context.turn, reason, span, law, sources, target,
                value, context.deciding, context.branch,
            )
        )  # fmt: skip

    def _move(self, context: _Context, action: ir.CoreAction | ir.Event) -> None:
        process = context.process
        match action:
            case ir.ReadValue() | ir.InputEvent():
                self._target(context, action.target, (self.place(process, action.source),), None, action.span)
            case ir.AssignValue():
                self._target(context, action.target, self.variables(process, action.value), action.value, action.span)
            case ir.WriteValue() | ir.OutputEvent():
                sources = self.variables(process, action.value)
                self._add(
                    context, action.span, sources=sources, target=self.place(process, action.sink), value=action.value
                )
            case _:  # Anything else moves no value.
                pass

    def _target(
        self, context: _Context, target: ir.Target, sources: tuple[str, ...], value: Expression | None, span: Span
    ) -> None:
        place = self.place(context.process, ir.ChannelEnd(target.channel))
        inner = replaced(context, deciding=(*context.deciding, *self.variables(context.process, target.indexes)))
        reason = "it writes an element of an array" if target.indexes else ""
        self._add(inner, span, sources=sources, target=place, value=value, reason=reason)

    def _action(self, context: _Context, action: ir.CoreAction) -> None:
        match action:
            case ir.RunInstance():
                self._run(f"{context.process}.{action.instance}", context, action.span)
            case ir.ReadValue() | ir.AssignValue() | ir.WriteValue():
                self._move(context, action)
            case ir.Repeat():
                self._repeat(context, action)
            case ir.Group():
                self._action(context, action.body)
            case ir.Choice():
                reason = "it is in an alternative" if len(action.branches) > 1 else ""
                self._branches(_stopped(context, reason), action)
            case ir.SequentialSteps() | ir.ParallelSteps():
                ranked = isinstance(action, ir.ParallelSteps) and action.prioritized
                for number, part in enumerate(action.steps):
                    inner = _inside(context, action, number)
                    self._action(replaced(inner, priority=(*inner.priority, number)) if ranked else inner, part)
            case _:  # Any other action is not followed, and says why.
                self._irregular(context, action)

    def _irregular(self, context: _Context, action: ir.CoreAction) -> None:
        """Anything that is not followed within a turn: what is inside it is not, either."""
        reason, decisive = _irregularity(action)
        within = replaced(
            _stopped(context, reason),
            deciding=(*context.deciding, *self.variables(context.process, decisive)),
            is_in_loop=context.is_in_loop or isinstance(action, ir.WhileLoop | ir.CountedLoop),
        )
        if context.turn is not None and not actions_inside(action) and not isinstance(action, ir.SkipStep):
            self._add(context, action.span, reason=reason)
        if isinstance(action, ir.InterruptOn):
            if isinstance(action.branch.event, ir.SkipEvent):
                within = _stopped(within, "it is interrupted at once", always=True)
            elif isinstance(action.branch.event, ir.ReadyEvent | ir.InputEvent):
                source = self.place(context.process, action.branch.event.source)
                self._add(within, action.branch.event.span, sources=(source,), reason="it interrupts")
                if source in self._sampled:
                    within = _stopped(within, "the next sample interrupts it", always=True)
            self._move(within, action.branch.event)
        for number, part in enumerate(actions_inside(action)):
            self._action(_inside(within, action, number), part)

    def _repeat(self, context: _Context, action: ir.Repeat[ir.CoreAction]) -> None:
        until = action.until
        if context.turn is not None:
            self._add(context, action.span, reason="it contains a loop")
        inner = replaced(_inside(context, action, 0), is_in_loop=True)
        if context.is_in_loop:
            inner = _stopped(inner, "it is in a loop inside another loop", always=True)
        elif isinstance(until, LiteralValue) and until.value:
            inner = _stopped(inner, "its loop ends after one iteration", always=True)
        body = action.body
        while isinstance(body, ir.Group):
            body = body.body
        branches = body.branches if isinstance(body, ir.Choice) else ()
        prioritized = len(branches) < 2 or (isinstance(body, ir.Choice) and body.prioritized)
        position = inner.position
        self.loops[position] = Loop(
            position, context.process, context.priority, action.span, max(1, len(branches)), prioritized
        )
        inner = replaced(inner, turn=position)
        if isinstance(body, ir.Choice):
            self._branches(inner, body)
        else:
            self._action(inner, body)

    def _branches(self, context: _Context, choice: ir.Choice[ir.CoreAction]) -> None:
        for number, branch in enumerate(choice.branches):
            inner = _inside(context, choice, number)
            if context.turn == context.position:
                inner = replaced(inner, branch=number)
            if branch.condition is not None:
                inner = _stopped(
                    replaced(inner, deciding=(*inner.deciding, *self.variables(context.process, branch.condition))),
                    "its guard has a condition",
                )
            if isinstance(branch.event, ir.AfterEvent | ir.SkipEvent):
                self._add(inner, branch.event.span, reason="it does not wait for a value")
                inner = _stopped(inner, "its guard does not wait for a value")
            self._move(inner, branch.event)
            self._action(inner, branch.body)


def _inside(context: _Context, action: ir.CoreAction, number: int) -> _Context:
    return replaced(context, position=(*context.position, (_kind(action), number)))


def _stopped(context: _Context, reason: str, *, always: bool = False) -> _Context:
    """The context of what is not followed; outside turns it does not matter, unless always."""
    if context.reason or not reason or (context.turn is None and not always):
        return context
    return replaced(context, reason=reason)


def _irregularity(action: ir.CoreAction) -> tuple[str, object]:
    """Why an action is not followed within a turn, and what decides on what is inside it."""
    match action:
        case ir.IfElse():
            return "it is under a condition", action.condition
        case ir.WhileLoop():
            return "it is in a loop inside another loop", action.condition
        case ir.CountedLoop():
            return "it is in a loop inside another loop", ()
        case ir.CatchException():
            return "it is in a `catch` within the loop", ()
        case ir.InterruptOn():
            return "it is in an `interrupt` within the loop", action.branch.condition or ()
        case ir.WaitStep():
            return "the loop waits for a time", action.duration
        case ir.ResetInstance():
            return "the loop resets an instance", ()
        case ir.RaiseException():
            return "the loop is left by an exception", ()
        case ir.StopStep():
            return "the loop stops", ()
        case _:  # A step that moves no value; the others are followed.
            return "", ()


def _kind(action: ir.CoreAction) -> str:
    match action:
        case ir.ParallelSteps():
            return "parallel"
        case ir.Repeat() | ir.WhileLoop() | ir.CountedLoop():
            return "loop"
        case _:  # Of the parts of any other action one runs at a time.
            return "other"


def are_active_together(one: Position, other: Position) -> bool:
    """Whether two parts belong to the same mode: they are in parallel, or in the same loop."""
    for (kind, number), (_, other_number) in zip(one, other, strict=False):
        if number != other_number:
            return kind == "parallel"
        if kind == "loop":
            return True
    return True


def statements_of(statements: list[Statement], turn: Position) -> Iterator[Statement]:
    """The statements within a turn, in the order of the text."""
    return (statement for statement in statements if statement.turn == turn)
