"""Checks of compositions: every instance runs, never twice at once; loops let time pass; every branch can be chosen."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cspdiag.base import Report, Span
from cspdiag.model.types import UnknownType
from cspdiag.network.checks.agreement import Agreement
from cspdiag.network.diagnostics.composition.alternatives import BranchNeverChosen, SamePortTwice, TimeOutNeverElapses
from cspdiag.network.diagnostics.composition.runs import EndlessLoop, InstanceNeverRun, NoComposition, RunTwiceAtOnce
from cspdiag.network.flow.code import Call, Delay, Instruction, Select, Take, Watch
from cspdiag.network.flow.effects import writes
from cspdiag.network.infer.contexts import Placed
from cspdiag.network.infer.possible import decided_by_instance, overtaken
from cspdiag.network.infer.waiting import MayWait, is_always_ready, is_one_instant, is_open, is_over_at_once
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.expressions import Expression, LiteralValue, ParameterValue, PresentTime
from cspdiag.network.ir.walk import all_actions
from cspdiag.network.relations import UsesByKey, end_key, run_key, variables_read
from cspdiag.network.shapes import InstanceShape, Key, Shape, attached_key
from cspdiag.syntax import ast
from cspdiag.syntax.walk import nodes


def check_runs(shape: Shape, uses: UsesByKey, report: Report) -> None:
    """Report instances that never run, or that may run twice at the same time."""
    if shape.is_external or shape.is_submodel:
        return
    if shape.body is None:
        definition = shape.definition
        assert isinstance(definition, ast.ProcessDefinition)
        if definition.composition is None and not shape.incomplete:
            report.add(NoComposition(span=definition.name.span, process=shape.name))
        return
    run = {action.instance for action in all_actions(shape.body) if isinstance(action, ir.RunInstance)}
    for instance in shape.instances.values():
        use = uses.get(run_key(instance.name))
        if instance.name not in run and not shape.incomplete:
            is_named = _is_named_in_composition(shape, instance)
            never = InstanceNeverRun(span=instance.span, instance=instance.name, process=shape.name, is_named=is_named)
            report.add(never)
            _excuse(shape, instance)
        elif use is not None and use.parallel_writes is not None:
            first, second = use.parallel_writes
            report.add(RunTwiceAtOnce(span=second.span, instance=instance.name, first=first.span))


def _is_named_in_composition(shape: Shape, instance: InstanceShape) -> bool:
    assert isinstance(shape.definition, ast.ProcessDefinition)
    name = instance.declaration.name.text
    steps = nodes(shape.definition.composition)
    return any(isinstance(step, ast.Run) and step.instance.name.text == name for step in steps)


def _excuse(shape: Shape, instance: InstanceShape) -> None:
    """Suppress further reports about what is connected to an instance that never runs."""
    shape.has_unknown_uses = True
    for attached in instance.attachments.values():
        key = attached_key(attached)
        if key in shape.channels:
            shape.channels[key].excused = True


def check_progress(
    placed: Placed, waiting: MayWait, report: Report, agreement: Agreement, instance: str | None
) -> None:
    """Report loops in which no time can pass, and find branches that can never be chosen; ``instance`` is one in this
    context.
    """
    shape = placed.shape
    if shape.body is None or shape.incomplete:
        return
    flow = shape.flow
    for loop, inside in flow.decisions:
        if isinstance(loop, ir.Repeat | ir.WhileLoop):
            steps = flow.instructions[inside.start : inside.stop]
            _check_loop(placed, waiting, loop, steps, report, agreement, instance)
    for instruction in flow.instructions:
        match instruction:
            case Select(step=choice):
                _check_branches(placed, choice, report, agreement)
                _check_time_outs(placed, choice, agreement)
            case Watch(step=ir.InterruptOn(branch=branch)):
                _never_holds(branch, agreement)
            case _:  # No other instruction has guards.
                pass


def _check_loop(
    placed: Placed,
    waiting: MayWait,
    loop: ir.Repeat[ir.CoreAction] | ir.WhileLoop[ir.CoreAction],
    inside: Sequence[Instruction],
    report: Report,
    agreement: Agreement,
    instance: str | None,
) -> None:
    """A loop that may never wait is endless if nothing inside changes its condition.

    If that follows from the values of parameters, it is refused only if all instances have such values.
    """
    condition = loop.until if isinstance(loop, ir.Repeat) else loop.condition
    once = [one for one in _delays(inside) if is_one_instant(one[1])]
    passes_once = bool(once) and condition is not None and _depends_on_time(condition)
    if waiting.action(placed, loop.body) or passes_once or _may_end(placed, loop, condition, inside):
        agreement.refute(EndlessLoop, loop.span)
        return
    delays = once or [one for one in _delays(inside) if is_over_at_once(placed, one[1])]
    endless = EndlessLoop(
        span=loop.span,
        conditional=condition is not None,
        may_end_first=(
            isinstance(loop, ir.Repeat) and condition is not None and decided_by_instance(placed, condition) != {False}
        ),
        delay=delays[0][0] if delays else None,
        is_instant=bool(once),
        write=next((step.span for step in all_actions(loop.body) if _has_no_reader(placed, step)), None),
        instance=instance,
    )
    causes = [duration for _, duration in delays] + ([] if condition is None else [condition])
    if any(isinstance(part, ParameterValue) for cause in causes for part in walk(cause)):
        agreement.claim(endless)
    else:
        report.add(endless)


def _may_end(
    placed: Placed,
    loop: ir.Repeat[ir.CoreAction] | ir.WhileLoop[ir.CoreAction],
    condition: Expression | None,
    inside: Sequence[Instruction],
) -> bool:
    """Whether a loop may be skipped or may end: its condition depends on something that changes inside, or differs
    between instances.
    """
    if condition is None:
        return False
    ends = isinstance(loop, ir.Repeat)
    holds = decided_by_instance(placed, condition)
    if not holds or ends in holds or any(isinstance(part.type, UnknownType) for part in walk(condition)):
        return True
    if holds == {not ends}:
        return False
    variables = {value.channel for value in variables_read(condition)}
    if not variables and not _depends_on_time(condition):
        # Its constants have no value: the loop ends with a fault.
        return True
    written = _written_in(placed.shape, inside)
    return not variables.isdisjoint(written) or any(is_open(placed, key) for key in variables)


def _has_no_reader(placed: Placed, step: ir.CoreAction) -> bool:
    """Whether a step writes to a port behind which no process waits for values."""
    return (
        isinstance(step, ir.WriteValue)
        and isinstance(step.sink, ir.PortEnd)
        and placed.facts[end_key(step.sink)][0] == "var"
    )


def _depends_on_time(condition: Expression) -> bool:
    return any(isinstance(part, PresentTime) for part in walk(condition))


def _delays(inside: Sequence[Instruction]) -> Iterator[tuple[Span, Expression]]:
    """The delays and the time-outs among instructions, with their places."""
    for instruction in inside:
        match instruction:
            case Delay(step=ir.WaitStep() as timed) | Take(branch=ir.Branch(event=ir.AfterEvent() as timed)):
                yield timed.span, timed.duration
            case _:  # No other instruction waits for time to pass.
                pass


def _written_in(shape: Shape, inside: Sequence[Instruction]) -> set[Key]:
    written: set[Key] = set()
    for instruction in inside:
        if isinstance(instruction, Call):
            attached = shape.instances[instruction.step.instance].attachments.values()
            written.update(key for key in map(attached_key, attached) if key is not None)
        written.update(place.channel for place in writes(instruction) if isinstance(place, ir.Target))
    return written


def _check_branches(placed: Placed, choice: ir.Choice[ir.CoreAction], report: Report, agreement: Agreement) -> None:
    """A prioritized alternative never reaches the guards after one that is always ready."""
    always: ir.Branch[ir.CoreAction] | None = None
    seen: dict[tuple[str, Key], ir.Branch] = {}
    for branch in choice.branches:
        if _never_holds(branch, agreement):
            continue
        if always is not None and choice.prioritized:
            agreement.claim(BranchNeverChosen(span=branch.event.span, earlier=always.event.span))
            continue
        agreement.refute(BranchNeverChosen, branch.event.span)
        end = _end_of(branch.event)
        if end is not None and branch.condition is None:
            if end in seen:
                first = seen[end].event.span
                report.add(SamePortTwice(span=branch.event.span, port=end[1], first=first, writes=end[0] == "!"))
            else:
                seen[end] = branch
        if branch.condition is None and is_always_ready(placed, branch.event):
            always = branch


def _check_time_outs(placed: Placed, choice: ir.Choice[ir.CoreAction], agreement: Agreement) -> None:
    """A time-out next to samples, a shorter time-out or a branch that is always ready must come before these to be
    chosen at all.
    """
    late = {found.place: found for found in overtaken(placed, choice)}
    for place, branch in enumerate(choice.branches):
        found = late.get(place)
        if found is None:
            agreement.refute(TimeOutNeverElapses, branch.event.span)
            continue
        # Branches after one that is always ready have already been reported.
        if found.period or not found.has_priority:
            agreement.claim(
                TimeOutNeverElapses(
                    span=branch.event.span,
                    waits=found.waits,
                    port=found.port,
                    period=found.period,
                    earlier=found.by.event.span,
                )
            )


def _never_holds(branch: ir.Branch[ir.CoreAction], agreement: Agreement) -> bool:
    condition = branch.condition
    if condition is None or condition.span is None:
        return False
    if isinstance(condition, LiteralValue) and condition.value is False:
        agreement.claim(BranchNeverChosen(span=condition.span, earlier=None))
        return True
    agreement.refute(BranchNeverChosen, condition.span)
    return False


def _end_of(event: ir.Event) -> tuple[str, Key] | None:
    if isinstance(event, ir.ReadyEvent | ir.InputEvent):
        return "?", end_key(event.source)
    return ("!", end_key(event.sink)) if isinstance(event, ir.OutputEvent) else None
