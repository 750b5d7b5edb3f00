"""Checks of compositions: every instance runs, never twice at once; loops let time pass; every branch can be chosen."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.base import Report, Span
from cspdiag.model.types import UnknownType
from cspdiag.network.diagnostics.alternatives import BranchNeverChosen, SamePortTwice, TimeOutNeverElapses
from cspdiag.network.diagnostics.runs import EndlessLoop, InstanceNeverRun, NoComposition, RunTwiceAtOnce
from cspdiag.network.infer.contexts import Placed
from cspdiag.network.infer.ends import all_actions
from cspdiag.network.infer.possible import overtaken
from cspdiag.network.infer.waiting import Waiting, is_always_ready, is_open, is_over_at_once
from cspdiag.network.ir.actions import (
    Action,
    AfterEvent,
    AssignValue,
    Branch,
    Choice,
    Event,
    InputEvent,
    InterruptOn,
    OutputEvent,
    ReadValue,
    ReadyEvent,
    Repeat,
    RunInstance,
    WaitStep,
    WhileLoop,
)
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.expressions import Expression, LiteralValue
from cspdiag.network.relations import UsesByKey, end_key, run_key, variables_read
from cspdiag.network.shapes import InstanceShape, Key, Shape, attached_key
from cspdiag.syntax import ast


def check_runs(shape: Shape, uses: UsesByKey, report: Report) -> None:
    """Every instance runs somewhere, and never twice at the same time."""
    if shape.is_external or shape.is_submodel:
        return
    if shape.body is None:
        definition = shape.definition
        assert isinstance(definition, ast.ProcessDefinition)
        if definition.composition is None and not shape.incomplete:
            report.add(NoComposition(span=definition.name.span, process=shape.name))
        return
    run = {action.instance for action in all_actions(shape.body) if isinstance(action, RunInstance)}
    for instance in shape.instances.values():
        use = uses.get(run_key(instance.name))
        if instance.name not in run and not shape.incomplete:
            report.add(InstanceNeverRun(span=instance.span, instance=instance.name, process=shape.name))
            _excuse(shape, instance)
        elif use is not None and use.parallel_writes is not None:
            first, second = use.parallel_writes
            report.add(RunTwiceAtOnce(span=second.span, instance=instance.name, first=first.span))


def _excuse(shape: Shape, instance: InstanceShape) -> None:
    """Of the channels of an instance that never runs nothing more is said."""
    for attached in instance.attachments.values():
        key = attached_key(attached)
        if key in shape.channels:
            shape.channels[key].excused = True


def check_progress(placed: Placed, waiting: Waiting, report: Report) -> None:
    """Loops in which no time can pass, and branches that can never be chosen."""
    shape = placed.shape
    if shape.body is None or shape.incomplete:
        return
    for action in all_actions(shape.body):
        match action:
            case Repeat():
                _check_loop(placed, waiting, action, action.until, report)
            case WhileLoop():
                _check_loop(placed, waiting, action, action.condition, report)
            case Choice():
                _check_branches(placed, action, report)
                _check_time_outs(placed, action, report)
            case InterruptOn():
                _never_holds(action.branch, report)
            case _:
                pass


def _check_loop(
    placed: Placed, waiting: Waiting, loop: Repeat | WhileLoop, condition: Expression | None, report: Report
) -> None:
    """A loop that may never wait is endless when nothing inside changes its condition."""
    if waiting.action(placed, loop.body):
        return
    if condition is not None:
        if isinstance(loop, WhileLoop) and isinstance(condition, LiteralValue) and condition.value is False:
            return
        if isinstance(loop, Repeat) and isinstance(condition, LiteralValue) and condition.value is True:
            return
        if any(isinstance(part.type, UnknownType) for part in walk(condition)):
            return
        looked_at = {value.channel for value in variables_read(condition)}
        if looked_at & _written_in(placed.shape, loop.body) or any(is_open(placed, key) for key in looked_at):
            return
    delay = next((span for span, duration in _delays(loop.body) if is_over_at_once(placed, duration)), None)
    report.add(EndlessLoop(span=loop.span, conditional=condition is not None, delay=delay))


def _delays(body: Action) -> Iterator[tuple[Span, Expression]]:
    """The delays and the time-outs in an action, with their places."""
    for action in all_actions(body):
        match action:
            case WaitStep():
                yield action.span, action.duration
            case Choice():
                events = (branch.event for branch in action.branches)
                yield from ((event.span, event.duration) for event in events if isinstance(event, AfterEvent))
            case InterruptOn(branch=Branch(event=AfterEvent() as event)):
                yield event.span, event.duration
            case _:
                pass


def _written_in(shape: Shape, body: Action) -> set[Key]:
    written: set[Key] = set()
    for action in all_actions(body):
        match action:
            case AssignValue() | ReadValue():
                written.add(action.target.channel)
            case RunInstance():
                attached = shape.instances[action.instance].attachments.values()
                written.update(key for key in map(attached_key, attached) if key is not None)
            case Choice():
                for branch in action.branches:
                    if isinstance(branch.event, InputEvent):
                        written.add(branch.event.target.channel)
            case InterruptOn():
                if isinstance(action.branch.event, InputEvent):
                    written.add(action.branch.event.target.channel)
            case _:
                pass
    return written


def _check_branches(placed: Placed, choice: Choice, report: Report) -> None:
    """Behind a guard that is always ready, a prioritized alternative never goes on."""
    always: Branch | None = None
    seen: dict[tuple[str, Key], Branch] = {}
    for branch in choice.branches:
        if _never_holds(branch, report):
            continue
        if always is not None and choice.prioritized:
            report.add(BranchNeverChosen(span=branch.event.span, earlier=always.event.span))
            continue
        end = _end_of(branch.event)
        if end is not None and branch.condition is None:
            if end in seen:
                first = seen[end].event.span
                report.add(SamePortTwice(span=branch.event.span, port=end[1], first=first, writes=end[0] == "!"))
            else:
                seen[end] = branch
        if branch.condition is None and is_always_ready(placed, branch.event):
            always = branch


def _check_time_outs(placed: Placed, choice: Choice, report: Report) -> None:
    """A time-out beside samples, a shorter one or a branch that is always ready must come before them to be chosen at all."""
    for found in overtaken(placed, choice):
        is_behind = choice.prioritized and found.by.span.start < found.branch.span.start
        # Behind one that is always ready nothing has a turn, and that is said already.
        if found.period or not is_behind:
            report.add(
                TimeOutNeverElapses(
                    span=found.branch.event.span,
                    waits=found.waits,
                    port=found.port,
                    period=found.period,
                    earlier=found.by.event.span,
                )
            )


def _never_holds(branch: Branch, report: Report) -> bool:
    condition = branch.condition
    if isinstance(condition, LiteralValue) and condition.value is False and condition.span is not None:
        report.add(BranchNeverChosen(span=condition.span, earlier=None))
        return True
    return False


def _end_of(event: Event) -> tuple[str, Key] | None:
    if isinstance(event, ReadyEvent | InputEvent):
        return "?", end_key(event.source)
    return ("!", end_key(event.sink)) if isinstance(event, OutputEvent) else None
